#pragma once

#include <array>
#include <string>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/neural/model.h"
#include "supple/training/samples.h"

namespace supple::training {

/// Of one quantity, the share of the judged states that are within bars of each stated share.
struct SharesByLevel {
  std::vector<double> stated;
  std::vector<double> observed;
};

struct CalibrationResult {
  neural::Model model;  ///< with its calibration
  std::array<SharesByLevel, neural::all_quantities.size()> levels;
};

/// Error bars for a model, of the data that it was trained on. The network is asked for each simulated state as a
/// request would ask: for uniaxial equilibria along the material's direction and Green strain of the state, each from
/// rest, and for the stress at the simulated strain. Then, for each quantity,
///
/// 1. log(error + floor) is fitted by a quadratic polynomial of the features (neural/error_features.h), least squares
///    with a ridge, over the states of the held-out designs (test and validation, each state with weight 3) and of up
///    to 600 designs that the network was trained on, of which an offset, linear in the features, says that their
///    errors are smaller;
/// 2. the held-out designs in turn, a tenth at a time, are left out of such a fit and rated by it; of all that are left
///    out, in groups of like ratings, the (1 + 1/n) 90 % quantile of log error minus rating is the offset of the bars.
///    n is the number of held-out designs: with it, whole designs that are drawn alike are within their bars with at
///    least that share (split conformal prediction with groups: Vovk, Gammerman, Shafer 2005; Dunn, Wasserman,
///    Ramdas 2022).
///
/// How much the bars are worth (neural::JudgedBars) is measured on each tenth of the held-out designs by bars that are
/// made, as above, of the other nine tenths and the training designs alone. States of less than least_judged_energy and
/// states where the network finds no equilibrium are left out. Deterministic. About 1 ms for each state.
///
/// Throws as `samples_of`, "training.no_samples" where fewer than 4 designs were held out or a quantity has fewer than
/// 50 states of them, and "job.cancelled" where it is.
CalibrationResult calibrate(neural::Model model, const ModelData& data, const CancellationToken& cancellation = {});

/// A picture of a calibration, as SVG: of the answers that say "within x %", the share that is, over x, and for stated
/// shares from 50 to 95 % the observed ones.
std::string calibration_plot(const CalibrationResult& result);

}  // namespace supple::training
