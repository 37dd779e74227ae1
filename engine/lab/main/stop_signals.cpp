#include "stop_signals.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <thread>

#include "exit_code.h"

namespace supple::lab {

StopSignals::StopSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread([signals, cancellation = cancellation_] {
    int number = 0;
    while (sigwait(&signals, &number) == 0) {
      if (cancellation.requested()) _exit(static_cast<int>(ExitCode::interrupted));
      cancellation.request(StopReason::cancelled);
    }
  }).detach();
}

}  // namespace supple::lab
