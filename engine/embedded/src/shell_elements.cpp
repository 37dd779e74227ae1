#include "shell_elements.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "supple/base/error.h"
#include "supple/numerics/element_loop.h"

namespace supple::embedded {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Elements that one task of the parallel loop evaluates.
constexpr std::size_t faces_per_task = 64;
constexpr std::size_t hinges_per_task = 32;

/// Energy of one element and its derivatives by the three coordinates of each of its nodes.
template <int nodes>
struct NodesElement {
  static constexpr int size = 3 * nodes;
  double value;
  std::array<double, size> gradient;
  std::array<double, numerics::HessianEntries::entries_of(size)> lower;

  void write(const Eigen::Matrix<double, size, 1>& slope, const Eigen::Matrix<double, size, size>& curvature,
             int order) {
    for (int k = 0; k < size; ++k) gradient[static_cast<std::size_t>(k)] = slope[k];
    if (order < 2) return;
    auto* entry = lower.data();
    for (int k = 0; k < size; ++k)
      for (int l = 0; l <= k; ++l) *entry++ = curvature(k, l);
  }
};

template <std::size_t nodes>
std::array<std::int32_t, 3 * nodes> rows_of(const NetworkState& state, const std::array<std::int32_t, nodes>& numbers) {
  std::array<std::int32_t, 3 * nodes> rows{};
  for (std::size_t k = 0; k < nodes; ++k)
    for (std::size_t l = 0; l < 3; ++l) rows[3 * k + l] = state.node_row(numbers[k]) + static_cast<std::int32_t>(l);
  return rows;
}

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

/// Replaces the matrix by the nearest positive semidefinite one: negative eigenvalues become zero. False if it was
/// semidefinite already.
template <class Matrix>
bool project_to_semidefinite(Matrix& curvature) {
  // A Cholesky factorization that succeeds shows the same, and is far cheaper than the eigenvalues.
  if (Eigen::LLT<Matrix>(curvature).info() == Eigen::Success) return false;
  const Eigen::SelfAdjointEigenSolver<Matrix> modes(curvature);
  if (modes.eigenvalues()[0] >= 0) return false;
  curvature = modes.eigenvectors() * modes.eigenvalues().cwiseMax(0).asDiagonal() * modes.eigenvectors().transpose();
  return true;
}

/// Replaces the Hessian of a face's energy by its corners by the nearest positive semidefinite matrix. `sides` are in
/// cyclic order; `first` and `second` are the derivatives by their squared lengths.
///
/// Translations of the whole face do not change its energy, and motions along its normal change no length to first
/// order. In an orthonormal basis of the relative motions the matrix is therefore block diagonal: 2 x 2 for motions
/// along the normal, 4 x 4 for those in the plane.
void project_face_hessian(const std::array<Vector3d, 3>& sides, const Vector3d& first, const Matrix3d& second,
                          Eigen::Matrix<double, 9, 9>& curvature) {
  // The columns are two relative motions of the corners, orthonormal and orthogonal to the translation of all.
  Eigen::Matrix<double, 3, 2> relative_motions;
  relative_motions << 1 / std::numbers::sqrt2, 1 / std::sqrt(6.0), -1 / std::numbers::sqrt2, 1 / std::sqrt(6.0), 0,
      -2 / std::sqrt(6.0);
  Eigen::Matrix<double, 3, 2> plane;
  plane.col(0) = sides[0].normalized();
  const Vector3d normal = sides[0].cross(sides[1]).normalized();
  plane.col(1) = normal.cross(Vector3d(plane.col(0)));
  Eigen::Matrix<double, 4, 3> slopes;
  Eigen::Matrix2d out_of_plane = Eigen::Matrix2d::Zero();
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector2d relative_motion = (relative_motions.row((k + 1) % 3) - relative_motions.row(k)).transpose();
    const Eigen::Vector2d side = plane.transpose() * sides[static_cast<std::size_t>(k)];
    slopes.col(k) << 2 * relative_motion[0] * side, 2 * relative_motion[1] * side;
    out_of_plane += 2 * first[k] * relative_motion * relative_motion.transpose();
  }
  Eigen::Matrix4d in_plane = slopes * second * slopes.transpose();
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b) in_plane.block<2, 2>(2 * a, 2 * b).diagonal().array() += out_of_plane(a, b);
  const bool in_plane_changed = project_to_semidefinite(in_plane);
  const bool out_of_plane_changed = project_to_semidefinite(out_of_plane);
  if (!in_plane_changed && !out_of_plane_changed) return;
  curvature.setZero();
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b) {
      const Matrix3d both = plane * in_plane.block<2, 2>(2 * a, 2 * b) * plane.transpose() +
                            out_of_plane(a, b) * normal * normal.transpose();
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          curvature.block<3, 3>(3 * i, 3 * j) += relative_motions(i, a) * relative_motions(j, b) * both;
    }
}

