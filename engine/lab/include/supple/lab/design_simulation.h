#pragma once

#include "supple/base/cancellation.h"
#include "supple/dataset/dataset.h"
#include "supple/lab/dataset_options.h"
#include "supple/lab/design_sequence.h"

namespace supple::lab {

/// Is told about each state that was reached or given up, by the thread that computed it.
class StateListener {
 public:
  virtual ~StateListener() = default;
  virtual void state_reached() = 0;
};

/// Simulates all paths of one design on the calling thread.
///
/// A design that the engine refuses, for example because of its shape, is returned as rejected with the code and
/// sentence of the error. A path that stops early says why, and the other paths go on. Throws only "job.cancelled" if a
/// stop is requested, and std::bad_alloc, because neither says anything about the design.
dataset::Design simulate_design(const DatasetOptions& options, const PlannedDesign& planned,
                                const CancellationToken& cancellation = {}, StateListener* listener = nullptr);

}  // namespace supple::lab
