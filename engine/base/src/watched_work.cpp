#include "supple/base/watched_work.h"

#ifdef SUPPLE_CHECK_PACE

#include <execinfo.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>

namespace supple {
namespace {

constexpr double default_limit = 0.05;                   // seconds
constexpr long nanoseconds_between_checks = 10'000'000;  // of CPU time
constexpr int max_stack_depth = 48;

struct ThreadWork {
  int depth = 0;
  double last_check = 0;  ///< CPU seconds of the thread at its last check
  bool is_reported = false;
};
constinit thread_local ThreadWork thread_work;

double cpu_seconds() noexcept {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The limit between two checks, seconds. SUPPLE_PACE_SECONDS sets it for slow builds, such as those with sanitizers.
double limit() noexcept {
  static const double seconds = [] {
    const char* const given = std::getenv("SUPPLE_PACE_SECONDS");
    return given ? std::atof(given) : default_limit;
  }();
  return seconds;
}

void write(const char* format, double seconds) noexcept {
  std::array<char, 120> line{};
  const int length = std::snprintf(line.data(), line.size(), format, seconds);
  // Nothing can be done about a report that cannot be written.
  if (::write(STDERR_FILENO, line.data(), static_cast<std::size_t>(length)) != length) return;
}

/// Reports work without a check that takes too long, once until the next check.
void report_if_late() noexcept {
  const double seconds = cpu_seconds() - thread_work.last_check;
  if (thread_work.depth == 0 || thread_work.is_reported || seconds <= limit()) return;
  thread_work.is_reported = true;
  std::array<void*, max_stack_depth> calls{};
  const int count = ::backtrace(calls.data(), max_stack_depth);
  write("supple: %.3f s of work without a look, in:\n", seconds);
  ::backtrace_symbols_fd(calls.data(), count, STDERR_FILENO);
}

/// Interrupts its thread after every 10 ms of CPU time, so that a report has the call stack of the work itself, and not
/// only that of the check that came too late.
class Timer {
 public:
  Timer() noexcept {
    // The first call loads a library, which a signal handler must not do.
    std::array<void*, 1> call{};
    ::backtrace(call.data(), 1);
    const int number = signal_number();
    struct sigaction action {};
    action.sa_handler = [](int) { report_if_late(); };
    action.sa_flags = SA_RESTART;
    ::sigaction(number, &action, nullptr);
    sigevent event{};
    event.sigev_notify = SIGEV_THREAD_ID;
    event.sigev_signo = number;
    event._sigev_un._tid = ::gettid();
    if (::timer_create(CLOCK_THREAD_CPUTIME_ID, &event, &timer_) != 0) return;
    is_created_ = true;
    const timespec period{0, nanoseconds_between_checks};
    const itimerspec times{period, period};
    ::timer_settime(timer_, 0, &times, nullptr);
  }
  ~Timer() {
    if (is_created_) ::timer_delete(timer_);
  }
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

 private:
  static int signal_number() noexcept { return SIGRTMIN + 5; }

  timer_t timer_{};
  bool is_created_ = false;
};

}  // namespace

void WatchedWork::checked() noexcept {
  if (thread_work.depth == 0) return;
  report_if_late();
  if (thread_work.is_reported) write("supple: a look after %.3f s\n", cpu_seconds() - thread_work.last_check);
  thread_work.last_check = cpu_seconds();
  thread_work.is_reported = false;
}

WatchedWork::WatchedWork() noexcept {
  thread_local const Timer timer;
  if (thread_work.depth++ > 0) return;
  thread_work.last_check = cpu_seconds();
  thread_work.is_reported = false;
}

WatchedWork::~WatchedWork() {
  checked();
  --thread_work.depth;
}

}  // namespace supple

#endif