/// The material whose three-dimensional Lame constants are the shell's of plane stress: mu = Y / (2 (1 + nu)) is
/// unchanged, and lambda becomes Y nu / (1 - nu^2), with Young's modulus Y.
MembraneMaterial plane_stress_material(const ShellHost& shell) {
  const double nu = shell.poisson_ratio;
  return {shell.youngs_modulus * (1 + 2 * nu) / ((1 + nu) * (1 + nu)), nu / (1 + nu), shell.thickness};
}

/// Adds what one face contributes to the derivatives of a hinge's angle: its normal rotates about the edge as its
/// corners move. `at` is the row of the corner opposite to the edge.
void add_normal_rotation(HingeAngle& into, const Vector3d& tail, const Vector3d& head, const Vector3d& corner,
                         Eigen::Index at, double sign, int order) {
  const Vector3d edge = head - tail;
  const Vector3d arm = corner - tail;
  const Vector3d normal = edge.cross(arm);
  const double squared = normal.squaredNorm();
  const double length = edge.norm();
  const Vector3d corner_gradient = normal * (length / squared);
  const double foot = arm.dot(edge) / (length * length);
  into.gradient.segment<3>(at) -= sign * corner_gradient;
  into.gradient.segment<3>(0) += sign * (1 - foot) * corner_gradient;
  into.gradient.segment<3>(3) += sign * foot * corner_gradient;
  if (order < 2) return;
  const Matrix3d by_normal = length / squared * (Matrix3d::Identity() - 2 / squared * normal * normal.transpose());
  const Matrix3d by_head = -by_normal * cross_matrix(arm) + normal * edge.transpose() / (length * squared);
  const Matrix3d by_corner = by_normal * cross_matrix(edge);
  const Matrix3d by_tail = -by_head - by_corner;
  const Vector3d foot_by_corner = edge / (length * length);
  const Vector3d foot_by_head = (arm - 2 * foot * edge) / (length * length);
  const Vector3d foot_by_tail = -foot_by_corner - foot_by_head;
  const auto add = [&](Eigen::Index variable, const Matrix3d& corner_gradient_by, const Vector3d& foot_by) {
    into.hessian.block<3, 3>(at, variable) -= sign * corner_gradient_by;
    into.hessian.block<3, 3>(0, variable) +=
        sign * ((1 - foot) * corner_gradient_by - corner_gradient * foot_by.transpose());
    into.hessian.block<3, 3>(3, variable) += sign * (foot * corner_gradient_by + corner_gradient * foot_by.transpose());
  };
  add(0, by_tail, foot_by_tail);
  add(3, by_head, foot_by_head);
  add(at, by_corner, foot_by_corner);
}

std::array<Vector3d, 4> corners_at(const NetworkState& state, const std::array<std::int32_t, 4>& nodes) {
  return {state.node(nodes[0]), state.node(nodes[1]), state.node(nodes[2]), state.node(nodes[3])};
}

double volume_of(const std::vector<surface::Triangle>& faces, const auto& position) {
  double volume = 0;
  // Positions relative to a corner of the surface avoid cancellation far from the origin.
  const Vector3d& origin = position(faces.front()[0]);
  for (const auto& [a, b, c] : faces)
    volume += (position(a) - origin).dot((position(b) - origin).cross(position(c) - origin));
  return volume / 6;
}

}  // namespace

HingeAngle hinge_angle(const std::array<Vector3d, 4>& corners, int order) {
  const auto& [tail, head, left, right] = corners;
  const Vector3d edge = head - tail;
  const Vector3d left_normal = edge.cross(left - tail);
  const Vector3d right_normal = (right - tail).cross(edge);
  HingeAngle result;
  result.angle = std::atan2(edge.normalized().dot(left_normal.cross(right_normal)), left_normal.dot(right_normal));
  if (order < 1) return result;
  add_normal_rotation(result, tail, head, left, 6, 1, order);
  add_normal_rotation(result, tail, head, right, 9, -1, order);
  return result;
}

