#include "contact_barrier.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "contact_geometry.h"
#include "supple/base/error.h"
#include "supple/microscale/simulation_error.h"

namespace supple::microscale {
namespace {

/// Ratio of the range to the beam width. A smaller range hardly changes the stress of structures in contact, and takes
/// more iterations.
constexpr double range_ratio = 0.02;
/// Ratio of the stiffness to Young's modulus. The pressure between slender beams is about a hundredth of the modulus.
constexpr double stiffness_ratio = 0.02;
/// Ratio of a pair's distance to its range below which an equilibrium requires a stiffer barrier.
constexpr double stiffening_ratio = 0.1;

void check(const ContactOptions& options) {
  std::vector<Error::Detail> details;
  if (!(options.stiffness > 0)) details.push_back({"contact/stiffness", "must be positive"});
  if (!(options.range > 0)) details.push_back({"contact/range", "must be positive"});
  if (!(options.rest_fraction > 0 && options.rest_fraction < 1))
    details.push_back({"contact/rest_fraction", "must lie between 0 and 1"});
  if (!details.empty())
    throw SimulationError("simulation.invalid_option", "Options of the contact are out of range.", details);
}

using Vector6 = InsideDistance::Vector6;
using Matrix6 = InsideDistance::Matrix6;

/// The barrier between a pair's point and its segment or one end of it, with derivatives with respect to the point, the
/// tail and the head. Those for an end that is not involved are zero.
struct LocalBarrier {
  double value = 0;
  Vector6 gradient = Vector6::Zero();
  Matrix6 hessian = Matrix6::Zero();
};

/// Sets `local` to the barrier between a point and a segment whose nearest point is inside.
void add_inside(const PlacedSegment& placed, double range, double weight, int order, bool convex, LocalBarrier& local) {
  const InsideDistance at(placed.tail, placed.head);
  const LogBarrier barrier(at.distance, range);
  local.value = weight * barrier.value;
  if (order >= 1) local.gradient = weight * barrier.first * at.gradient();
  if (order >= 2) local.hessian = at.hessian(weight * barrier.first, weight * barrier.second, convex);
}

/// Sets `local` to the barrier between a point and an end of a segment, which is at `end_position` relative to the
/// point. `end` is 1 for the tail and 2 for the head.
void add_end(const Eigen::Vector2d& end_position, int end, double range, double weight, int order, bool convex,
             LocalBarrier& local) {
  const double distance = end_position.norm();
  const LogBarrier barrier(distance, range);
  const Eigen::Vector2d normal = -end_position / distance;
  local.value = weight * barrier.value;
  if (order < 1) return;
  local.gradient.head<2>() = weight * barrier.first * normal;
  local.gradient.segment<2>(2 * end) = -local.gradient.head<2>();
  if (order < 2) return;
  double across = weight * barrier.first / distance;
  double along = weight * barrier.second;
  if (convex) {
    across = std::max(across, 0.0);
    along = std::max(along, 0.0);
  }
  const Eigen::Matrix2d curvature =
      across * Eigen::Matrix2d::Identity() + (along - across) * normal * normal.transpose();
  local.hessian.topLeftCorner<2, 2>() = curvature;
  local.hessian.block<2, 2>(2 * end, 2 * end) = curvature;
  local.hessian.block<2, 2>(2 * end, 0) = -curvature;
  local.hessian.block<2, 2>(0, 2 * end) = -curvature;
}

}  // namespace

ContactOptions contact_options(const tiling::PeriodicMesh& mesh, const Material& material) {
  return {.stiffness = stiffness_ratio * material.youngs_modulus, .range = range_ratio * mesh.beam_width};
}

ContactBarrier::ContactBarrier(const tiling::PeriodicMesh& mesh, const ContactOptions& options)
    : coordinates_{mesh.nodes.cols()}, options_(options), pairs_(mesh, options.range, options.rest_fraction) {
  // A mesh without an outline has no contacts, and no beam width from which a range could be computed.
  if (!mesh.outline.empty()) check(options);
}

template <class Sink>
void ContactBarrier::visit(const Eigen::VectorXd& x, int order, bool convex, Sink&& sink) const {
  const Eigen::Matrix2d gradient = coordinates_.deformation_gradient(x);
  const auto emit = [&](const ContactPair& pair, const PlacedSegment& placed, Nearest nearest, double range,
                        double multiplicity) {
    LocalBarrier local;
    const double weight = multiplicity * options_.stiffness * pair.length;
    if (nearest == Nearest::inside)
      add_inside(placed, range, weight, order, convex, local);
    else if (nearest == Nearest::tail)
      add_end(placed.tail, 1, range, weight, order, convex, local);
    else
      add_end(placed.head, 2, range, weight, order, convex, local);
    sink(pair, local);
  };
  for (const ContactPair& pair : pairs_.pairs()) {
    const PlacedSegment placed(pair, gradient, x);
    const PointSegmentDistance found = point_segment_distance(placed.tail, placed.head);
    if (found.squared_distance >= pair.range * pair.range) continue;
    // The barrier at an end with a joint is added at the joint below, together with what the joint subtracts.
    if ((found.nearest == Nearest::tail && pair.tail_joint) || (found.nearest == Nearest::head && pair.head_joint))
      continue;
    emit(pair, placed, found.nearest, pair.range, 1);
  }
  for (const ContactJoint& joint : pairs_.joints()) {
    const ContactPair& before = pairs_.pairs()[static_cast<std::size_t>(joint.before)];
    const PlacedSegment placed(before, gradient, x);
    if (placed.head.squaredNorm() >= joint.range * joint.range) continue;
    const ContactPair& after = pairs_.pairs()[static_cast<std::size_t>(joint.after)];
    const PlacedSegment placed_after(after, gradient, x);
    // -1 is the joint's own; 1 is added for each pair whose barrier was left to the joint.
    double multiplicity = -1;
    if (before.head_joint && point_segment_distance(placed.tail, placed.head).nearest == Nearest::head)
      multiplicity += 1;
    if (after.tail_joint && point_segment_distance(placed_after.tail, placed_after.head).nearest == Nearest::tail)
      multiplicity += 1;
    if (multiplicity != 0) emit(before, placed, Nearest::head, joint.range, multiplicity);
  }
}

double ContactBarrier::look_ahead(const CellState& from, const CellState& to, CostLedger* cost) {
  const StageTimer timer(cost, "contact search");
  return prepare_step(from.x, to.x - from.x);
}

void ContactBarrier::bill(CostLedger& cost, double seconds) const {
  cost.add_effect("contact", true, "pairs of boundary points came near", 1, seconds);
}

void ContactBarrier::add(const CellState& state, int order, numerics::EnergySum& sum) const {
  const Eigen::VectorXd& x = state.x;
  const Eigen::Index strain = coordinates_.strain();
  visit(x, order, convex_, [&](const ContactPair& pair, const LocalBarrier& local) {
    sum.value += local.value;
    if (order < 1) return;
    // Derivatives of the ends' positions relative to the point with respect to F_ij, in column 2 i + j.
    Eigen::Matrix<double, 6, 4> strained = Eigen::Matrix<double, 6, 4>::Zero();
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        strained(2 + i, 2 * i + j) = pair.rest_tail[j];
        strained(4 + i, 2 * i + j) = pair.rest_head[j];
      }
    Eigen::Index place[6];
    const int nodes[3] = {pair.point, pair.tail, pair.head};
    for (int k = 0; k < 6; ++k) place[k] = coordinates_.displacement(nodes[k / 2]) + k % 2;
    for (int k = 0; k < 6; ++k) sum.gradient[place[k]] += local.gradient[k];
    sum.gradient.segment<4>(strain) += strained.transpose() * local.gradient;
    if (order < 2) return;
    const Eigen::Matrix<double, 6, 4> mixed = local.hessian * strained;
    const Eigen::Matrix4d corner = strained.transpose() * mixed;
    for (int k = 0; k < 6; ++k) {
      for (int l = 0; l <= k; ++l) {
        // A point may be in contact with an image of itself. Then both off-diagonal entries of the pair belong to the
        // same entry of the patch's diagonal.
        const double factor = k != l && place[k] == place[l] ? 2 : 1;
        sum.hessian.add(place[k], place[l], factor * local.hessian(k, l));
      }
      for (int c = 0; c < 4; ++c) sum.hessian.add(place[k], strain + c, mixed(k, c));
    }
    for (int c = 0; c < 4; ++c)
      for (int d = 0; d <= c; ++d) sum.hessian.add(strain + c, strain + d, corner(c, d));
  });
}

