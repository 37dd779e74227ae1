#include "part_supports.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "contact_outline.h"

namespace supple::microscale {
namespace {

// Lengths below are in units of the mesh size.

/// Nodes that are this near to a plate at rest touch it: the coordinates of parts are rounded to 1e-9 mm.
constexpr double touching_distance = 1e-6;
/// A node that has passed the surface of a plate by this much is held there.
constexpr double max_depth = 1e-9;

/// A motion is prevented if the sum of its squares over the displacements that are held is more than this fraction of
/// the sum for all motions.
constexpr double rigid_motion_tolerance = 1e-10;

std::size_t index(Eigen::Index i) { return static_cast<std::size_t>(i); }

PartSupports::Surface surface_of(int support, const Plate& plate, const Eigen::Vector2d& lower,
                                 const Eigen::Vector2d& upper) {
  PartSupports::Surface surface;
  surface.support = support;
  surface.axis = plate.side == Side::left || plate.side == Side::right ? 0 : 1;
  surface.sign = plate.side == Side::left || plate.side == Side::bottom ? 1 : -1;
  surface.position = (surface.sign > 0 ? lower : upper)[surface.axis] - surface.sign * plate.gap;
  surface.sticks = plate.friction == Friction::stick;
  surface.rate = plate.displacement[surface.axis];
  return surface;
}

}  // namespace

std::vector<bool> Constraints::fixed() const {
  std::vector<bool> fixed(support.size());
  std::transform(support.begin(), support.end(), fixed.begin(), [](int s) { return s != none; });
  return fixed;
}

PartSupports::PartSupports(const tiling::PeriodicMesh& mesh, std::vector<Support> supports)
    : mesh_(mesh),
      supports_(std::move(supports)),
      lower_(mesh.nodes.rowwise().minCoeff()),
      upper_(mesh.nodes.rowwise().maxCoeff()) {
  check_supports(supports_, lower_, upper_);
  at_rest_.support.assign(index(mesh.nodes.size()), Constraints::none);
  at_rest_.offset.assign(index(mesh.nodes.size()), 0.0);
  for (std::size_t k = 0; k < supports_.size(); ++k)
    if (const auto* plate = std::get_if<Plate>(&supports_[k]))
      surfaces_.push_back(surface_of(static_cast<int>(k), *plate, lower_, upper_));
  fix_clamped_nodes();
  const ContactOutline outline(mesh);
  for (int p = 0; p < outline.points(); ++p) {
    const int node = outline.nodes[index(p)];
    if (!at_rest_.fixes(2 * static_cast<Eigen::Index>(node))) candidates_.push_back({node, outline.lengths[index(p)]});
  }
  check_collisions();
  fix_touching_nodes();
  check_rigid_motions();
}

void PartSupports::fix_clamped_nodes() {
  std::vector<Error::Detail> details;
  for (std::size_t k = 0; k < supports_.size(); ++k) {
    const auto* clamp = std::get_if<Clamp>(&supports_[k]);
    if (!clamp) continue;
    const std::string where = "supports/" + std::to_string(k) + "/box";
    int count = 0;
    int other = Constraints::none;
    for (Eigen::Index node = 0; node < mesh_.nodes.cols(); ++node) {
      const Eigen::Vector2d p = mesh_.nodes.col(node);
      if ((p.array() < clamp->lower.array()).any() || (p.array() > clamp->upper.array()).any()) continue;
      ++count;
      if (at_rest_.fixes(2 * node)) other = at_rest_.support[index(2 * node)];
      for (Eigen::Index axis = 0; axis < 2; ++axis) at_rest_.support[index(2 * node + axis)] = static_cast<int>(k);
    }
    if (count < 2)
      details.push_back(
          {where, "holds " + std::to_string(count) + " points of the part's mesh; at least 2 are needed"});
    if (other != Constraints::none)
      details.push_back({where, "holds points that support " + std::to_string(other) + " holds too"});
  }
  if (!details.empty()) throw invalid_supports(details);
}

void PartSupports::fix_touching_nodes() {
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(mesh_.nodes.size());
  for (const Surface& surface : surfaces_)
    for (const Candidate& candidate : candidates_)
      if (gap(surface, candidate.node, rest, 0) <= touching_distance * mesh_.mesh_size &&
          !at_rest_.fixes(2 * static_cast<Eigen::Index>(candidate.node) + surface.axis))
        fix_at(surface, candidate.node, 0, at_rest_);
}

void PartSupports::fix_at(const Surface& surface, int node, double tangential_offset, Constraints& constraints) const {
  const std::size_t normal = index(2 * node + surface.axis);
  const std::size_t tangential = index(2 * node + 1 - surface.axis);
  constraints.support[normal] = surface.support;
  constraints.offset[normal] = surface.position - mesh_.nodes(surface.axis, node);
  if (!surface.sticks || constraints.support[tangential] != Constraints::none) return;
  constraints.support[tangential] = surface.support;
  constraints.offset[tangential] = tangential_offset;
}

void PartSupports::release_from(const Surface& surface, int node, Constraints& constraints) {
  for (const int axis : {0, 1}) {
    const std::size_t dof = index(2 * node + axis);
    if (constraints.support[dof] != surface.support) continue;
    constraints.support[dof] = Constraints::none;
    constraints.offset[dof] = 0;
  }
}

Eigen::Vector2d PartSupports::displacement(int support) const {
  if (support < 0) return Eigen::Vector2d::Zero();
  return std::visit([](const auto& s) { return s.displacement; }, supports_[index(support)]);
}

double PartSupports::largest_motion() const {
  double largest = 0;
  const Eigen::Vector2d extent = upper_ - lower_;
  for (std::size_t k = 0; k < supports_.size(); ++k)
    for (std::size_t l = 0; l < k; ++l) {
      const Eigen::Vector2d motion = displacement(static_cast<int>(k)) - displacement(static_cast<int>(l));
      largest = std::max(largest, (motion.array().abs() / extent.array()).maxCoeff());
    }
  return largest;
}

void PartSupports::impose(const Constraints& constraints, double fraction, Eigen::VectorXd& x) const {
  for (std::size_t dof = 0; dof < constraints.support.size(); ++dof) {
    const int support = constraints.support[dof];
    if (support == Constraints::none) continue;
    x[static_cast<Eigen::Index>(dof)] =
        constraints.offset[dof] + fraction * displacement(support)[static_cast<Eigen::Index>(dof % 2)];
  }
}

Eigen::VectorXd PartSupports::rate(const Constraints& constraints, Eigen::Index size) const {
  Eigen::VectorXd rate = Eigen::VectorXd::Zero(size);
  for (std::size_t dof = 0; dof < constraints.support.size(); ++dof)
    if (constraints.support[dof] >= 0)
      rate[static_cast<Eigen::Index>(dof)] = displacement(constraints.support[dof])[static_cast<Eigen::Index>(dof % 2)];
  return rate;
}

double PartSupports::gap(const Surface& surface, int node, const Eigen::VectorXd& x, double fraction) const {
  const double place = mesh_.nodes(surface.axis, node) + x[2 * static_cast<Eigen::Index>(node) + surface.axis];
  return surface.sign * (place - surface.position - fraction * surface.rate);
}

std::optional<Constraints> PartSupports::corrected(const Constraints& constraints, const Eigen::VectorXd& x,
                                                   const Eigen::VectorXd& gradient, double fraction,
                                                   double force_tolerance, Scope scope) const {
  struct Fault {
    const Surface* surface = nullptr;
    int node = 0;
    double size = 0;  ///< depth in mm or pull in MPa mm
  };
  std::vector<Fault> passed;
  std::vector<Fault> pulled;
  for (const Surface& surface : surfaces_)
    for (const Candidate& candidate : candidates_) {
      const Eigen::Index dof = 2 * static_cast<Eigen::Index>(candidate.node) + surface.axis;
      const int support = constraints.support[index(dof)];
      const double depth = -gap(surface, candidate.node, x, fraction);
      // The plate exerts the gradient of the energy. It pulls if this points away from the part.
      const double pull = -surface.sign * gradient[dof];
      if (support == surface.support && pull > force_tolerance)
        pulled.push_back({&surface, candidate.node, pull});
      else if (support == Constraints::none && depth > max_depth * mesh_.mesh_size)
        passed.push_back({&surface, candidate.node, depth});
    }
  if (passed.empty() && pulled.empty()) return std::nullopt;
  const auto worst = [](const std::vector<Fault>& faults) {
    return *std::ranges::max_element(faults, [](const Fault& a, const Fault& b) { return a.size < b.size; });
  };
  if (scope == Scope::one_plate) {
    const Surface* const surface = worst(pulled.empty() ? passed : pulled).surface;
    const auto is_other = [surface](const Fault& fault) { return fault.surface != surface; };
    std::erase_if(passed, is_other);
    std::erase_if(pulled, is_other);
  } else if (scope == Scope::one_node) {
    if (passed.empty())
      pulled = {worst(pulled)};
    else
      passed = {worst(passed)};
    if (!passed.empty()) pulled.clear();
  }
  Constraints result = constraints;
  for (const Fault& fault : pulled) release_from(*fault.surface, fault.node, result);
  for (const Fault& fault : passed) {
    const int tangential = 1 - fault.surface->axis;
    const double offset = x[2 * static_cast<Eigen::Index>(fault.node) + tangential] -
                          fraction * displacement(fault.surface->support)[tangential];
    fix_at(*fault.surface, fault.node, offset, result);
  }
  return result;
}

bool PartSupports::leaves_rigid_motion(const Constraints& constraints) const {
  return rigid_motion_along(constraints).has_value();
}

std::optional<Eigen::Vector3d> PartSupports::rigid_motion_along(const Constraints& constraints) const {
  const Eigen::Vector2d middle = (lower_ + upper_) / 2;
  const double length = (upper_ - lower_).norm() / 2;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (Eigen::Index dof = 0; dof < mesh_.nodes.size(); ++dof) {
    if (!constraints.fixes(dof)) continue;
    const Eigen::Vector2d arm = (mesh_.nodes.col(dof / 2) - middle) / length;
    // The displacement along this axis for unit motions along x, along y, and around the middle.
    const Eigen::Vector3d motion = dof % 2 == 0 ? Eigen::Vector3d(1, 0, -arm.y()) : Eigen::Vector3d(0, 1, arm.x());
    sum += motion * motion.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(sum);
  if (eigen.eigenvalues()[0] > rigid_motion_tolerance * std::max(sum.trace(), 1.0)) return std::nullopt;
  // Two motions that are left cannot be told apart, and the third component of the answer says that it is no shift.
  if (eigen.eigenvalues()[1] <= rigid_motion_tolerance * std::max(sum.trace(), 1.0)) return Eigen::Vector3d::UnitZ();
  return eigen.eigenvectors().col(0);
}

bool PartSupports::may_fix_along(int axis) const {
  return std::ranges::any_of(supports_, [axis](const Support& support) {
    const auto* plate = std::get_if<Plate>(&support);
    if (!plate) return true;
    const int normal = plate->side == Side::left || plate->side == Side::right ? 0 : 1;
    return normal == axis || plate->friction == Friction::stick;
  });
}

void PartSupports::check_rigid_motions() {
  const auto motion = rigid_motion_along(at_rest_);
  if (!motion) return;
  const int axis = std::abs(motion->x()) > std::abs(motion->y()) ? 0 : 1;
  const bool shift = std::abs((*motion)[axis]) > 1 - 1e-9;
  if (!shift || may_fix_along(axis))
    throw invalid_supports(
        {{"supports", shift ? std::string("leave the part free to move along ") + (axis == 0 ? "x" : "y")
                            : "leave the part free to turn or to move in more than one direction"}});
  // No support acts along the axis, so that any displacement along it may be fixed without a force.
  for (Eigen::Index node = 0; node < mesh_.nodes.cols() && !fixes_translation_; ++node)
    if (at_rest_.fixes(2 * node + 1 - axis)) {
      at_rest_.support[index(2 * node + axis)] = Constraints::translation;
      fixes_translation_ = true;
    }
}

}  // namespace supple::microscale
