#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "supple/base/error.h"
#include "supple/base/progress.h"
#include "supple/jobs/job_queue.h"
#include "supple/store/store_error.h"
#include "watchdog.h"

namespace supple::jobs {

using Clock = Watchdog::Clock;
using store::JobState;
using store::Result;

inline Clock::duration duration(double seconds) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

inline bool is_finished(JobState state) { return state != JobState::accepted && state != JobState::running; }

[[noreturn]] inline void throw_not_found(const std::string& id) { throw store::JobNotFound(id); }

/// How far a job of this process is on its way to its end.
enum class Phase {
  queued,    ///< waits for a worker
  starting,  ///< has a worker, which tells the store so
  running,   ///< is computed; in a shared store, no other server takes it before the lease of this one ends
  ending,    ///< one thread has the right to end it, and stores how it ended
  ended,     ///< the store or the journal has its end
  released,  ///< belongs to the next process or to another server
};

/// Whether the store has the row of a job. Clients may ask for a job with a row.
enum class Row { none, being_written, written };

class JobBoard;

/// A job of this process. The mutex of the board guards what is neither constant nor said to have one thread.
struct Job final : ProgressSink {
  Job(JobBoard& the_board, Watchdog& watchdog, Computation the_computation, store::JobRecord the_record,
      bool with_request, Row the_row)
      : board(the_board),
        id(the_record.id),
        computation(std::move(the_computation)),
        has_request(with_request),
        earlier_attempts(the_record.attempts),
        due(Clock::now() + duration(computation.deadline)),
        watch(std::in_place, watchdog,
              Watchdog::Watch{token, due, {}, {}, [this](Clock::time_point now) { resumed_at = now; }}),
        record(std::move(the_record)),
        row(the_row) {}

  void report(double fraction, std::string_view name) override;
  void publish(std::string_view text) override;
  void saved() override {
    if (on_saved) on_saved();
  }

  JobBoard& board;
  const std::string id;
  const Computation computation;
  const bool has_request;      ///< whether a later process can make it again
  const int earlier_attempts;  ///< starts in earlier processes, and on other servers
  const CancellationToken token;
  const Clock::time_point due;  ///< when its deadline passes
  /// When its computation has taken the deadline's stop back; before `due` if it has not. Set by the watchdog.
  std::atomic<Clock::time_point> resumed_at{Clock::time_point::min()};
  std::optional<Watchdog::Guard> watch;  ///< dropped by the thread that ends the job
  std::uint64_t number_in_session = 0;   ///< set before any thread may end the job
  Clock::time_point last_report{};       ///< used by the computing thread alone
  Clock::time_point last_published{};    ///< used by the computing thread alone
  std::function<void()> on_saved;        ///< used by the computing thread alone
  std::uint64_t shared_version = 0;      ///< version that other servers know; used by the lease keeper alone

  store::JobRecord record;
  Phase phase = Phase::queued;
  Row row = Row::none;
  std::optional<Clock::time_point> left_at{};  ///< since when nobody waits for a job without a row
  Clock::time_point ended_at{};                ///< when it ended, whether or not its computation has stopped
  double progress = 0;
  std::string stage;
  std::string partial;
  std::uint64_t version = 1;
  std::optional<Result> result;  ///< result of a job without a row
  std::exception_ptr failure;
};

using JobPointer = std::shared_ptr<Job>;

}  // namespace supple::jobs
