#pragma once

#include "supple/base/cancellation.h"
#include "supple/dataset/dataset.h"
#include "supple/lab/dataset_options.h"
#include "supple/lab/design_sequence.h"

namespace supple::lab {

/// Hears of each state that was reached or given up, from the thread that computed it.
class StateListener {
 public:
  virtual ~StateListener() = default;
  virtual void state_reached() = 0;
};

/// Simulates all paths of one design on the calling thread.
///
/// A design that the engine refuses, e.g. for its shape, comes back rejected with the error's code and sentence; a path
/// that stops early says why, and the other paths go on. Throws only "job.cancelled" once a stop is requested, and
/// std::bad_alloc: neither says anything about the design.
dataset::Design simulate_design(const DatasetOptions& options, const PlannedDesign& planned,
                                const CancellationToken& cancellation = {}, StateListener* listener = nullptr);

}  // namespace supple::lab
