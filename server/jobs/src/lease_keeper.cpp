#include "lease_keeper.h"

#include <map>
#include <utility>
#include <vector>

namespace supple::jobs {

LeaseKeeper::LeaseKeeper(store::LeaseStore& leases, const store::JobStore& jobs, JobBoard& board,
                         const Scheduler& scheduler, const Journal& journal, JobRunner& runner, JobQueue::Log log)
    : leases_(leases),
      jobs_(jobs),
      board_(board),
      scheduler_(scheduler),
      journal_(journal),
      runner_(runner),
      log_(std::move(log)) {}

std::chrono::milliseconds LeaseKeeper::renew() {
  constexpr std::chrono::milliseconds interval{500};
  constexpr std::chrono::milliseconds interval_while_there_are_more{50};
  bool has_taken = false;
  try {
    has_taken = exchange();
    if (!answers_ && log_) log_("the database that servers share answers again");
    answers_ = true;
  } catch (const Error& error) {
    // Other servers may take the jobs before the database answers again. The next call then learns of it.
    if (answers_ && log_) log_(std::string("the database that servers share does not answer: ") + error.what());
    answers_ = false;
  }
  return has_taken ? interval_while_there_are_more : interval;
}

bool LeaseKeeper::exchange() {
  const auto known = board_.leased_jobs();  // read first, so that a job leased later is not taken for lost
  std::vector<store::JobProgress> progress;
  for (const auto& job : known)
    if (job.progress) progress.push_back(*job.progress);
  std::map<std::string, std::int64_t> leased;
  for (auto& [id, fencing_token] : leases_.renew_leases(progress)) leased.emplace(std::move(id), fencing_token);
  for (const auto& [job, fencing_token, version, new_progress] : known) {
    if (new_progress) job->shared_version = version;  // set last: a failed renewal has told no other server
    const auto found = leased.find(job->id);
    if (found != leased.end() && found->second == fencing_token) {
      leased.erase(found);
    } else {
      runner_.lose(job);
    }
  }
  for (const auto& [id, fencing_token] : leased) take_over_unless_known(id, fencing_token);

  const auto idle = scheduler_.idle_workers();
  if (!idle) return false;
  auto taken = leases_.lease_jobs(*idle);
  for (auto& record : taken) runner_.take_over(std::move(record));
  return !taken.empty();
}

void LeaseKeeper::take_over_unless_known(const std::string& id, std::int64_t fencing_token) {
  const auto is_known = [&] { return !scheduler_.idle_workers() || board_.has(id) || journal_.refused_end(id); };
  if (is_known()) return;
  // Either the answer to the call that leased the job was lost, or the job has ended meanwhile.
  auto record = jobs_.job(id);
  if (!record || is_finished(record->state) || record->fencing_token != fencing_token) return;
  if (!is_known()) runner_.take_over(*std::move(record));
}

}  // namespace supple::jobs
