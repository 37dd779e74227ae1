#pragma once

#include <array>
#include <vector>

#include "error_regression.h"
#include "supple/base/cancellation.h"
#include "supple/training/model_calibration.h"
#include "supple/training/model_training.h"

namespace supple::training {

/// Errors of a network at simulated states, and what a request for them would be told.
struct CalibrationStates {
  struct Of {
    ObservedErrors observed;         ///< of states within the ranges of training
    std::vector<double> relative;    ///< error over the simulated value, as the thesis counts; of Poisson's ratio plain
    std::vector<double> out_of_box;  ///< the same, of held-out states beyond those ranges, which have no error bar
  };
  using Quantities = std::array<Of, neural::all_quantities.size()>;  ///< of neural::all_quantities
  Quantities of;
  int folds = 0;
  int held_designs = 0;
  /// Designs that searches have found: folds as above, and none that trained.
  Quantities searched;
  int searched_folds = 0;
  int searched_designs = 0;
};

/// Held-out designs are dealt into `most_folds` folds at most, at random. They are those of `references` where it has
/// any, and otherwise those that the model's split holds out of its data. Throws "training.no_samples".
CalibrationStates calibration_states(const neural::Model& model, const ModelData& data, const References& references,
                                     int most_folds, const CancellationToken& cancellation);

}  // namespace supple::training
