#pragma once

#include <Eigen/Core>
#include <map>
#include <utility>
#include <vector>

#include "supple/tiling/mesh.h"
#include "supple/tiling/structure.h"

namespace supple::tiling {

/// The wanted length of triangle sides: h (c + (1 - c) min(1, d / r)) at the distance d from the nearest re-entrant
/// corner of the solid, with h = mesh_size * beam_width, c = corner_size and r half a beam width.
class SizeField {
 public:
  SizeField(const MeshOptions& options, double beam_width);

  /// Adds the corners of a hole (counterclockwise) at which the solid is re-entrant.
  void add_corners(const Polygon& hole);
  void remove_corners() { corners_.clear(); }
  /// Replaces the corners by all their translates that influence the parallelogram `origin` + lattice * [0, 1]^2.
  void repeat_corners(const Eigen::Matrix2d& lattice, const Eigen::Vector2d& origin);

  /// Sorts the corners into squares, so that a size is found in the time for the corners nearby. It pays for more than
  /// some hundred corners. Corners must not be changed afterwards.
  void index_corners();

  double operator()(const Eigen::Vector2d& p) const;
  double max_size() const { return size_; }
  std::size_t corners() const { return corners_.size(); }
  /// Expected number of nodes of quadratic triangles on `solid_area` (mm^2) with `corners` corners.
  double expected_nodes(double solid_area, double corners) const;

  /// Inner points that divide the segment from a to b into parts of the wanted length, in order.
  std::vector<Eigen::Vector2d> divide(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const;

 private:
  double size_;         // mm
  double corner_size_;  // relative to size_
  double radius_;       // mm
  std::vector<Eigen::Vector2d> corners_;
  std::map<std::pair<int, int>, std::vector<Eigen::Vector2d>> squares_;  // of side radius_; empty without an index
};

/// Inner points that divide the segment into equal parts no longer than `size`: the same points from either end.
std::vector<Eigen::Vector2d> divide_equally(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double size);

}  // namespace supple::tiling
