#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "supple/http/message.h"
#include "supple/jobs/job_queue.h"

namespace supple::routes {

/// Seconds until a running job ends, if it goes on as fast as it has gone so far; nothing while its progress tells too
/// little. `now` is in milliseconds since 1970.
std::optional<double> estimated_remaining_seconds(const jobs::JobStatus& status, std::int64_t now);

/// A job as the contract describes it.
std::string write_job(const jobs::JobStatus& status);

bool is_finished(const jobs::JobStatus& status);

/// The job that a stream of server-sent events follows.
struct FollowedJob {
  /// The job's status as soon as its version is another one, or after this time; as JobQueue::wait_for_change.
  std::function<jobs::JobStatus(std::uint64_t& version, double seconds)> wait_for_change;
  std::function<bool()> may_follow;  ///< false ends the stream: the server stops, or the client's key has ended
  double period_seconds = 1;         ///< between two checks whether the client is there
};

/// Sends the events of a job until it is finished or has been removed. Whatever else goes wrong is temporary, such as a
/// database that is away: a comment names it, and the stream goes on.
void follow_job(const FollowedJob& job, http::StreamWriter& out);

}  // namespace supple::routes
