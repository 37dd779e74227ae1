#include "interrupt.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <mutex>
#include <thread>
#include <utility>

#include "exit_code.h"

namespace supple::cli {
namespace {

std::atomic<bool> is_interrupted = false;
std::mutex action_mutex;
std::function<void()> current_action;

void watch(sigset_t signals) {
  int signal_number = 0;
  while (sigwait(&signals, &signal_number) == 0) {
    // A second Ctrl-C means that the user does not want to wait for the cancellation.
    if (is_interrupted.exchange(true)) _exit(static_cast<int>(ExitCode::interrupted));
    const std::lock_guard lock(action_mutex);
    if (!current_action) _exit(static_cast<int>(ExitCode::interrupted));
    current_action();
  }
}

}  // namespace

InterruptWatch::InterruptWatch() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread(watch, signals).detach();
}

bool InterruptWatch::interrupted() { return is_interrupted; }

InterruptWatch::Scope::Scope(std::function<void()> action) {
  const std::lock_guard lock(action_mutex);
  outer_ = std::exchange(current_action, std::move(action));
}

InterruptWatch::Scope::~Scope() {
  const std::lock_guard lock(action_mutex);
  current_action = std::move(outer_);
}

}  // namespace supple::cli
