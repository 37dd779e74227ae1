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
  if (!waits_for_row) workers_for(job->computation.priority).work.notify_one();
}

void Scheduler::enter_session(Job& job) { job.number_in_session = sessions_.enter(job.computation.session, job.token); }

void Scheduler::pause(const Job& job) {
  const std::lock_guard lock(mutex_);
  queue_.pause(job, true);
}

void Scheduler::resume(const Job& job) {
  const std::lock_guard lock(mutex_);
  queue_.pause(job, false);
  workers_for(job.computation.priority).work.notify_one();
}

void Scheduler::forget(const Job& job) {
  sessions_.leave(job.computation.session, job.number_in_session);
  const std::lock_guard lock(mutex_);
  queue_.remove(job);
}

Scheduler::Seat& Scheduler::add_seat(WorkerKind kind) {
  const std::lock_guard lock(mutex_);
  return seats_.emplace_back(Seat{.kind = kind});
}

void Scheduler::remove_seat(const Seat& seat) {
  const std::lock_guard lock(mutex_);
  seats_.remove_if([&](const Seat& one) { return &one == &seat; });
}

JobPointer Scheduler::next_job(WorkerKind kind) const {
  const auto running = workers_of(kind).running;
  if (kind == WorkerKind::background)
    return running < worker_limit() ? queue_.next(Priority::background, Priority::background) : nullptr;
  if (running > worker_limit()) return nullptr;
  return queue_.next(Priority::interactive, running < worker_limit() ? Priority::normal : Priority::interactive);
}

std::optional<Scheduler::Task> Scheduler::take(Seat& seat) {
  std::vector<JobPointer> skipped;  // destroyed after the mutex is unlocked: destructors of jobs run code of others
  std::unique_lock lock(mutex_);
  auto& workers = workers_of(seat.kind);
  while (true) {
    JobPointer job;
    workers.work.wait(lock, [&] { return ending_ || (job = next_job(seat.kind)); });
    if (ending_) return std::nullopt;
    queue_.remove(*job);
    auto start = board_.start(*job);
    if (!start) {
      skipped.push_back(std::move(job));
      continue;
    }
    queue_.begin(*job);
    ++workers.running;
    const auto& computation = job->computation;
    seat = {seat.kind, job, computation.client, computation.priority, Clock::now(), queue_.is_last_attempt(*job), {}};
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
  queue_.end(seat.client, seat.priority);
  if (const auto abandoned = std::exchange(seat.abandoned, std::nullopt)) {
    --workers_of(seat.kind).abandoned_jobs;
    return abandoned;
  }
  set_idle(seat);
  queue_.note_time(std::chrono::duration<double>(Clock::now() - seat.begin).count());
  return std::nullopt;
}

void Scheduler::set_idle(Seat& seat) {
  --workers_of(seat.kind).running;
  const bool was_last_attempt = std::exchange(seat.is_last_attempt, false);
  if (was_last_attempt) queue_.set_last_attempt_runs(false);
  // Otherwise the worker itself takes the next job.
  if (was_last_attempt || seat.abandoned) {
    foreground_.work.notify_all();
    background_.work.notify_all();
  }
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
    auto& abandoned_jobs = workers_of(seat.kind).abandoned_jobs;
    const bool is_abandoned = !seat.abandoned && abandoned_jobs < worker_limit();
    late.push_back({seat.job, *since, is_abandoned});
    if (!is_abandoned) continue;
    seat.abandoned = since;
    ++abandoned_jobs;
    set_idle(seat);
  }
  return late;
}

std::size_t Scheduler::seats(WorkerKind kind) const {
  return static_cast<std::size_t>(
      std::count_if(seats_.begin(), seats_.end(), [&](const Seat& seat) { return seat.kind == kind; }));
}

std::size_t Scheduler::missing_workers(WorkerKind kind) const {
  const std::lock_guard lock(mutex_);
  const std::size_t for_interactive_jobs = kind == WorkerKind::foreground ? 1 : 0;
  const auto wanted = worker_limit() + for_interactive_jobs + workers_of(kind).abandoned_jobs;
  const auto present = seats(kind);
  return ending_ || present >= wanted ? 0 : wanted - present;
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
  return foreground_.running + background_.running;
}

std::size_t Scheduler::waiting() const {
  const std::lock_guard lock(mutex_);
  return queue_.size();
}

std::size_t Scheduler::waiting(Priority priority) const {
  const std::lock_guard lock(mutex_);
  return queue_.size(priority);
}

std::optional<store::IdleWorkers> Scheduler::idle_workers() const {
  const std::lock_guard lock(mutex_);
  if (refusing_) return std::nullopt;
  const auto in_background = queue_.size(Priority::background);
  const auto idle = [&](std::size_t busy) { return busy < worker_limit() ? worker_limit() - busy : 0; };
  return store::IdleWorkers{idle(foreground_.running + queue_.size() - in_background),
                            idle(background_.running + in_background)};
}

void Scheduler::refuse() {
  const std::lock_guard lock(mutex_);
  refusing_ = true;
  for (const auto& job : queue_.jobs()) job->token.request(StopReason::shutdown);
}

void Scheduler::wait_until_idle(std::optional<Clock::time_point> end) const {
  std::unique_lock lock(mutex_);
  const auto is_idle = [this] { return foreground_.running + background_.running == 0; };
  if (end) {
    idle_.wait_until(lock, *end, is_idle);
  } else {
    idle_.wait(lock, is_idle);
  }
}

void Scheduler::end() {
  const std::lock_guard lock(mutex_);
  ending_ = true;
  foreground_.work.notify_all();
  background_.work.notify_all();
}

std::vector<JobPointer> Scheduler::waiting_jobs() const {
  const std::lock_guard lock(mutex_);
  return queue_.jobs();
}

}  // namespace supple::jobs
