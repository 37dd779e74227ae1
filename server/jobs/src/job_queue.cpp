#include "supple/jobs/job_queue.h"

#include <openssl/rand.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "job.h"
#include "supple/base/watched_work.h"
#include "supple/budget/computation_memory.h"
#include "supple/log/context.h"

namespace supple::jobs {
namespace {

constexpr std::chrono::milliseconds look_at_client{20};
constexpr std::chrono::milliseconds look_at_queue{250};  // and at the jobs that run
constexpr std::chrono::minutes look_at_store{1};
constexpr std::chrono::seconds write_again{1};

problem::ProblemError queue_full(const std::string& detail, double limit, double value, const std::string& setting,
                                 int retry_after) {
  return problem::ProblemError({"job.queue_full",
                                detail + " (setting " + setting + ").",
                                {},
                                problem::Limit{limit, value, setting},
                                retry_after});
}

/// There is a job with this key of idempotency.
class KeyWasUsed : public Error {
 public:
  KeyWasUsed() : Error("job.key_reused", "The Idempotency-Key of this request is used by another one.") {}
};

[[noreturn]] void throw_shutting_down() { throw Error(stopped_by_shutdown, "The server is shutting down."); }

/// Writes the seconds of its lifetime.
class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds) {}
  ~Stopwatch() { seconds_ = std::chrono::duration<double>(Clock::now() - begin_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& seconds_;
  const Clock::time_point begin_ = Clock::now();
};

/// The answer outlives its computation, which paid for it: from here on the request does.
Result held_by_request(Result result) {
  budget::reserve(static_cast<std::int64_t>(result.body.size()), "its answer");
  return result;
}

problem::Problem given_up(int attempts, int limit) {
  return {"job.given_up",
          "The server ended " + std::to_string(attempts) + " times while this job ran; it is not run again (setting " +
              "--max-attempts).",
          {},
          problem::Limit{static_cast<double>(limit), static_cast<double>(attempts), "--max-attempts"},
          {}};
}

}  // namespace

std::string random_id() {
  std::array<unsigned char, 16> bytes{};
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) throw std::runtime_error("no random bytes");
  constexpr char digits[] = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : bytes) {
    text += digits[byte >> 4];
    text += digits[byte & 15];
  }
  return text;
}

JobQueue::JobQueue(store::Store& store, const QueueOptions& options, Render render, Observe observe, Log log,
                   Remake remake)
    : store_(store),
      options_(options),
      render_(std::move(render)),
      observe_(std::move(observe)),
      log_(std::move(log)),
      remake_(std::move(remake)),
      watchdog_([this] {
        if (options_.memory) options_.memory->relieve();
      }),
      slots_(options.immediate) {
  resume();
  for (int i = 0; i < options_.workers; ++i) add_worker();
  cleaner_ = std::thread([this] { clean_up(); });
  if (store_.is_shared()) keeper_ = std::thread([this] { share(); });
}

void JobQueue::resume() {
  const std::lock_guard lock(mutex_);
  for (auto record : store_.unfinished_jobs()) take_over(std::move(record));
}

void JobQueue::take_over(store::JobRecord record) {
  if (!remake_ || !store_.has_request(record.id)) {
    fail_at_start(std::move(record), interrupted());
  } else if (record.state == JobState::running && record.attempts >= options_.max_attempts) {
    const auto problem = given_up(record.attempts, options_.max_attempts);
    fail_at_start(std::move(record), problem);
  } else {
    record.state = JobState::accepted;
    record.started = 0;
    const auto job = make_job(computation_again(record));
    job->record = std::move(record);
    job->visible = true;
    job->kept = true;
    add(job);
  }
}

/// The request is read once a worker has the job: until then it takes no memory, and what it does wrong counts as an
/// attempt.
Computation JobQueue::computation_again(const store::JobRecord& record) {
  Computation computation{record.kind, record.mesh, record.deadline, {}, record.session, record.client};
  computation.run = [this, record](const Execution& execution) {
    auto request = store_.job_request(record.id);
    return remake_(record, std::move(request), execution).run(execution);
  };
  return computation;
}

JobQueue::~JobQueue() {
  shut_down(0);
  for (auto& worker : workers_) {
    if (worker.thread.joinable()) worker.thread.join();
  }
}

