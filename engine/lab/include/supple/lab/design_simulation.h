#pragma once

#include "supple/base/cancellation.h"
#include "supple/dataset/dataset.h"
#include "supple/lab/dataset_options.h"
#include "supple/lab/design_sequence.h"

namespace supple::lab {

/// Listens to each state that was reached or given up. It is called by the thread that computed the state.
class StateListener {
 public:
  virtual ~StateListener() = default;
  virtual void state_reached() = 0;
};

/// Simulates all paths of one design on the calling thread.
///
/// A design that the engine refuses, for example because of its shape, is returned as rejected, with the code and
/// message of the error. A path that stops early records the reason, and the other paths are computed. Throws only
/// Cancelled if a stop is requested, and std::bad_alloc, because neither depends on the design alone.
dataset::Design simulate_design(const DatasetOptions& options, const PlannedDesign& planned,
                                const CancellationToken& cancellation = {}, StateListener* listener = nullptr);

}  // namespace supple::lab