void ContactBarrier::add_alternating_hessians(const Eigen::VectorXd& x, AlternatingEntries& entries) const {
  visit(x, 2, false, [&](const ContactPair& pair, const LocalBarrier& local) {
    const int nodes[3] = {pair.point, pair.tail, pair.head};
    for (std::size_t a = 0; a < alternations.size(); ++a) {
      const double sign[3] = {1, alternations[a].sign(pair.tail_shift[0], pair.tail_shift[1]),
                              alternations[a].sign(pair.head_shift[0], pair.head_shift[1])};
      for (int k = 0; k < 6; ++k)
        for (int l = 0; l <= k; ++l) {
          const Eigen::Index row = coordinates_.displacement(nodes[k / 2]) + k % 2;
          const Eigen::Index column = coordinates_.displacement(nodes[l / 2]) + l % 2;
          const double factor = k != l && row == column ? 2 : 1;
          entries[a].add(row, column, factor * sign[k / 2] * sign[l / 2] * local.hessian(k, l));
        }
    }
  });
}

ContactStatus ContactBarrier::status(const Eigen::VectorXd& x) const {
  const Eigen::Matrix2d gradient = coordinates_.deformation_gradient(x);
  ContactStatus status;
  for (const ContactPair& pair : pairs_.pairs()) {
    const PlacedSegment placed(pair, gradient, x);
    const double distance = std::sqrt(point_segment_distance(placed.tail, placed.head).squared_distance);
    if (distance < pair.range) ++status.pairs;
    status.smallest_ratio = std::min(status.smallest_ratio, distance / pair.range);
    status.smallest_gap = std::min(status.smallest_gap, distance);
  }
  return status;
}

void ContactBarrier::set_range(double range) {
  options_.range = range;
  pairs_.set_range(range);
}

double ContactBarrier::suggested_stiffness(const Eigen::VectorXd& x) const {
  return status(x).smallest_ratio < stiffening_ratio ? 2 * options_.stiffness : options_.stiffness;
}

}  // namespace supple::microscale
