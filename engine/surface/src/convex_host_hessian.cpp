#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>

#include "path_strip.h"
#include "supple/surface/geodesic_derivatives.h"

namespace supple::surface {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

/// Minimum length of a segment in the matrix, as a fraction of the path. It bounds the condition number.
constexpr double min_segment_fraction = 1e-3;
/// Shift of the crossings' matrix, as a fraction of its mean diagonal. It makes the matrix definite even if the path
/// runs along an edge, which leaves the crossing free.
constexpr double crossing_shift = 1e-9;

/// A point of the path as a linear function of the variables. It has blocks of 3 by 3 for barycentric coordinates and
/// vertices, and a column for the parameter of its crossing.
struct LinearPoint {
  struct Block {
    Eigen::Index first;  ///< index of the first of its three variables
    Matrix3d jacobian;
  };
  std::vector<Block> blocks;
  Eigen::Index crossing = -1;         ///< index of the crossing; -1 for other points
  Vector3d along = Vector3d::Zero();  ///< derivative by the crossing's parameter
};

class ConvexLength {
 public:
  ConvexLength(const TriangleMesh& mesh, const std::vector<PathPoint>& path, const std::vector<std::int32_t>& vertices)
      : mesh_(mesh), vertices_(vertices), size_(6 + 3 * static_cast<Eigen::Index>(vertices.size())) {
    for (std::size_t i = 0; i < path.size(); ++i) points_.push_back(point_of(path, i));
    matrix_ = MatrixXd::Zero(size_ + crossings_, size_ + crossings_);
    double length = 0;
    for (std::size_t i = 1; i < path.size(); ++i) length += (path[i].position - path[i - 1].position).norm();
    for (std::size_t i = 1; i < path.size(); ++i)
      add_segment(points_[i - 1], points_[i], path[i].position - path[i - 1].position, min_segment_fraction * length);
  }

  /// The Hessian by the variables alone, with the crossings where they minimize the quadratic form.
  MatrixXd hessian() {
    MatrixXd by_variables = matrix_.topLeftCorner(size_, size_);
    if (crossings_ == 0) return by_variables;
    MatrixXd crossings = matrix_.bottomRightCorner(crossings_, crossings_);
    crossings.diagonal().array() += crossing_shift * crossings.diagonal().mean();
    const MatrixXd mixed = matrix_.bottomLeftCorner(crossings_, size_);
    const Eigen::LLT<MatrixXd> factor(crossings);
    if (factor.info() != Eigen::Success) return by_variables;
    const MatrixXd half = factor.matrixL().solve(mixed);
    return by_variables - half.transpose() * half;
  }

 private:
  LinearPoint point_of(const std::vector<PathPoint>& path, std::size_t i) {
    LinearPoint linear_point;
    const SurfacePoint& point = path[i].point;
    const Triangle& corners = mesh_.faces()[index(point.face)];
    for (int k = 0; k < 3; ++k) {
      if (point.barycentric[k] == 0) continue;
      const auto at = std::ranges::lower_bound(vertices_, corners[k]) - vertices_.begin();
      linear_point.blocks.push_back({6 + 3 * at, point.barycentric[k] * Matrix3d::Identity()});
    }
    const bool is_end = i == 0 || i + 1 == path.size();
    if (is_end) {
      Matrix3d by_barycentrics;
      for (int k = 0; k < 3; ++k) by_barycentrics.col(k) = mesh_.positions()[corners[k]] - path[i].position;
      linear_point.blocks.push_back({i == 0 ? 0 : 3, by_barycentrics});
    } else if (crosses_edge(path[i])) {
      const std::int32_t side = 3 * index(point.face) + side_of(point);
      linear_point.crossing = crossings_++;
      linear_point.along = mesh_.positions()[mesh_.head(side)] - mesh_.positions()[mesh_.tail(side)];
    }
    return linear_point;
  }

  void add_segment(const LinearPoint& from, const LinearPoint& to, const Vector3d& displacement, double min_length) {
    const double length = displacement.norm();
    const Vector3d u = length > 0 ? Vector3d(displacement / length) : Vector3d::Zero();
    const Matrix3d across = (Matrix3d::Identity() - u * u.transpose()) / std::max(length, min_length);
    // The Jacobian of the vector from one end of the segment to the other. `columns_` holds the index of each column.
    columns_.clear();
    MatrixXd jacobian(3, 0);
    const auto append = [&](const LinearPoint& linear_point, double sign) {
      for (const LinearPoint::Block& block : linear_point.blocks) {
        jacobian.conservativeResize(3, jacobian.cols() + 3);
        jacobian.rightCols<3>() = sign * block.jacobian;
        for (Eigen::Index k = 0; k < 3; ++k) columns_.push_back(block.first + k);
      }
      if (linear_point.crossing < 0) return;
      jacobian.conservativeResize(3, jacobian.cols() + 1);
      jacobian.rightCols<1>() = sign * linear_point.along;
      columns_.push_back(size_ + linear_point.crossing);
    };
    append(from, -1);
    append(to, 1);
    const MatrixXd segment_hessian = jacobian.transpose() * across * jacobian;
    for (Eigen::Index k = 0; k < segment_hessian.rows(); ++k)
      for (Eigen::Index l = 0; l < segment_hessian.cols(); ++l)
        matrix_(columns_[static_cast<std::size_t>(k)], columns_[static_cast<std::size_t>(l)]) += segment_hessian(k, l);
  }

  const TriangleMesh& mesh_;
  const std::vector<std::int32_t>& vertices_;
  Eigen::Index size_;
  Eigen::Index crossings_ = 0;
  std::vector<LinearPoint> points_;
  MatrixXd matrix_;
  std::vector<Eigen::Index> columns_;
};

}  // namespace

MatrixXd convex_host_hessian(const TriangleMesh& mesh, const std::vector<PathPoint>& path,
                             const std::vector<std::int32_t>& vertices) {
  if (path.size() < 2) return MatrixXd::Zero(6, 6);
  return ConvexLength(mesh, path, vertices).hessian();
}

}  // namespace supple::surface
