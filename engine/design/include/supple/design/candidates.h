#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "supple/base/execution.h"
#include "supple/design/profile.h"
#include "supple/neural/model.h"

namespace supple::design {

/// Whether parameters give a structure that can be built. The bounds are a box, and some of its corners hold no
/// structure. An empty function means that every point of the box can be built.
using Buildable = std::function<bool(const Eigen::VectorXd& parameters)>;

/// How many candidates are evaluated unless the caller says otherwise: 16 for one free parameter, and 16 more for each
/// further one.
int default_candidates(int free_parameters);

/// The corners of a model's bounds and designs that are spread evenly between them, with their profiles. Searches start
/// from these candidates, and their profiles show what a family can do.
///
/// Profiles are evaluated in single precision, to a hundredth. The profiles at the latest sets of samples are kept, so
/// that an editor that drags a target does not pay for them again. Any thread may call the members.
class Candidates {
 public:
  explicit Candidates(const neural::Network& network);
  ~Candidates();
  Candidates(Candidates&&) noexcept;
  Candidates& operator=(Candidates&&) noexcept;

  struct Table {
    Eigen::MatrixXd parameters;  ///< a column for each candidate
    Eigen::MatrixXd y;           ///< samples x candidates; NaN where there is no equilibrium
  };
  /// The candidates whose parameters lie between `lower` and `upper`, which are equal for parameters that are held. The
  /// table has their values at the samples of all `profiles`, one list after the other, and NaN for candidates that
  /// cannot be built. Every call must pass the same `buildable`. Bills the stage "candidates".
  std::shared_ptr<const Table> table(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, int count,
                                     const std::vector<ProfileSamples>& profiles, const Buildable& buildable,
                                     const Execution& execution) const;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace supple::design