ShellMembrane::ShellMembrane(const surface::TriangleMesh& rest, const ShellHost& shell) {
  const MembraneMaterial material = plane_stress_material(shell);
  faces_.reserve(rest.faces().size());
  for (const auto& [a, b, c] : rest.faces()) {
    const auto side = [&](std::int32_t i, std::int32_t j) {
      return (rest.positions()[i] - rest.positions()[j]).norm();
    };
    faces_.push_back({{a, b, c}, TriangleEnergy({side(a, b), side(b, c), side(c, a)}, material)});
  }
}

void ShellMembrane::add(const NetworkState& state, int order, numerics::EnergySum& sum) const {
  using Element = NodesElement<3>;
  const auto evaluate = [&](std::size_t i, Element& element) {
    const Face& face = faces_[i];
    std::array<Vector3d, 3> sides;
    Vector3d lengths;
    for (std::size_t k = 0; k < 3; ++k) {
      sides[k] = state.node(face.nodes[(k + 1) % 3]) - state.node(face.nodes[k]);
      lengths[static_cast<Eigen::Index>(k)] = sides[k].norm();
    }
    const TriangleEnergy::Value energy = face.energy.by_squares(lengths);
    element.value = energy.energy;
    if (order < 1 || !std::isfinite(energy.energy)) return;
    // The squared length s = |e|^2 has the gradient 2 e and the Hessian 2 I with respect to e.
    Eigen::Matrix<double, 9, 3> slopes = Eigen::Matrix<double, 9, 3>::Zero();
    Eigen::Matrix<double, 9, 9> curvature = Eigen::Matrix<double, 9, 9>::Zero();
    for (int k = 0; k < 3; ++k) {
      const int from = 3 * k;
      const int to = 3 * ((k + 1) % 3);
      slopes.block<3, 1>(from, k) = -2 * sides[static_cast<std::size_t>(k)];
      slopes.block<3, 1>(to, k) = 2 * sides[static_cast<std::size_t>(k)];
      for (int l = 0; l < 3 && order >= 2; ++l) {
        curvature(from + l, from + l) += 2 * energy.first[k];
        curvature(to + l, to + l) += 2 * energy.first[k];
        curvature(from + l, to + l) -= 2 * energy.first[k];
        curvature(to + l, from + l) -= 2 * energy.first[k];
      }
    }
    if (order >= 2) curvature += slopes * energy.second * slopes.transpose();
    if (order >= 2 && sum.convex) project_face_hessian(sides, energy.first, energy.second, curvature);
    element.write(slopes * energy.first, curvature, order);
  };
  numerics::add_elements<Element>(faces_.size(), faces_per_task, evaluate, [&](std::size_t i, const Element& element) {
    if (!std::isfinite(element.value)) {
      sum.value = element.value;
      return false;
    }
    sum.add_element(rows_of(state, faces_[i].nodes), order, element.value, element.gradient.data(),
                    element.lower.data());
    return true;
  });
}

void ShellMembrane::bill(CostLedger& cost, double seconds) const {
  cost.add_stage("assembly", seconds);
  cost.add_effect(name(), true, "the faces of the shell stretch", 1, seconds);
}

ShellHinges::ShellHinges(const surface::TriangleMesh& rest, const ShellHost& shell) {
  const double nu = shell.poisson_ratio;
  const double stiffness =
      shell.youngs_modulus * shell.thickness * shell.thickness * shell.thickness / (12 * (1 - nu * nu));
  const auto& positions = rest.positions();
  for (std::int32_t h = 0; h < rest.halfedge_count(); ++h) {
    const std::int32_t twin = rest.twin(h);
    if (twin < h) continue;  // a boundary edge, or one visited already as `twin`
    const auto opposite = [&](std::int32_t halfedge) { return rest.tail(surface::TriangleMesh::previous(halfedge)); };
    const std::array<std::int32_t, 4> nodes{rest.tail(h), rest.head(h), opposite(h), opposite(twin)};
    const std::array<Vector3d, 4> corners{positions[nodes[0]], positions[nodes[1]], positions[nodes[2]],
                                          positions[nodes[3]]};
    const Vector3d edge = corners[1] - corners[0];
    const double area = (edge.cross(corners[2] - corners[0]).norm() + edge.cross(corners[3] - corners[0]).norm()) / 2;
    hinges_.push_back({nodes, stiffness / 2 * edge.squaredNorm() / area, hinge_angle(corners, 0).angle});
  }
}

