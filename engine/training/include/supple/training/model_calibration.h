#pragma once

#include <array>
#include <string>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/neural/model.h"
#include "supple/training/samples.h"

namespace supple::training {

/// For one quantity, the share of the judged states that are within bars of each stated share.
struct SharesByLevel {
  std::vector<double> stated;
  std::vector<double> observed;
};

struct CalibrationResult {
  neural::Model model;  ///< with its calibration
  std::array<SharesByLevel, neural::all_quantities.size()> levels;
};

/// States of designs that training has not seen, simulated as whoever verifies a design simulates it: by default
/// without the error of the data's mesh (`supple-lab dataset make --refinement extrapolated`).
struct References {
  std::vector<dataset::Dataset> drawn;     ///< designs that were drawn at random
  std::vector<dataset::Dataset> searched;  ///< designs that searches have found, along the directions of their targets
};

/// Makes error bars for a model from the data on which it was trained. The network is asked for each simulated state as
/// a request would ask: for uniaxial equilibria along the state's direction of the material and its Green strain, each
/// from rest, and for the stress at the simulated strain. Then, for each quantity,
///
/// 1. log(error + floor) is fitted by a quadratic polynomial of the features (neural/error_features.h), least squares
/// with a ridge, over the states of the held-out designs (test and validation, each state with weight 3) and of up to
/// 600 designs on which the network was trained. For the latter an additional offset, linear in the features, says that
/// their errors are smaller; 2. the held-out designs are left out of such a fit in turn, a tenth at a time, and rated
/// by it. In groups of similar ratings of all designs that were left out, the (1 + 1/n) 90 % quantile of log error
/// minus rating is the offset of the bars. Here n is the number of held-out designs. With it, whole designs that are
/// drawn in the same way are within their bars with at least that share (split conformal prediction with groups: Vovk,
/// Gammerman, Shafer 2005; Dunn, Wasserman, Ramdas 2022).
///
/// How well the bars hold (neural::JudgedBars) is measured on each tenth of the held-out designs by bars that are made,
/// as above, only from the other nine tenths and the training designs. States of less than least_judged_energy and
/// states where the network finds no equilibrium are left out. Equal input gives equal bars. Takes about 1 ms for each
/// state.
///
/// If `references` has drawn designs, these are the held-out ones, and the model answers with its correction of the
/// mesh: the bars then say how far such simulations may be from the model. The designs that the network was trained on
/// are compared with it as they trained it. If there are searched designs, they get offsets of their own in the same
/// way, from ratings of a fit that has not seen them.
///
/// Throws what `samples_of` throws, "dataset.different_recipe" if references are of another structure or differ among
/// each other, "training.no_samples" if fewer than 4 designs were held out or if a quantity has
/// fewer than 50 states of them, and "job.cancelled" if a stop is requested.
CalibrationResult calibrate(neural::Model model, const ModelData& data, const CancellationToken& cancellation = {},
                            const References& references = {});

/// A picture of a calibration, as SVG. It shows the share of the answers "within x %" that are true, over x, and the
/// observed shares for stated shares from 50 to 95 %.
std::string calibration_plot(const CalibrationResult& result);

}  // namespace supple::training
