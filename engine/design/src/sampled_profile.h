#pragma once

#include <vector>

#include "equilibria.h"
#include "supple/design/profile.h"

namespace supple::design {

/// One sample of a profile as the inner problem needs it.
struct Sample {
  Task task = Task::stress_strain;
  Loading loading;
  double factor = 1;  ///< factor of the stress: the stretch for engineering stress, otherwise 1
};

/// Convert the samples of a profile. `samples_of` throws "model.invalid_load".
std::vector<Sample> samples_of(const ProfileSamples& samples);
std::vector<Loading> loadings_of(const std::vector<Sample>& samples);

/// Derivatives along a uniaxial path by the given strain E_dd: `rates` are those of the free strains (E_nn, 2 E_dn),
/// and `strain_rate` that of the whole strain, along + free * rates.
struct PathRates {
  Eigen::Vector2d rates;
  Eigen::Vector3d strain_rate;
};
PathRates path_rates(const neural::UniaxialFrame& frame, const Eigen::Matrix3d& tangent);

/// The value of a state that is in equilibrium up to its residual. Stresses are corrected by the Newton step that would
/// follow, so that their error is of second order in the residual.
double value_of(const Sample& sample, const neural::UniaxialFrame& frame, const Equilibrium& state);

/// Total derivatives of values by the parameters [Thesis, eq. 4.14], with one row for each sample. If `by_orientation`,
/// the last column has the derivatives by the orientation of the material. The equilibria must have converged and have
/// parameter derivatives. Stiffness and Poisson's ratio take one evaluation with third derivatives.
template <class Real>
class ValueDerivatives {
 public:
  using Evaluator = neural::BasicEvaluator<Real>;
  void evaluate(const Evaluator& evaluator, const typename Evaluator::Design& design,
                const std::vector<Sample>& samples, const Equilibria<Real>& equilibria, Eigen::MatrixXd& derivatives,
                bool by_orientation = false);

 private:
  typename Evaluator::Workspace workspace_;
  neural::Evaluation evaluation_;
};

}  // namespace supple::design
