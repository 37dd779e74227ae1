#pragma once

#include <Eigen/LU>
#include <cmath>

#include "supple/base/random.h"
#include "supple/training/samples.h"

namespace supple::training {

/// Energy, stress and tangent of a compressible neo-Hookean sheet at e = (E_xx, E_yy, 2 E_xy), with which networks are
/// compared: psi = mu/2 (tr C - 2 - ln det C) + lambda/8 (ln det C)^2 with C = 2 E + I.
struct LawState {
  double energy = 0;
  Eigen::Vector3d stress;
  Eigen::Matrix3d tangent;
};

inline LawState law_at(double mu, double lambda, const Eigen::Vector3d& e) {
  Eigen::Matrix2d c;
  c << 1 + 2 * e[0], e[2], e[2], 1 + 2 * e[1];
  const double log_det = std::log(c.determinant());
  const Eigen::Matrix2d inverse = c.inverse();
  LawState state;
  state.energy = 0.5 * mu * (c.trace() - 2 - log_det) + 0.125 * lambda * log_det * log_det;
  // S = mu (I - C^-1) + lambda/2 ln det C C^-1.
  const Eigen::Matrix2d s = mu * (Eigen::Matrix2d::Identity() - inverse) + 0.5 * lambda * log_det * inverse;
  state.stress << s(0, 0), s(1, 1), s(0, 1);
  // dS : dE = lambda (C^-1 : dE) C^-1 + (2 mu - lambda ln det C) C^-1 dE C^-1.
  for (int k = 0; k < 3; ++k) {
    Eigen::Matrix2d d = Eigen::Matrix2d::Zero();
    if (k < 2)
      d(k, k) = 1;
    else
      d(0, 1) = d(1, 0) = 0.5;
    const Eigen::Matrix2d change =
        lambda * inverse.cwiseProduct(d).sum() * inverse + (2 * mu - lambda * log_det) * inverse * d * inverse;
    state.tangent.col(k) << change(0, 0), change(1, 1), change(0, 1);
  }
  return state;
}

/// The law's state for the one parameter p of `law_samples`.
inline LawState law_of_design(double p, const Eigen::Vector3d& e) { return law_at(1 + 4 * p, 2 + 3 * p, e); }

/// Samples at random strains of designs with one parameter p in [0, 1]: mu = 1 + 4 p, lambda = 2 + 3 p.
inline Samples law_samples(int designs, int rows, std::uint64_t seed) {
  RandomStream stream("law samples", seed);
  Samples samples;
  samples.lower = {0};
  samples.upper = {1};
  const long n = static_cast<long>(designs) * rows;
  samples.strain.resize(3, n);
  samples.stress.resize(3, n);
  samples.energy.resize(n);
  samples.tangent.resize(6, n);
  long next = 0;
  for (int d = 0; d < designs; ++d) {
    const double p = stream.uniform();
    samples.designs.push_back({d, {p}, static_cast<int>(next), rows, false});
    for (int i = 0; i < rows; ++i, ++next) {
      const Eigen::Vector3d e(stream.uniform(-0.15, 0.3), stream.uniform(-0.15, 0.3), stream.uniform(-0.2, 0.2));
      const auto state = law_of_design(p, e);
      samples.strain.col(next) = e;
      samples.stress.col(next) = state.stress;
      samples.energy[next] = state.energy;
      const auto& t = state.tangent;
      samples.tangent.col(next) << t(0, 0), t(0, 1), t(0, 2), t(1, 1), t(1, 2), t(2, 2);
    }
  }
  return samples;
}

}  // namespace supple::training
