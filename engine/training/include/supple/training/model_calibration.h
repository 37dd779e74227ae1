#pragma once

#include <array>
#include <string>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/neural/model.h"
#include "supple/training/samples.h"

namespace supple::training {

/// Coverage of the error bars of one quantity: the fraction of the held-out states whose error is within its bar.
struct CoverageByLevel {
  std::vector<double> nominal;   ///< fractions for which bars were made
  std::vector<double> observed;  ///< measured coverage of these bars
};

struct CalibrationResult {
  neural::Model model;  ///< with its calibration
  std::array<CoverageByLevel, neural::all_quantities.size()> levels;
};

/// Simulated states of designs on which the network was not trained. They are simulated like the verification of a
/// design, by default without the error of the data's mesh (`supple-lab dataset make --refinement extrapolated`).
struct ReferenceData {
  std::vector<dataset::Dataset> drawn;     ///< designs that were drawn at random
  std::vector<dataset::Dataset> searched;  ///< designs that searches have found, along the directions of their targets
};

/// Makes error bars for a model from the data on which it was trained. For each simulated state the network predicts
/// what a request would ask for: the uniaxial equilibrium along the state's load direction and at its axial Green
/// strain, solved from the undeformed state, and the stress at the simulated strain. Then, for each quantity:
///
/// 1. log(error + floor) is fitted by a quadratic polynomial of the features (neural/error_features.h), by ridge
/// regression. The fit covers the states of the held-out designs (test and validation, each state with weight 3) and of
/// up to 600 designs on which the network was trained. States of the latter have an additional term, linear in the
/// features, because their errors are smaller. The value of the polynomial is the *rating* of a state.
///
/// 2. Each held-out design is rated by a fit without it, in a 10-fold cross-validation. All held-out states are divided
/// into groups of similar ratings. The offset of the bars of a group is the (1 + 1/n) 90 % quantile of log(error +
/// floor) minus rating, where n is the number of held-out designs. With it, states of new designs that are drawn in the
/// same way are within their bars with a probability of at least 90 % (split conformal prediction with groups:
/// [Vovk2005], [Dunn2022]).
///
/// The coverage of the bars (neural::BarCoverage) is measured on each tenth of the held-out designs, with bars that are
/// made, as above, only from the other nine tenths and the training designs. States of less than min_evaluated_energy
/// and states where the network finds no equilibrium are left out. Equal input gives equal bars. Takes about 1 ms for
/// each state.
///
/// If `references` has drawn designs, these are the held-out ones. They are compared with the model including its
/// correction of the mesh, so that the bars say how far such simulations may be from the model. The designs on which
/// the network was trained are compared with the network without that correction. If there are searched designs, they
/// get offsets of their own in the same way, with ratings of a fit that does not include them.
///
/// Throws what `samples_of` throws, and Cancelled if a stop is requested. Throws "dataset.different_recipe" if
/// `references` are of another family or solid than `data`, or differ among each other. Throws "training.no_samples" if
/// fewer than 4 designs were held out, or if a quantity has fewer than 50 states of held-out designs.
CalibrationResult calibrate(neural::Model model, const ModelData& data, const CancellationToken& cancellation = {},
                            const ReferenceData& references = {});

/// A picture of a calibration, as SVG. It shows the coverage of the error bars against their length, and the observed
/// against the nominal coverage, from 50 to 98 %.
std::string calibration_plot(const CalibrationResult& result);

}  // namespace supple::training
