#include "extrapolation.h"

#include <cmath>

#include "homogenization.h"
#include "supple/microscale/accurate_simulation.h"

namespace supple::microscale {
namespace {

/// Ratio of the fine mesh's error to the change from the coarse mesh to the fine one: 1 / (2^p - 1), if halving all
/// sides divides the error by 2^p. See docs/bench/simulations.md.
constexpr double remaining_error_ratio = 0.55;
/// Bound of the extrapolated response's error, divided by the difference between the two meshes. The errors of more
/// than nine of ten paths of random designs are below it.
constexpr double extrapolation_error_factor = 0.22;
/// The same for the error of the coarse mesh.
constexpr double coarse_error_factor = 1.9;

/// Frobenius norm of a symmetric tensor (xx, yy, xy).
double frobenius(const Eigen::Vector3d& t) { return std::sqrt(t[0] * t[0] + t[1] * t[1] + 2 * t[2] * t[2]); }

MeshError scaled(const MeshError& error, double factor) {
  return {factor * error.stress, factor * error.energy_density};
}

/// Differences of the stress and the energy density between two meshes. `area` is the rest area of the patch.
MeshError difference(const PatchResponse& a, const PatchResponse& b, double area) {
  const auto stress = [&](const PatchResponse& response) {
    return second_piola_kirchhoff(response.deformation_gradient, response.strain_gradient, area);
  };
  return {frobenius(stress(a) - stress(b)), std::abs(a.energy - b.energy) / area};
}

}  // namespace

PatchResponse extrapolate(const PatchResponse& coarse, const PatchResponse& fine) {
  const auto beyond = [](const auto& from, const auto& to) {
    return (to + remaining_error_ratio * (to - from)).eval();
  };
  return {beyond(coarse.deformation_gradient, fine.deformation_gradient),
          beyond(coarse.strain_gradient, fine.strain_gradient), beyond(coarse.condensed, fine.condensed),
          fine.energy + remaining_error_ratio * (fine.energy - coarse.energy)};
}

MeshError extrapolation_error(const PatchResponse& coarse, const PatchResponse& fine, double area) {
  return scaled(difference(coarse, fine, area), extrapolation_error_factor);
}

MeshError coarse_error(const PatchResponse& coarse, const PatchResponse& fine, double area) {
  return scaled(difference(coarse, fine, area), coarse_error_factor);
}

// The extrapolated response differs from the coarse one by (1 + remaining_error_ratio) times what the fine one does.
double extrapolation_error_ratio() { return extrapolation_error_factor / (1 + remaining_error_ratio); }

std::optional<MeshError> discretization_error(const std::vector<State>& states) {
  double stress_error = 0;
  double stress = 0;
  double energy_error = 0;
  double energy = 0;
  for (const State& state : states) {
    // A state that did not converge is no answer. It is the last one of its path.
    if (state.stopped != Stop::converged) continue;
    if (!state.mesh_error) return std::nullopt;
    stress_error += std::pow(state.mesh_error->stress, 2);
    stress += std::pow(frobenius(state.stress), 2);
    energy_error += std::pow(state.mesh_error->energy_density, 2);
    energy += std::pow(state.energy_density, 2);
  }
  const auto ratio = [](double error, double size) { return size > 0 ? std::sqrt(error / size) : 0; };
  return MeshError{ratio(stress_error, stress), ratio(energy_error, energy)};
}

}  // namespace supple::microscale
