#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "supple/base/execution.h"
#include "supple/design/profile.h"
#include "supple/neural/model.h"

namespace supple::design {

/// Whether parameters give a structure that can be built. The bounds are a box, and structures do not exist in all of
/// its corners. An empty function means that every point of the box can be built.
using Buildable = std::function<bool(const Eigen::VectorXd& parameters)>;

/// Default number of candidates: 40 for each free parameter, and 40 if none is free.
int default_candidates(int free_parameters);

/// Designs of one model with their profiles: the corners of its bounds, and points of a Sobol sequence between them.
/// Searches start from these candidates, and their profiles show what a family can do.
///
/// Profiles are evaluated in single precision, with equilibria to a relative tolerance of 0.01. The latest 32 tables
/// are cached, so that an editor that drags a target pays for each set of samples once. Any thread may call the
/// members.
class Candidates {
 public:
  explicit Candidates(const neural::Network& network);
  ~Candidates();
  Candidates(Candidates&&) noexcept;
  Candidates& operator=(Candidates&&) noexcept;

  struct Table {
    Eigen::MatrixXd parameters;  ///< one column for each candidate
    Eigen::MatrixXd y;  ///< one row for each sample, one column for each candidate; NaN where there is no equilibrium
  };
  /// The candidates whose parameters lie between `lower` and `upper`. The two are equal for a fixed parameter. The
  /// table has the candidates' values at the samples of all `profiles`, one list after the other, and NaN for
  /// candidates that cannot be built. Every call must pass the same `buildable`. Bills the stage "candidates".
  std::shared_ptr<const Table> table(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, int count,
                                     const std::vector<ProfileSamples>& profiles, const Buildable& buildable,
                                     const Execution& execution) const;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace supple::design
