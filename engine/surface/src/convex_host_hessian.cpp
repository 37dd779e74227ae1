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

/// Shorter segments count as so long, as a share of the path: the matrix stays one that can be solved with.
constexpr double shortest_segment = 1e-3;
/// Added to the crossings' matrix, as a share of its mean diagonal: edges along the path leave their crossing free.
constexpr double crossing_shift = 1e-9;

/// The place of one point of the path as a linear function of the variables: blocks of 3 by 3 for barycentric
/// coordinates and vertices, and a column for a crossing.
struct Place {
  struct Block {
    Eigen::Index first;
    Matrix3d by;
  };
  std::vector<Block> blocks;
  Eigen::Index crossing = -1;
  Vector3d along = Vector3d::Zero();  ///< by the crossing's parameter
};

class ConvexLength {
 public:
  ConvexLength(const TriangleMesh& mesh, const std::vector<PathPoint>& path, const std::vector<std::int32_t>& vertices)
      : mesh_(mesh), vertices_(vertices), size_(6 + 3 * static_cast<Eigen::Index>(vertices.size())) {
    for (std::size_t i = 0; i < path.size(); ++i) places_.push_back(place_of(path, i));
    matrix_ = MatrixXd::Zero(size_ + crossings_, size_ + crossings_);
    double length = 0;
    for (std::size_t i = 1; i < path.size(); ++i) length += (path[i].position - path[i - 1].position).norm();
    for (std::size_t i = 1; i < path.size(); ++i)
      add_segment(places_[i - 1], places_[i], path[i].position - path[i - 1].position, shortest_segment * length);
  }

  /// With the crossings where they make the sum least.
  MatrixXd hessian() {
    MatrixXd by_all = matrix_.topLeftCorner(size_, size_);
    if (crossings_ == 0) return by_all;
    MatrixXd crossings = matrix_.bottomRightCorner(crossings_, crossings_);
    crossings.diagonal().array() += crossing_shift * crossings.diagonal().mean();
    const MatrixXd mixed = matrix_.bottomLeftCorner(crossings_, size_);
    const Eigen::LLT<MatrixXd> factor(crossings);
    if (factor.info() != Eigen::Success) return by_all;
    const MatrixXd half = factor.matrixL().solve(mixed);
    return by_all - half.transpose() * half;
  }

 private:
  Place place_of(const std::vector<PathPoint>& path, std::size_t i) {
    Place place;
    const SurfacePoint& point = path[i].point;
    const Triangle& corners = mesh_.faces()[index(point.face)];
    for (int k = 0; k < 3; ++k) {
      if (point.barycentric[k] == 0) continue;
      const auto at = std::ranges::lower_bound(vertices_, corners[k]) - vertices_.begin();
      place.blocks.push_back({6 + 3 * at, point.barycentric[k] * Matrix3d::Identity()});
    }
    const bool is_end = i == 0 || i + 1 == path.size();
    if (is_end) {
      Matrix3d by_barycentrics;
      for (int k = 0; k < 3; ++k) by_barycentrics.col(k) = mesh_.positions()[corners[k]] - path[i].position;
      place.blocks.push_back({i == 0 ? 0 : 3, by_barycentrics});
    } else if (crosses_edge(path[i])) {
      const std::int32_t side = 3 * index(point.face) + side_of(point);
      place.crossing = crossings_++;
      place.along = mesh_.positions()[mesh_.head(side)] - mesh_.positions()[mesh_.tail(side)];
    }
    return place;
  }

  void add_segment(const Place& from, const Place& to, const Vector3d& way, double shortest) {
    const double length = way.norm();
    const Vector3d u = length > 0 ? Vector3d(way / length) : Vector3d::Zero();
    const Matrix3d across = (Matrix3d::Identity() - u * u.transpose()) / std::max(length, shortest);
    // Columns of what the segment depends on, with the sign of its ends.
    columns_.clear();
    MatrixXd by(3, 0);
    const auto append = [&](const Place& place, double sign) {
      for (const Place::Block& block : place.blocks) {
        by.conservativeResize(3, by.cols() + 3);
        by.rightCols<3>() = sign * block.by;
        for (Eigen::Index k = 0; k < 3; ++k) columns_.push_back(block.first + k);
      }
      if (place.crossing < 0) return;
      by.conservativeResize(3, by.cols() + 1);
      by.rightCols<1>() = sign * place.along;
      columns_.push_back(size_ + place.crossing);
    };
    append(from, -1);
    append(to, 1);
    const MatrixXd own = by.transpose() * across * by;
    for (Eigen::Index k = 0; k < own.rows(); ++k)
      for (Eigen::Index l = 0; l < own.cols(); ++l)
        matrix_(columns_[static_cast<std::size_t>(k)], columns_[static_cast<std::size_t>(l)]) += own(k, l);
  }

  const TriangleMesh& mesh_;
  const std::vector<std::int32_t>& vertices_;
  Eigen::Index size_;
  Eigen::Index crossings_ = 0;
  std::vector<Place> places_;
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
