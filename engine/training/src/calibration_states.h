#pragma once

#include <array>
#include <vector>

#include "error_regression.h"
#include "supple/base/cancellation.h"
#include "supple/training/model_calibration.h"
#include "supple/training/model_training.h"

namespace supple::training {

/// Errors of a network at simulated states, with the features on which its error bars depend.
struct CalibrationStates {
  /// States of one quantity. The box is the range of parameters and strains of the training (neural::in_range).
  struct QuantityStates {
    ObservedErrors observed;             ///< states within the box
    std::vector<double> relative_error;  ///< their errors relative to the simulation; absolute for Poisson's ratio
    std::vector<double> out_of_box;      ///< the same for held-out states out of the box, which have no error bar
  };
  using AllStates = std::array<QuantityStates, neural::all_quantities.size()>;  ///< ordered as neural::all_quantities
  AllStates given;  ///< states of held-out designs and of designs on which the network was trained
  int folds = 0;
  int held_out_designs = 0;
  AllStates searched;  ///< states of designs that searches have found, all of them held out
  int searched_folds = 0;
  int searched_designs = 0;
};

/// Evaluates the network at the simulated states. Held-out designs are distributed at random over at most `max_folds`
/// folds. They are `references.drawn` if there are any, and otherwise the test and validation designs of the model's
/// split. Throws "training.no_samples" and "dataset.different_recipe".
CalibrationStates calibration_states(const neural::Model& model, const ModelData& data, const ReferenceData& references,
                                     int max_folds, const CancellationToken& cancellation);

}  // namespace supple::training
