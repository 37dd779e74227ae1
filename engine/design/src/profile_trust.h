#pragma once

#include <cstdint>
#include <vector>

#include "sampled_profile.h"
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

}  // namespace supple::design
