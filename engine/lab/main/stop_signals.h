#pragma once

#include "supple/base/cancellation.h"

namespace supple::lab {

/// Turns the first SIGINT or SIGTERM into a stop request. A second one ends the process at once, which loses unfinished
/// designs only. It must be created before any thread, because threads inherit that these signals are blocked.
class StopSignals {
 public:
  StopSignals();
  const CancellationToken& cancellation() const { return cancellation_; }

 private:
  CancellationToken cancellation_;
};

}  // namespace supple::lab
