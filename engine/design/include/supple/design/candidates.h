#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "supple/base/execution.h"
#include "supple/design/profile.h"
#include "supple/neural/model.h"

namespace supple::design {

/// Whether parameters give a structure that can be built: bounds are a box, and not all of it does. Empty: all do.
using Buildable = std::function<bool(const Eigen::VectorXd& parameters)>;

/// 16 for one free parameter, 16 more for each further one.
int default_candidates(int free_parameters);

/// The corners of a model's bounds and designs spread evenly between them, and their profiles: where searches start,
/// and what a family can do.
///
/// Profiles are evaluated in single precision, to a hundredth, and those of the latest sets of samples are kept, so
/// that an editor that drags a target does not pay for them again. Any thread may call.
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
  /// Candidates whose parameters lie between `lower` and `upper` (equal for those that are held), with their values at
  /// the samples of all `profiles`, one list after the other; NaN for those that cannot be built. The same `buildable`
  /// in every call. Bills the stage "candidates".
  std::shared_ptr<const Table> table(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, int count,
                                     const std::vector<ProfileSamples>& profiles, const Buildable& buildable,
                                     const Execution& execution) const;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace supple::design
