#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "supple/base/execution.h"
#include "supple/surface/geodesic_solver.h"

namespace supple::surface {

/// How the distances between fixed anchors and a moving point are found.
enum class AnchorSearch {
  pairs,        ///< one goal-directed search per anchor
  one_to_many,  ///< one search from the moving point, stopped once every anchor is reached
  fields        ///< a distance field per anchor, computed once and kept
};

struct AnchorSearchChoice {
  AnchorSearch search;
  std::string why;  ///< one sentence for the bill
};

/// The cheapest search for `anchors` anchors and about `evaluations` positions of the moving point. Reads nothing but
/// sizes, so equal problems are solved alike on every run.
AnchorSearchChoice cheapest_search(std::int64_t faces, std::int64_t anchors, std::int64_t evaluations);

/// A shortest path between an anchor and the moving point p, seen from p.
struct AnchorGeodesic {
  double distance = 0;
  bool certain = true;  ///< p is not on the anchor's cut locus: no second shortest path was met
  /// Derivatives of the distance in tangent_frame of p's face; zero where p is the anchor.
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  Eigen::Matrix2d hessian = Eigen::Matrix2d::Zero();
  bool coincident = false;
  /// The path's neighbour of p, where paths were asked for and p is not the anchor.
  std::optional<SurfacePoint> neighbour;
};

/// Distances between fixed anchors and a moving point.
class AnchorDistances {
 public:
  /// Computes the fields if `search` keeps them. The solver outlives the object.
  AnchorDistances(const GeodesicSolver& solver, std::vector<SurfacePoint> anchors, AnchorSearch search,
                  const Execution& execution);

  enum class Need { values, derivatives, directions };
  /// One entry per anchor. Directions give the neighbours along the paths and no derivatives.
  std::vector<AnchorGeodesic> at(const SurfacePoint& p, Need need, const Execution& execution) const;

 private:
  const GeodesicSolver& solver_;
  std::vector<SurfacePoint> anchors_;
  AnchorSearch search_;
  std::vector<GeodesicField> fields_;
};

}  // namespace supple::surface
