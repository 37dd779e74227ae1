#pragma once

#include <Eigen/Core>
#include <memory>

#include "supple/base/execution.h"
#include "supple/surface/surface_point.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

/// The point of a surface that is nearest to a point in space.
struct NearestPoint {
  SurfacePoint point;
  Eigen::Vector3d position;  ///< position of `point`, in mesh units
  double distance = 0;       ///< distance of the given point from it, in mesh units
};

/// Finds nearest points with a tree of the faces' bounding boxes. Building it takes O(n log n), some tenths of a second
/// for a million faces, and 28 to 52 bytes per face. A search takes O(log n) for points near the surface. Searches may
/// run in parallel.
class NearestPointSearch {
 public:
  /// The mesh must outlive the search.
  explicit NearestPointSearch(const TriangleMesh& mesh, const Execution& execution = {});
  NearestPointSearch(NearestPointSearch&&) noexcept;
  ~NearestPointSearch();

  /// The nearest point. If several are equally near, it is the one whose face has the least number. Exact up to
  /// rounding: a point on an edge or a vertex has coordinates that are exactly 0 or 1. The coordinates of p are finite
  /// and at most 1e70 in magnitude.
  NearestPoint find(const Eigen::Vector3d& p) const;

 private:
  struct Implementation;
  std::unique_ptr<const Implementation> implementation_;
};

}  // namespace supple::surface
