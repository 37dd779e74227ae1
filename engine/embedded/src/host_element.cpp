#include "host_element.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>

namespace supple::embedded {
namespace {

/// Derivatives of a point's barycentric coordinates by its two tangent coordinates.
Eigen::Matrix<double, 3, 2> barycentrics_by_tangents(const surface::TriangleMesh& mesh, FaceId face) {
  const surface::Triangle& corners = mesh.faces()[index(face)];
  const Eigen::Vector3d& first = mesh.positions()[corners[0]];
  const Eigen::Matrix<double, 3, 2> frame = surface::tangent_frame(mesh, face);
  Eigen::Matrix2d sides;
  for (int k = 0; k < 2; ++k) sides.col(k) = frame.transpose() * (mesh.positions()[corners[k + 1]] - first);
  Eigen::Matrix<double, 3, 2> change;
  change.bottomRows<2>() = sides.inverse();
  change.row(0) = -change.row(1) - change.row(2);
  return change;
}

/// The symmetric matrix with its negative eigenvalues replaced by zero.
Eigen::MatrixXd positive_part(const Eigen::MatrixXd& curvature) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(curvature);
  return modes.eigenvectors() * modes.eigenvalues().cwiseMax(0).asDiagonal() * modes.eigenvectors().transpose();
}

}  // namespace

HostLength host_length(const NetworkState& state, const surface::HostDerivatives& by_barycentrics,
                       std::int32_t from_point, std::int32_t to_point, int order) {
  constexpr Eigen::Index ends = 6;
  const Eigen::Index nodes = by_barycentrics.gradient.size() - ends;
  HostLength result;
  result.length = by_barycentrics.length;
  result.rows = {2 * from_point, 2 * from_point + 1, 2 * to_point, 2 * to_point + 1};
  for (const std::int32_t vertex : by_barycentrics.vertices)
    for (int k = 0; k < 3; ++k) result.rows.push_back(state.node_row(vertex) + k);
  // The change of variables is block diagonal: tangent to barycentric coordinates for each end, the identity for nodes.
  const auto face_of = [&](std::int32_t point) { return state.points()[static_cast<std::size_t>(point)].face; };
  Eigen::Matrix<double, 6, 4> change = Eigen::Matrix<double, 6, 4>::Zero();
  change.topLeftCorner<3, 2>() = barycentrics_by_tangents(state.mesh(), face_of(from_point));
  change.bottomRightCorner<3, 2>() = barycentrics_by_tangents(state.mesh(), face_of(to_point));
  result.gradient.resize(4 + nodes);
  result.gradient << change.transpose() * by_barycentrics.gradient.head(ends), by_barycentrics.gradient.tail(nodes);
  if (order < 2) return result;
  const Eigen::MatrixXd& hessian = by_barycentrics.hessian;
  result.hessian.resize(4 + nodes, 4 + nodes);
  result.hessian.topLeftCorner(4, 4) = change.transpose() * hessian.topLeftCorner(ends, ends) * change;
  result.hessian.bottomLeftCorner(nodes, 4) = hessian.bottomLeftCorner(nodes, ends) * change;
  result.hessian.topRightCorner(4, nodes) = result.hessian.bottomLeftCorner(nodes, 4).transpose();
  result.hessian.bottomRightCorner(nodes, nodes) = hessian.bottomRightCorner(nodes, nodes);
  return result;
}

void HostElement::add_to(numerics::EnergySum& sum, int order) const {
  std::vector<double> lower;
  if (order >= 2) {
    lower.reserve(numerics::HessianEntries::entries_of(rows.size()));
    for (Eigen::Index k = 0; k < hessian.rows(); ++k)
      for (Eigen::Index l = 0; l <= k; ++l) lower.push_back(hessian(k, l));
  }
  sum.add_element(rows, order, value, gradient.data(), lower.data());
}

void HostElement::project_out(std::int32_t point, const Eigen::Vector2d& direction) {
  const auto first = std::ranges::find(rows, 2 * point) - rows.begin();
  const std::array<Eigen::Index, 2> own{first, first + 1};
  const Eigen::Matrix2d rest = Eigen::Matrix2d::Identity() - direction * direction.transpose();
  gradient(own) = (rest * gradient(own)).eval();
  if (hessian.size() == 0) return;
  hessian(own, Eigen::all) = (rest * hessian(own, Eigen::all)).eval();
  hessian(Eigen::all, own) = (hessian(Eigen::all, own) * rest).eval();
}

void HostElement::zero_point(std::int32_t point) {
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k] / 2 != point) continue;
    const auto row = static_cast<Eigen::Index>(k);
    gradient[row] = 0;
    if (hessian.size() == 0) continue;
    hessian.row(row).setZero();
    hessian.col(row).setZero();
  }
}

HostElement element_of_lengths(double value, const Eigen::VectorXd& first, const Eigen::MatrixXd& second,
                               std::span<const HostLength> lengths, int order, bool convex) {
  HostElement element;
  element.value = value;
  if (order < 1) return element;
  for (const HostLength& length : lengths)
    element.rows.insert(element.rows.end(), length.rows.begin(), length.rows.end());
  std::ranges::sort(element.rows);
  element.rows.erase(std::unique(element.rows.begin(), element.rows.end()), element.rows.end());
  const auto size = static_cast<Eigen::Index>(element.rows.size());
  const auto count = static_cast<Eigen::Index>(lengths.size());
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(size, count);
  if (order >= 2) element.hessian = Eigen::MatrixXd::Zero(size, size);
  std::vector<Eigen::Index> places;
  for (Eigen::Index k = 0; k < count; ++k) {
    const HostLength& length = lengths[static_cast<std::size_t>(k)];
    places.clear();
    for (const std::int32_t row : length.rows)
      places.push_back(std::ranges::lower_bound(element.rows, row) - element.rows.begin());
    slopes(places, k) = length.gradient;
    if (order < 2) continue;
    if (!convex || first[k] > 0) element.hessian(places, places) += first[k] * length.hessian;
  }
  element.gradient = slopes * first;
  if (order >= 2) element.hessian += slopes * (convex ? positive_part(second) : second) * slopes.transpose();
  return element;
}

}  // namespace supple::embedded
