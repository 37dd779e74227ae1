#include "extrapolation.h"

#include <cmath>

#include "homogenization.h"
#include "supple/microscale/accurate_simulation.h"

namespace supple::microscale {
namespace {

/// The part of the coarse mesh's change that the fine mesh still errs by: 1 / (2^p - 1), where halving all sides
/// divides the error by 2^p. See docs/bench/simulations-discretization.md.
constexpr double remaining_share = 0.55;
/// The extrapolation errs by less than this share of the two meshes' difference, and the coarse mesh by less than this
/// multiple of it, in more than nine of ten paths of random designs.
constexpr double extrapolation_share = 0.22;
constexpr double coarse_share = 1.9;

double frobenius(const Eigen::Vector3d& t) { return std::sqrt(t[0] * t[0] + t[1] * t[1] + 2 * t[2] * t[2]); }

MeshError scaled(const MeshError& error, double factor) {
  return {factor * error.stress, factor * error.energy_density};
}

/// By how much stress and energy density of two meshes differ; `area` is the rest area of the patch.
MeshError difference(const PatchResponse& a, const PatchResponse& b, double area) {
  const auto stress = [&](const PatchResponse& response) {
    return second_piola_kirchhoff(response.deformation_gradient, response.strain_gradient, area);
  };
  return {frobenius(stress(a) - stress(b)), std::abs(a.energy - b.energy) / area};
}

}  // namespace

PatchResponse extrapolate(const PatchResponse& coarse, const PatchResponse& fine) {
  const auto beyond = [](const auto& from, const auto& to) { return (to + remaining_share * (to - from)).eval(); };
  return {beyond(coarse.deformation_gradient, fine.deformation_gradient),
          beyond(coarse.strain_gradient, fine.strain_gradient), beyond(coarse.condensed, fine.condensed),
          fine.energy + remaining_share * (fine.energy - coarse.energy)};
}

MeshError extrapolation_error(const PatchResponse& coarse, const PatchResponse& fine, double area) {
  return scaled(difference(coarse, fine, area), extrapolation_share);
}

MeshError coarse_error(const PatchResponse& coarse, const PatchResponse& fine, double area) {
  return scaled(difference(coarse, fine, area), coarse_share);
}

// Of the meshes' difference d, the extrapolated response differs from the coarse one by (1 + remaining_share) d.
double extrapolation_error_share() { return extrapolation_share / (1 + remaining_share); }

std::optional<MeshError> discretization_error(const std::vector<State>& states) {
  double stress_error = 0;
  double stress = 0;
  double energy_error = 0;
  double energy = 0;
  for (const State& state : states) {
    // The path ended there, and the state is no answer.
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