Result JobQueue::run_now(const Computation& computation, Waiting waiting, Profile* profile) {
  const CancellationToken token;
  std::uint64_t ticket = 0;
  std::uint64_t in_session = 0;
  {
    const std::lock_guard lock(mutex_);
    if (refusing_) throw_shutting_down();
    ticket = ++next_immediate_;
    immediate_.emplace(ticket, Immediate{token});
    in_session = enter_session(computation.session, token);
  }
  struct Leave {
    JobQueue& queue;
    std::uint64_t ticket;
    const Computation& computation;
    std::uint64_t in_session;
    ~Leave() {
      std::optional<Watchdog::Overdue> abandoned;
      {
        const std::lock_guard lock(queue.mutex_);
        const auto entry = queue.immediate_.find(ticket);
        abandoned = entry->second.abandoned;
        if (abandoned) --queue.abandoned_immediate_;
        queue.immediate_.erase(entry);
        queue.leave_session(computation.session, in_session);
        if (queue.refusing_) queue.changed_.notify_all();
      }
      if (abandoned) queue.tell_returned(computation, *abandoned);
    }
  } const leave{*this, ticket, computation, in_session};
  Profile unseen;
  Profile& seen = profile ? *profile : unseen;
  // The slot outlives the watch, which may give it up.
  std::optional<ComputeSlots::Slot> slot;
  std::atomic<ComputeSlots::Slot*> held{nullptr};
  bool answered = false;
  const std::string whose(log::context_text());
  const auto abandon = [&](const Watchdog::Overdue& overdue) {
    const bool is_replaced = abandon_immediate(ticket, overdue);
    if (auto* const of_computation = held.load()) of_computation->give_up();
    answered = true;
    if (waiting.answer_for_it) waiting.answer_for_it(problem_of_stop(overdue.reason), is_replaced);
    tell_abandoned(whose, computation, overdue);
  };
  Result result;
  {
    const Watchdog::Guard watch(
        watchdog_, {token, Clock::now() + duration(computation.deadline), std::move(waiting.hung_up), abandon});
    if (computation.takes_slot) {
      const Stopwatch waited(seen.waited);
      slot.emplace(slots_, token, computation.client);
      held = &*slot;
      token.throw_if_requested();  // nobody gives up what was not held yet
    }
    const Stopwatch computed(seen.computed);
    Execution execution;
    execution.cancellation = token;
    result = compute(computation, execution, &seen);
  }
  if (answered) token.throw_if_requested();
  return held_by_request(std::move(result));
}

Result JobQueue::compute(const Computation& computation, const Execution& execution, Profile* profile) const {
  const WatchedWork watched;
  if (!options_.memory) return computation.run(execution);
  budget::ComputationMemory memory(*options_.memory, execution.cancellation);
  struct NotePeak {
    const budget::ComputationMemory& memory;
    Profile* profile;
    ~NotePeak() {
      if (profile) profile->peak_memory = memory.peak();
    }
  } const note{memory, profile};
  try {
    const MemoryAccount::Use use(&memory);
    return computation.run(execution);
  } catch (...) {
    // However the stop reached its end: as a stop, as a lack of memory, or as an error that came of it.
    memory.throw_if_stopped();
    throw;
  }
}

std::uint64_t JobQueue::enter_session(const std::string& session, const CancellationToken& token) {
  if (session.empty()) return 0;
  const auto number = ++next_in_session_;
  const auto [entry, is_new] = sessions_.try_emplace(session, number, token);
  if (!is_new) {
    entry->second.second.request(StopReason::superseded);
    entry->second = {number, token};
  }
  return number;
}

void JobQueue::leave_session(const std::string& session, std::uint64_t number) {
  const auto entry = sessions_.find(session);
  if (entry != sessions_.end() && entry->second.first == number) sessions_.erase(entry);
}

JobQueue::JobPointer JobQueue::make_job(Computation computation) {
  auto job = std::make_shared<Job>(*this, std::move(computation));
  auto& record = job->record;
  record.id = random_id();
  record.kind = job->computation.kind;
  record.mesh = job->computation.mesh;
  record.created = store::now_milliseconds();
  record.deadline = job->computation.deadline;
  record.client = job->computation.client;
  record.session = job->computation.session;
  record.owner = job->computation.owner;
  record.idempotency_key = job->computation.idempotency_key;
  record.request_hash = job->computation.request_hash;
  job->due = Clock::now() + duration(job->computation.deadline);
  job->watch = std::make_unique<Watchdog::Guard>(watchdog_, Watchdog::Watch{job->token, job->due, {}});
  return job;
}

