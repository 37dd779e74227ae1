#pragma once

#include <cstdint>
#include <vector>

#include "sampled_profile.h"
#include "supple/design/target.h"
#include "supple/neural/error_bars.h"

namespace supple::design {

/// The trust in the samples of a profile, with one entry for each sample; see Profile.
struct ProfileTrust {
  std::vector<std::uint8_t> in_range;
  Eigen::VectorXd error_bar;
};

/// The trust in samples `first`, `first + 1`, ... of a design with these parameters. `values` are the values at these
/// samples.
ProfileTrust profile_trust(const neural::Model& model, const neural::ErrorBars& bars,
                           const std::vector<Sample>& samples, const Equilibria<double>& equilibria, std::size_t first,
                           const Eigen::VectorXd& values);

/// The uncertainty of the model about one design.
struct Uncertainty {
  double size = 0;  ///< Design::uncertainty
  /// Whether an error bar exceeds its limit at some sample. Samples outside of the ranges of training have no error
  /// bar. They are often outside for every design, so that other designs would not help.
  bool has_long_bars = false;
};

/// The uncertainty about a design from the trust in each target. `weights` are those of the targets.
Uncertainty uncertainty_of(const std::vector<SampledTarget>& targets, const std::vector<double>& weights,
                           const std::vector<ProfileTrust>& trusts);

}  // namespace supple::design
