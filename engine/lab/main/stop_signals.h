#pragma once

#include "supple/base/cancellation.h"

namespace supple::lab {

/// Turns the first SIGINT or SIGTERM into a request to stop; a second one ends the process at once, which loses nothing
/// but the designs at work. To be made before any thread, so that all of them leave the signals to it.
class StopSignals {
 public:
  StopSignals();
  const CancellationToken& cancellation() const { return cancellation_; }

 private:
  CancellationToken cancellation_;
};

}  // namespace supple::lab