void JobQueue::add(const JobPointer& job) {
  job->in_session = enter_session(job->computation.session, job->token);
  jobs_.emplace(job->record.id, job);
  queue_.push_back(job);
  queue_bytes_ += job->computation.bytes;
  work_.notify_one();
}

JobQueue::JobPointer JobQueue::enqueue(Computation computation, const std::optional<RequestOfJob>& request,
                                       bool visible) {
  auto job = make_job(std::move(computation));
  const auto require = [&] {
    if (refusing_) throw_shutting_down();
    require_place(job->computation);
  };
  if (!visible) {
    const std::lock_guard lock(mutex_);
    require();
    add(job);
    return job;
  }
  {
    const std::lock_guard lock(mutex_);
    require();  // what is refused does not go to the disk
  }
  with_request(job->record, request, [&](const std::string& kept) {
    const std::lock_guard lock(mutex_);
    require();
    publish(*job, request.has_value(), kept);
    add(job);
    return true;
  });
  return job;
}

void JobQueue::with_request(const store::JobRecord& record, const std::optional<RequestOfJob>& request,
                            const std::function<bool(const std::string& kept)>& publish) {
  const auto kept = request ? store_.keep_request(record, request->request, request->body) : std::string();
  try {
    if (publish(kept)) return;
  } catch (...) {
    if (request) store_.drop_request(record.id);
    throw;
  }
  if (request) store_.drop_request(record.id);
}

void JobQueue::require_place(const Computation& computation) const {
  const auto bytes = computation.bytes;
  // A place is free once one of the workers has taken the next job.
  constexpr double longest = 3600;
  const double seconds = std::clamp(mean_seconds_ / options_.workers, 1.0, longest);
  const int retry_after = static_cast<int>(std::ceil(seconds));
  const auto is_of_client = [&](const JobPointer& job) { return job->computation.client == computation.client; };
  if (const auto most = computation.max_waiting;
      most > 0 && std::count_if(queue_.begin(), queue_.end(), is_of_client) >= most) {
    throw problem::ProblemError({"job.client_queue_full",
                                 std::to_string(most) + " jobs of this key wait for a worker, its limit (setting "
                                                        "--max-waiting-jobs of its key).",
                                 {},
                                 problem::Limit{1.0 * most, 1.0 * most + 1, "--max-waiting-jobs"},
                                 retry_after});
  }
  if (queue_.size() >= options_.max_queue) {
    const auto limit = static_cast<double>(options_.max_queue);
    throw queue_full("The queue holds " + std::to_string(options_.max_queue) + " jobs, its limit", limit, limit + 1,
                     "--max-queue", retry_after);
  }
  if (queue_bytes_ + bytes > options_.max_queue_bytes) {
    throw queue_full("With this job those that wait would hold " + std::to_string(queue_bytes_ + bytes) +
                         " bytes of memory, their limit is " + std::to_string(options_.max_queue_bytes),
                     static_cast<double>(options_.max_queue_bytes), static_cast<double>(queue_bytes_ + bytes),
                     "--max-queue-bytes", retry_after);
  }
}

bool JobQueue::is_last_attempt(const Job& job) const {
  return job.record.attempts > 0 && job.record.attempts + 1 >= options_.max_attempts;
}

std::deque<JobQueue::JobPointer>::iterator JobQueue::next_place() {
  const auto runs = [this](const JobPointer& job) {
    const auto found = running_of_.find(job->computation.client);
    return found == running_of_.end() ? 0 : found->second;
  };
  auto best = queue_.end();
  for (auto place = queue_.begin(); place != queue_.end(); ++place) {
    if (last_attempt_runs_ && is_last_attempt(**place)) continue;
    if (best == queue_.end() || runs(*place) < runs(*best)) best = place;
  }
  return best;
}

JobQueue::JobPointer JobQueue::take_next() {
  const auto next = next_place();
  auto job = *next;
  queue_bytes_ -= job->computation.bytes;
  queue_.erase(next);
  return job;
}

/// Under the mutex, so that the job cannot finish between its check and its row.
void JobQueue::publish(Job& job, bool kept, const std::string& request) {
  if (!store_.add_job(job.record, request)) throw KeyWasUsed();
  job.visible = true;
  job.kept = kept;
}

