#pragma once

#include <vector>

#include "equilibria.h"
#include "supple/design/profile.h"

namespace supple::design {

/// A sample as the inner problem sees it.
struct Sample {
  Task task = Task::stress_strain;
  Loading loading;
  double factor = 1;  ///< of the value: the stretch, where stresses are engineering ones
};

/// Throws "model.invalid_load".
std::vector<Sample> samples_of(const ProfileSamples& samples);
std::vector<Loading> loadings_of(const std::vector<Sample>& samples);

/// Direct effects of a uniaxial path: how the free strains follow E_dd (a column vector (E_nn, 2 E_dn) per E_dd), and
/// the strain rate along + free * rates.
struct PathRates {
  Eigen::Vector2d rates;
  Eigen::Vector3d strain_rate;
};
PathRates path_rates(const neural::UniaxialFrame& frame, const Eigen::Matrix3d& tangent);

/// Of a state that is in equilibrium up to its residual. Stresses are corrected by the Newton step that is left, so
/// that their error is the residual's square.
double value_of(const Sample& sample, const neural::UniaxialFrame& frame, const Equilibrium& state);

/// Total derivatives of values by parameters (thesis 4.14), and in a last column by the orientation of the material if
/// that is asked for. A row for each sample; the equilibria's states must be converged and have parameter derivatives.
/// Stiffness and Poisson's ratio take one evaluation with third derivatives.
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
