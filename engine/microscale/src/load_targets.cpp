#include "load_targets.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <string>

#include "supple/base/faults.h"
#include "supple/base/number_text.h"
#include "supple/microscale/simulation_error.h"

namespace supple::microscale {
namespace {

/// Limits of the principal stretches of a load. They lie far beyond the elastic range of the solids that are simulated.
constexpr double min_stretch = 0.2;
constexpr double max_stretch = 4;
constexpr int max_states = 100'000;

std::string range() { return "must be within [" + number_text(min_stretch) + ", " + number_text(max_stretch) + "]"; }

bool in_range(double stretch) { return stretch >= min_stretch && stretch <= max_stretch; }

void check_count(std::size_t count, const std::string& where, Faults& faults) {
  if (count == 0) faults.add(where, "a load has at least one state");
  if (count > max_states)
    faults.add(where, "a load has at most " + std::to_string(max_states) + " states, got " + std::to_string(count));
}

/// The direction of a load and the unit vector orthogonal to it.
struct Frame {
  Eigen::Vector2d d;
  Eigen::Vector2d n;
};

Frame frame_of(double direction, const std::string& where, Faults& faults) {
  if (!std::isfinite(direction)) faults.add(where, "must be finite");
  return {{std::cos(direction), std::sin(direction)}, {-std::sin(direction), std::cos(direction)}};
}

/// The components of a b^T, row by row.
Eigen::Vector4d dyad(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return {a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]};
}

LoadTargets targets(const GreenStrainLoad& load, Faults& faults) {
  LoadTargets result;
  check_count(load.strains.size(), "green_strain", faults);
  for (std::size_t i = 0; i < load.strains.size(); ++i) {
    const Eigen::Vector3d& e = load.strains[i];
    const std::string where = "green_strain/" + std::to_string(i);
    if (!e.allFinite()) {
      faults.add(where, "must be finite");
      continue;
    }
    const Eigen::Matrix2d c = (Eigen::Matrix2d() << 1 + 2 * e[0], 2 * e[2], 2 * e[2], 1 + 2 * e[1]).finished();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(c);
    const Eigen::Vector2d stretches = eigen.eigenvalues().cwiseMax(0).cwiseSqrt();
    for (const double stretch : stretches)
      if (!in_range(stretch)) faults.add(where, "its principal stretch " + number_text(stretch) + " " + range());
    result.gradients.emplace_back(eigen.eigenvectors() * stretches.asDiagonal() * eigen.eigenvectors().transpose());
  }
  return result;
}

LoadTargets targets(const UniaxialLoad& load, Faults& faults) {
  LoadTargets result;
  const Frame frame = frame_of(load.direction, "uniaxial/direction", faults);
  check_count(load.stretches.size(), "uniaxial/stretches", faults);
  for (std::size_t i = 0; i < load.stretches.size(); ++i) {
    const double s = load.stretches[i];
    if (!in_range(s)) faults.add("uniaxial/stretches/" + std::to_string(i), range() + ", got " + std::to_string(s));
    result.gradients.emplace_back(s * frame.d * frame.d.transpose() + frame.n * frame.n.transpose());
  }
  // F^T d = s d leaves the row n^T F free; F d = s d leaves the column F n free.
  const bool in_space = load.frame == LoadFrame::space;
  result.free = {in_space ? dyad(frame.n, frame.d) : dyad(frame.d, frame.n), dyad(frame.n, frame.n)};
  return result;
}

LoadTargets targets(const BiaxialLoad& load, Faults& faults) {
  LoadTargets result;
  const Frame frame = frame_of(load.direction, "biaxial/direction", faults);
  check_count(load.stretches.size(), "biaxial/stretches", faults);
  for (std::size_t i = 0; i < load.stretches.size(); ++i) {
    const Eigen::Vector2d& s = load.stretches[i];
    for (int k = 0; k < 2; ++k)
      if (!in_range(s[k]))
        faults.add("biaxial/stretches/" + std::to_string(i) + "/" + std::to_string(k),
                   range() + ", got " + number_text(s[k]));
    result.gradients.emplace_back(s[0] * frame.d * frame.d.transpose() + s[1] * frame.n * frame.n.transpose());
  }
  return result;
}

}  // namespace

int size(const Load& load) {
  if (const auto* strain = std::get_if<GreenStrainLoad>(&load)) return static_cast<int>(strain->strains.size());
  if (const auto* uniaxial = std::get_if<UniaxialLoad>(&load)) return static_cast<int>(uniaxial->stretches.size());
  return static_cast<int>(std::get<BiaxialLoad>(load).stretches.size());
}

LoadTargets targets_of(const Load& load) {
  Faults faults;
  LoadTargets result = std::visit([&faults](const auto& kind) { return targets(kind, faults); }, load);
  faults.throw_if_any<InvalidLoad>("simulation.invalid_load");
  return result;
}

}  // namespace supple::microscale
