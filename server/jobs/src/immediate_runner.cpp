#include "immediate_runner.h"

#include <string>
#include <utility>

#include "run_computation.h"
#include "supple/log/context.h"

namespace supple::jobs {
namespace {

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

}  // namespace

/// The place of a computation among those that run, and in its session.
class ImmediateRunner::Place {
 public:
  Place(ImmediateRunner& runner, const Computation& computation, const CancellationToken& token)
      : runner_(runner),
        computation_(computation),
        number_(runner.enter(token)),
        number_in_session_(enter_session(token)) {}
  ~Place() {
    runner_.sessions_.leave(computation_.session, number_in_session_);
    if (const auto abandoned = runner_.leave(number_)) runner_.log_.note_returned(computation_, *abandoned);
  }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  std::uint64_t number() const { return number_; }

 private:
  /// Called by the constructor, after the computation has its place among those that run.
  std::uint64_t enter_session(const CancellationToken& token) {
    try {
      return runner_.sessions_.enter(computation_.session, token);
    } catch (...) {
      runner_.leave(number_);
      throw;
    }
  }

  ImmediateRunner& runner_;
  const Computation& computation_;
  const std::uint64_t number_;
  const std::uint64_t number_in_session_;
};

Result ImmediateRunner::run(const Computation& computation, Waiting waiting, Profile* profile) {
  const CancellationToken token;
  const Place place(*this, computation, token);
  Profile unused;
  Profile& noted = profile ? *profile : unused;
  // The slot is declared before the watch, because the watch may give it up.
  std::optional<ComputeSlots::Slot> slot;
  std::atomic<ComputeSlots::Slot*> held_slot{nullptr};
  StopReason answered = StopReason::none;  // why the client was answered in place of the computation
  const std::string whose(log::context_text());
  const auto give_up = [&](const Watchdog::Overdue& overdue) {
    const bool is_replaced = abandon(place.number(), overdue);
    if (auto* const held = held_slot.load()) held->give_up();
    answered = overdue.reason;
    if (waiting.answer_for_it) waiting.answer_for_it(problem::problem_of(failure_of_stop(overdue.reason)), is_replaced);
    log_.note_abandoned(whose, computation, overdue);
  };
  Result result;
  {
    const Watchdog::Guard watch(
        watchdog_, {token, Clock::now() + duration(computation.deadline), std::move(waiting.hung_up), give_up});
    if (computation.takes_slot) {
      const Stopwatch waited(noted.waited);
      slot.emplace(slots_, token, computation.client, computation.priority);
      held_slot = &*slot;
      token.throw_if_requested();  // from here on, the watch gives the slot up if the computation does not stop
    }
    const Stopwatch computed(noted.computed);
    Execution execution;
    execution.cancellation = token;
    result = run_computation(computation, execution, options_.memory, &noted);
  }
  // Also where the computation has taken its stop back and returned the best that it had.
  if (answered != StopReason::none) std::rethrow_exception(failure_of_stop(answered));
  return charge_request(std::move(result));
}

std::uint64_t ImmediateRunner::enter(const CancellationToken& token) {
  const std::lock_guard lock(mutex_);
  if (refusing_) throw Error("server.shutting_down", "The server is shutting down.");
  running_.emplace(++last_number_, Running{token});
  return last_number_;
}

std::optional<Watchdog::Overdue> ImmediateRunner::leave(std::uint64_t number) {
  const std::lock_guard lock(mutex_);
  const auto entry = running_.find(number);
  const auto abandoned = entry->second.abandoned;
  if (abandoned) --abandoned_;
  running_.erase(entry);
  if (refusing_) idle_.notify_all();
  return abandoned;
}

bool ImmediateRunner::abandon(std::uint64_t number, const Watchdog::Overdue& overdue) {
  const std::lock_guard lock(mutex_);
  running_.at(number).abandoned = overdue;
  if (refusing_) idle_.notify_all();
  return ++abandoned_ <= static_cast<std::size_t>(options_.immediate);
}

std::size_t ImmediateRunner::abandoned() const {
  const std::lock_guard lock(mutex_);
  return abandoned_;
}

void ImmediateRunner::refuse() {
  const std::lock_guard lock(mutex_);
  refusing_ = true;
}

void ImmediateRunner::wait_until_idle(Clock::time_point end) const {
  std::unique_lock lock(mutex_);
  idle_.wait_until(lock, end, [this] { return running_.size() == abandoned_; });
}

void ImmediateRunner::stop_all() {
  const std::lock_guard lock(mutex_);
  for (const auto& [number, running] : running_) running.token.request(StopReason::shutdown);
}

}  // namespace supple::jobs
