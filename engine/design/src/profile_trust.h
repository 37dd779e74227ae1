#pragma once

#include <cstdint>
#include <vector>

#include "sampled_profile.h"
#include "supple/design/target.h"
#include "supple/neural/error_bars.h"

namespace supple::design {

/// How far the values of a profile are to be trusted, an entry for each sample; see Profile.
struct ProfileTrust {
  std::vector<std::uint8_t> in_range;
  Eigen::VectorXd error_bar;
};

/// Of samples `first`, `first + 1`, ... of a design with these parameters, whose values are `values`.
ProfileTrust profile_trust(const neural::Model& model, const neural::ErrorBars& bars,
                           const std::vector<Sample>& samples, const Equilibria<double>& equilibria, std::size_t first,
                           const Eigen::VectorXd& values);

/// How much is to be doubted that a structure does what the model says.
struct Doubt {
  double size = 0;  ///< Design::doubt
  /// Whether error bars are too long at a sample. Outside of the ranges of training there are none, and often for any
  /// design: it would be in vain to look for others.
  bool has_long_bars = false;
};

/// The doubt about a design from what is known of each target. `weights` are those of the targets.
Doubt doubt_about(const std::vector<SampledTarget>& targets, const std::vector<double>& weights,
                  const std::vector<ProfileTrust>& trusts);

}  // namespace supple::design