std::optional<JobStatus> JobQueue::asked_before(const std::string& key, const std::string& request_hash) const {
  if (key.empty()) return std::nullopt;
  const auto known = store_.job_of_key(key);
  if (!known) return std::nullopt;
  if (known->request_hash != request_hash)
    throw Error("job.key_reused", "The Idempotency-Key of this request was used for another request before.");
  return status(known->id);
}

JobStatus JobQueue::submit(Computation computation, const std::optional<RequestOfJob>& request) {
  const auto key = computation.idempotency_key;
  const auto hash = computation.request_hash;
  if (auto known = asked_before(key, hash)) return *std::move(known);
  try {
    const auto job = enqueue(std::move(computation), request, true);
    const std::lock_guard lock(mutex_);
    return status_of(*job);
  } catch (const KeyWasUsed&) {
    // The same request has come at the same time and has used it.
    if (auto known = asked_before(key, hash)) return *std::move(known);
    throw;
  }
}

JobQueue::ResultOrJob JobQueue::run_within(Computation computation, double seconds,
                                           const std::function<bool()>& hung_up,
                                           const std::optional<RequestOfJob>& request) {
  const auto end = Clock::now() + duration(seconds);
  const auto key = computation.idempotency_key;
  const auto hash = computation.request_hash;
  if (auto known = asked_before(key, hash)) return {std::nullopt, *std::move(known)};
  const auto job = enqueue(std::move(computation), request, false);
  std::unique_lock lock(mutex_);
  while (!job->finished && Clock::now() < end) {
    changed_.wait_until(lock, std::min(end, Clock::now() + look_at_client));
    if (job->finished) break;
    lock.unlock();
    const bool left = hung_up && hung_up();
    if (left) job->token.request(StopReason::cancelled);
    lock.lock();
    if (left && !job->left_at) job->left_at = Clock::now();
  }
  if (!job->finished) {
    const auto record = job->record;
    lock.unlock();
    try {
      make_visible(job, record, request);
    } catch (const KeyWasUsed&) {
      if (auto known = asked_before(key, hash)) return {std::nullopt, *std::move(known)};
      throw;
    }
    lock.lock();
    if (job->visible) return {std::nullopt, status_of(*job)};
  }
  if (job->failure) std::rethrow_exception(job->failure);
  auto result = *std::move(job->result);
  lock.unlock();
  return {held_by_request(std::move(result)), {}};
}

void JobQueue::make_visible(const JobPointer& job, const store::JobRecord& record,
                            const std::optional<RequestOfJob>& request) {
  try {
    with_request(record, request, [&](const std::string& kept) {
      const std::lock_guard lock(mutex_);
      if (!job->finished) publish(*job, request.has_value(), kept);
      return job->visible;
    });
  } catch (...) {
    job->token.request(StopReason::cancelled);  // nobody could ask for it
    throw;
  }
}

std::optional<JobStatus> JobQueue::remove(const std::string& id) {
  JobPointer job;
  {
    const std::lock_guard lock(mutex_);
    job = find(id);
    if (job) job->dismissed = true;
  }
  if (job) {
    job->token.request(StopReason::cancelled);
    finish(job, JobState::dismissed, std::nullopt, nullptr);
    if (!job->lost) return status(id);
  }
  // Another server may have it.
  const auto now = store::now_milliseconds();
  if (const auto record = store_.dismiss_job(id, now, now + retention_milliseconds())) return JobStatus{*record, 0, {}};
  if (!store_.remove_job(id)) throw_not_found(id);
  const std::lock_guard lock(mutex_);
  unwritten_.erase(id);
  return std::nullopt;
}

void JobQueue::add_worker() {
  auto& worker = workers_.emplace_back();
  try {
    worker.thread = std::thread([this, &worker] { work(worker); });
  } catch (...) {
    workers_.pop_back();
    throw;
  }
}

