#include "scheduler.h"

#include <algorithm>
#include <utility>

namespace supple::jobs {

void Scheduler::admit(const JobPointer& job) {
  const std::lock_guard lock(mutex_);
  if (refusing_) throw Error("server.shutting_down", "The server is shutting down.");
  queue_.require_place(job->computation);
  add(job, job->row == Row::being_written);
}

bool Scheduler::adopt(const JobPointer& job) {
  const std::lock_guard lock(mutex_);
  if (refusing_ || board_.has(job->id)) return false;
  add(job, false);
  return true;
}

void Scheduler::add(const JobPointer& job, bool waits_for_row) {
  if (!waits_for_row) enter_session(*job);
  queue_.add(job, waits_for_row);
  board_.add(job);  // last: from here on, other threads may end it
  if (!waits_for_row) work_.notify_one();
}

void Scheduler::enter_session(Job& job) { job.number_in_session = sessions_.enter(job.computation.session, job.token); }

void Scheduler::pause(const Job& job) {
  const std::lock_guard lock(mutex_);
  queue_.pause(job, true);
}

void Scheduler::resume(const Job& job) {
  const std::lock_guard lock(mutex_);
  queue_.pause(job, false);
  work_.notify_one();
}

void Scheduler::forget(const Job& job) {
  sessions_.leave(job.computation.session, job.number_in_session);
  const std::lock_guard lock(mutex_);
  queue_.remove(job);
}

Scheduler::Seat& Scheduler::add_seat() {
  const std::lock_guard lock(mutex_);
  return seats_.emplace_back();
}

void Scheduler::remove_seat(const Seat& seat) {
  const std::lock_guard lock(mutex_);
  seats_.remove_if([&](const Seat& one) { return &one == &seat; });
}

std::optional<Scheduler::Task> Scheduler::take(Seat& seat) {
  std::vector<JobPointer> skipped;  // destroyed after the mutex is unlocked: destructors of jobs run code of others
  std::unique_lock lock(mutex_);
  while (true) {
    JobPointer job;
    work_.wait(lock, [&] { return ending_ || (running_ < worker_limit() && (job = queue_.next())); });
    if (ending_) return std::nullopt;
    queue_.remove(*job);
    auto start = board_.start(*job);
    if (!start) {
      skipped.push_back(std::move(job));
      continue;
    }
    queue_.begin(*job);
    ++running_;
    seat = {job, job->computation.client, Clock::now(), queue_.is_last_attempt(*job), {}};
    if (seat.is_last_attempt) queue_.set_last_attempt_runs(true);
    return Task{std::move(job), std::move(start->record)};
  }
}

void Scheduler::set_computed(Seat& seat) {
  const std::lock_guard lock(mutex_);
  seat.job.reset();
}

std::optional<Watchdog::Overdue> Scheduler::leave(Seat& seat) {
  const std::lock_guard lock(mutex_);
  seat.job.reset();
  queue_.end(seat.client);
  if (const auto abandoned = std::exchange(seat.abandoned, std::nullopt)) {
    --abandoned_jobs_;
    return abandoned;
  }
  set_idle(seat);
  queue_.note_time(std::chrono::duration<double>(Clock::now() - seat.begin).count());
  return std::nullopt;
}

void Scheduler::set_idle(Seat& seat) {
  --running_;
  const bool was_last_attempt = std::exchange(seat.is_last_attempt, false);
  if (was_last_attempt) queue_.set_last_attempt_runs(false);
  // Otherwise the worker itself takes the next job.
  if (was_last_attempt || seat.abandoned) work_.notify_all();
  idle_.notify_all();
}

std::vector<Scheduler::LateJob> Scheduler::abandon_late_jobs() {
  const std::lock_guard lock(mutex_);
  std::vector<LateJob> late;
  if (ending_) return late;
  for (auto& seat : seats_) {
    if (!seat.job) continue;
    const auto since = board_.overdue(*seat.job, Clock::now());
    if (!since) continue;
    const bool is_abandoned = !seat.abandoned && abandoned_jobs_ < worker_limit();
    late.push_back({seat.job, *since, is_abandoned});
    if (!is_abandoned) continue;
    seat.abandoned = since;
    ++abandoned_jobs_;
    set_idle(seat);
  }
  return late;
}

std::size_t Scheduler::missing_workers() const {
  const std::lock_guard lock(mutex_);
  const auto wanted = worker_limit() + abandoned_jobs_;
  return ending_ || seats_.size() >= wanted ? 0 : wanted - seats_.size();
}

std::size_t Scheduler::abandoned() const {
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  const auto is_late = [&](const Seat& seat) { return seat.abandoned || (seat.job && board_.overdue(*seat.job, now)); };
  return static_cast<std::size_t>(std::count_if(seats_.begin(), seats_.end(), is_late));
}

bool Scheduler::is_abandoned(const Seat& seat) const {
  const std::lock_guard lock(mutex_);
  return seat.abandoned.has_value();
}

std::vector<JobPointer> Scheduler::stopped_jobs() const {
  const std::lock_guard lock(mutex_);
  return queue_.stopped_jobs();
}

std::size_t Scheduler::running() const {
  const std::lock_guard lock(mutex_);
  return running_;
}

std::size_t Scheduler::waiting() const {
  const std::lock_guard lock(mutex_);
  return queue_.size();
}

std::optional<std::size_t> Scheduler::idle_workers() const {
  const std::lock_guard lock(mutex_);
  if (refusing_) return std::nullopt;
  const auto busy = running_ + queue_.size();
  return busy < worker_limit() ? worker_limit() - busy : 0;
}

void Scheduler::refuse() {
  const std::lock_guard lock(mutex_);
  refusing_ = true;
  for (const auto& job : queue_.jobs()) job->token.request(StopReason::shutdown);
}

void Scheduler::wait_until_idle(std::optional<Clock::time_point> end) const {
  std::unique_lock lock(mutex_);
  const auto is_idle = [this] { return running_ == 0; };
  if (end) {
    idle_.wait_until(lock, *end, is_idle);
  } else {
    idle_.wait(lock, is_idle);
  }
}

void Scheduler::end() {
  const std::lock_guard lock(mutex_);
  ending_ = true;
  work_.notify_all();
}

std::vector<JobPointer> Scheduler::waiting_jobs() const {
  const std::lock_guard lock(mutex_);
  return queue_.jobs();
}

}  // namespace supple::jobs