void ShellHinges::add(const NetworkState& state, int order, numerics::EnergySum& sum) const {
  using Element = NodesElement<4>;
  const auto evaluate = [&](std::size_t i, Element& element) {
    const Hinge& hinge = hinges_[i];
    // The convex Hessian needs only first derivatives of the angle, as in Gauss-Newton.
    const HingeAngle at = hinge_angle(corners_at(state, hinge.nodes), sum.convex ? std::min(order, 1) : order);
    // Angles are equal modulo 2 pi: the change is the smallest in magnitude.
    const double change = std::remainder(at.angle - hinge.rest_angle, 2 * std::numbers::pi);
    element.value = hinge.weight * change * change;
    if (order < 1) return;
    const double slope = 2 * hinge.weight * change;
    Eigen::Matrix<double, 12, 12> curvature;
    if (order >= 2) curvature = 2 * hinge.weight * at.gradient * at.gradient.transpose();
    if (order >= 2 && !sum.convex) curvature += slope * at.hessian;
    element.write(slope * at.gradient, curvature, order);
  };
  numerics::add_elements<Element>(hinges_.size(), hinges_per_task, evaluate,
                                  [&](std::size_t i, const Element& element) {
                                    if (!std::isfinite(element.value)) {
                                      sum.value = std::numeric_limits<double>::infinity();
                                      return false;
                                    }
                                    sum.add_element(rows_of(state, hinges_[i].nodes), order, element.value,
                                                    element.gradient.data(), element.lower.data());
                                    return true;
                                  });
}

void ShellHinges::bill(CostLedger& cost, double seconds) const {
  cost.add_stage("assembly", seconds);
  cost.add_effect(name(), true, "the edges of the shell bend", 1, seconds);
}

ShellVolume::ShellVolume(const surface::TriangleMesh& rest, const ShellHost& shell)
    : faces_(rest.faces()), weight_(shell.volume_weight), scale_(shell.volume_scale) {
  std::size_t open = 0;
  for (std::int32_t h = 0; h < rest.halfedge_count(); ++h) open += rest.twin(h) < 0 ? 1 : 0;
  if (open > 0)
    throw Error("host.open_surface", "A volume can be kept only by a closed surface.",
                {{"host/volume_weight", "needs a surface without boundary; this one has " + std::to_string(open) +
                                            " boundary edge" + (open == 1 ? "" : "s")}});
  rest_volume_ = volume_of(faces_, [&](std::int32_t i) -> const Vector3d& { return rest.positions()[i]; });
}

void ShellVolume::add(const NetworkState& state, int order, numerics::EnergySum& sum) const {
  const auto position = [&](std::int32_t node) { return state.node(node); };
  const double ratio = volume_of(faces_, position) / rest_volume_;
  const double excess = ratio - scale_;
  const double positive_volume = std::abs(rest_volume_);  // at rest, also where the faces are oriented inwards
  sum.value += weight_ / 2 * excess * excess * positive_volume;
  if (order < 1) return;
  Eigen::VectorXd ratio_gradient = Eigen::VectorXd::Zero(state.dimension());
  const Vector3d origin = position(faces_.front()[0]);
  const double pressure = weight_ * excess * positive_volume / (6 * rest_volume_);
  for (const surface::Triangle& face : faces_) {
    std::array<Vector3d, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = position(face[k]) - origin;
    for (std::size_t k = 0; k < 3; ++k)
      ratio_gradient.segment<3>(state.node_row(face[k])) +=
          corners[(k + 1) % 3].cross(corners[(k + 2) % 3]) / (6 * rest_volume_);
    if (order < 2) continue;
    // d^2 (a . b x c) / da db = -[c]x, and cyclically for the other pairs of corners.
    Eigen::Matrix<double, 9, 9> curvature = Eigen::Matrix<double, 9, 9>::Zero();
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      // This indefinite term is dropped from the convex Hessian; its zeros keep the sparsity pattern.
      const Matrix3d block =
          (sum.convex ? 0 : -pressure) * cross_matrix(corners[static_cast<std::size_t>((k + 2) % 3)]);
      curvature.block<3, 3>(3 * k, 3 * next) += block;
      curvature.block<3, 3>(3 * next, 3 * k) += block.transpose();
    }
    NodesElement<3> element;
    element.write(Eigen::Matrix<double, 9, 1>::Zero(), curvature, order);
    sum.hessian.add_block(rows_of(state, std::array<std::int32_t, 3>{face[0], face[1], face[2]}), element.lower.data());
  }
  sum.gradient += weight_ * excess * positive_volume * ratio_gradient;
  if (order >= 2) sum.rank_one.emplace_back(std::sqrt(weight_ * positive_volume) * ratio_gradient);
}

void ShellVolume::bill(CostLedger& cost, double seconds) const {
  cost.add_stage("assembly", seconds);
  cost.add_effect(name(), true, "the enclosed volume has a weight", 1, seconds);
}

}  // namespace supple::embedded