void JobQueue::work(Worker& self) {
  const auto most = static_cast<std::size_t>(options_.workers);  // there are more while some are abandoned
  std::unique_lock lock(mutex_);
  while (true) {
    work_.wait(lock, [&] { return ending_ || (running_ < most && next_place() != queue_.end()); });
    if (ending_) return;
    const auto job = take_next();
    if (job->finished) continue;
    self.last_attempt = is_last_attempt(*job);
    if (self.last_attempt) last_attempt_runs_ = true;
    self.job = job;
    job->computing = true;
    ++running_;
    ++running_of_[job->computation.client];
    const auto begin = Clock::now();
    job->record.state = JobState::running;
    job->record.started = store::now_milliseconds();
    ++job->record.attempts;
    ++job->version;
    changed_.notify_all();
    const auto record = job->visible ? std::optional(job->record) : std::nullopt;
    lock.unlock();
    if (!record || note_progress(*record)) {
      job->runs_here = true;
      run_job(job);
    } else {
      lose(job);
    }
    lock.lock();
    if (const auto of = running_of_.find(job->computation.client); --of->second == 0) running_of_.erase(of);
    self.job.reset();
    if (const auto abandoned = std::exchange(self.abandoned, std::nullopt)) {
      --abandoned_jobs_;
      lock.unlock();
      const log::Context context("job", job->record.id);
      tell_returned(job->computation, *abandoned);
      lock.lock();
      continue;
    }
    --running_;
    if (self.last_attempt) {
      last_attempt_runs_ = false;
      work_.notify_all();
    }
    constexpr double weight = 0.1;  // of the latest job in the moving average
    mean_seconds_ += weight * (std::chrono::duration<double>(Clock::now() - begin).count() - mean_seconds_);
    changed_.notify_all();
  }
}

bool JobQueue::note_progress(const store::JobRecord& record) {
  try {
    return store_.note_progress(record);
  } catch (const Error&) {
    // The store is full or unavailable: should the process end now, this attempt is one that nobody knows of.
    return true;
  }
}

void JobQueue::run_job(const JobPointer& job) {
  const log::Context context("job", job->record.id);
  std::optional<Result> result;
  std::exception_ptr failure;
  try {
    job->token.throw_if_requested();
    Execution execution;
    execution.cancellation = job->token;
    execution.progress = job.get();
    result = compute(job->computation, execution);
  } catch (...) {
    failure = std::current_exception();
  }
  {
    const std::lock_guard lock(mutex_);
    job->computing = false;
  }
  finish(job, failure ? JobState::failed : JobState::successful, std::move(result), failure);
}

void JobQueue::clean_up() {
  auto next_look_at_store = Clock::now();
  auto next_write = Clock::now();
  std::unique_lock lock(mutex_);
  while (!ending_) {
    std::vector<JobPointer> stopped;  // while they waited for a worker
    for (auto place = queue_.begin(); place != queue_.end();) {
      if ((*place)->finished || (*place)->token.requested()) {
        stopped.push_back(*place);
        queue_bytes_ -= (*place)->computation.bytes;
        place = queue_.erase(place);
      } else {
        ++place;
      }
    }
    lock.unlock();
    for (const auto& job : stopped) run_job(job);
    abandon_jobs();
    if (options_.memory) options_.memory->return_what_is_free();
    if (Clock::now() >= next_write) {
      write_what_was_refused();
      store_.take_reserve();
      next_write = Clock::now() + write_again;
    }
    if (Clock::now() >= next_look_at_store) {
      try {
        store_.remove_expired_jobs(store::now_milliseconds(), options_.max_jobs);
        if (options_.clean_up_too) options_.clean_up_too();
      } catch (const Error&) {
        // The store is unavailable, as every request that needs it says; the next look tries again.
      }
      next_look_at_store = Clock::now() + look_at_store;
    }
    lock.lock();
    end_.wait_for(lock, look_at_queue, [this] { return ending_; });
  }
}

void JobQueue::shut_down(double grace_seconds) {
  std::unique_lock lock(mutex_);
  refusing_ = true;
  for (const auto& job : queue_) job->token.request(StopReason::shutdown);
  const auto idle = [this] { return running_ == 0 && immediate_.size() == abandoned_immediate_; };
  changed_.wait_for(lock, duration(grace_seconds), idle);
  for (const auto& [id, job] : jobs_) job->token.request(StopReason::shutdown);
  for (const auto& [ticket, immediate] : immediate_) immediate.token.request(StopReason::shutdown);
  changed_.wait(lock, [this] { return running_ == 0; });
  ending_ = true;
  std::vector<std::thread*> ended;  // those of abandoned jobs go on
  for (auto& worker : workers_) {
    if (!worker.abandoned && worker.thread.joinable()) ended.push_back(&worker.thread);
  }
  const auto left = std::move(queue_);
  queue_.clear();
  work_.notify_all();
  end_.notify_all();
  lock.unlock();
  for (auto* const thread : ended) thread->join();
  if (cleaner_.joinable()) cleaner_.join();
  if (keeper_.joinable()) keeper_.join();
  for (const auto& job : left) run_job(job);
  write_what_was_refused();
}

}  // namespace supple::jobs
