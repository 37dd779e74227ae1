#include "job_events.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>

#include "supple/json/answers.h"
#include "supple/json/json_writer.h"
#include "supple/store/clock.h"
#include "supple/store/store_error.h"

namespace supple::routes {
namespace {

using store::JobState;

/// Some text is sent at least so often, so that proxies do not close the connection.
constexpr double keep_alive_seconds = 10;

std::string event(const char* name, const jobs::JobStatus& status) {
  return "event: " + std::string(name) + "\ndata: " + write_job(status) + "\n\n";
}

/// Sends the events of one job and keeps account of what has been sent.
class EventStream {
 public:
  explicit EventStream(http::StreamWriter& out) : out_(out) {}

  /// False once the stream ends: the job is finished, or the client has gone.
  bool send(const jobs::JobStatus& status, std::uint64_t version) {
    if (is_finished(status)) {
      out_.write(event("finished", status));
      return false;
    }
    if (version == sent_version_) return keep_alive("still here");
    sent_version_ = version;
    return write(event("progress", status));
  }

  /// Sends a comment if nothing has been sent for a while.
  bool keep_alive(const std::string& comment) {
    const bool is_due = Clock::now() - last_ > std::chrono::duration<double>(keep_alive_seconds);
    return !is_due || write(": " + comment + "\n\n");
  }

  bool write(const std::string& text) {
    last_ = Clock::now();
    return out_.write(text);
  }

 private:
  using Clock = std::chrono::steady_clock;
  http::StreamWriter& out_;
  std::uint64_t sent_version_ = 0;
  Clock::time_point last_ = Clock::now();
};

}  // namespace

std::optional<double> estimated_remaining_seconds(const jobs::JobStatus& status, std::int64_t now) {
  constexpr double min_progress = 0.02;  // what has to be done first says little about the speed of the rest
  if (status.record.state != JobState::running || status.progress <= min_progress) return std::nullopt;
  const double elapsed = 1e-3 * static_cast<double>(std::max<std::int64_t>(0, now - status.record.started));
  return elapsed * (1 - status.progress) / status.progress;
}

std::string write_job(const jobs::JobStatus& status) {
  const auto& record = status.record;
  json::JsonWriter out;
  out.begin_object().field("id", record.id).field("kind", record.kind);
  if (!record.mesh.empty()) out.field("mesh", record.mesh);
  out.field("state", store::state_name(record.state))
      .field("progress", status.progress)
      .field("stage", status.stage)
      .field("priority", priority_name(record.priority))
      .field("created", json::time_text(record.created));
  if (record.started) out.field("started", json::time_text(record.started));
  if (record.finished) out.field("finished", json::time_text(record.finished));
  if (record.expires) out.field("expires", json::time_text(record.expires));
  out.field("deadline", record.deadline).key("remaining_seconds");
  if (const auto remaining = estimated_remaining_seconds(status, store::now_milliseconds())) {
    out.number(*remaining);
  } else {
    out.null();
  }
  if (record.state == JobState::successful) out.field("result", "/v1/jobs/" + record.id + "/result");
  if (!record.error.empty()) out.key("error").raw(record.error);
  if (!status.partial.empty() && !is_finished(status)) out.key("partial").raw(status.partial);
  out.end_object();
  return out.take();
}

bool is_finished(const jobs::JobStatus& status) {
  return status.record.state != JobState::accepted && status.record.state != JobState::running;
}

void follow_job(const FollowedJob& job, http::StreamWriter& out) {
  EventStream stream(out);
  std::uint64_t version = 0;
  double seconds = 0;  // the first event is sent at once
  std::string trouble;
  while (job.may_follow() && !out.client_gone()) {
    try {
      const auto status = job.wait_for_change(version, seconds);
      trouble.clear();
      if (!stream.send(status, version)) return;
    } catch (const store::JobNotFound&) {
      return;
    } catch (const Error& error) {
      const bool is_new = trouble != error.code();
      trouble = error.code();
      const auto comment = "the job cannot be read now (" + trouble + ")";
      if (!(is_new ? stream.write(": " + comment + "\n\n") : stream.keep_alive(comment))) return;
      std::this_thread::sleep_for(std::chrono::duration<double>(job.period_seconds));
    }
    seconds = job.period_seconds;
  }
}

}  // namespace supple::routes
