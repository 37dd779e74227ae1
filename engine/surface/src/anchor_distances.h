#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "supple/base/execution.h"
#include "supple/surface/geodesic_solver.h"

namespace supple::surface {

/// How the distances between fixed anchors and a moving point are found.
enum class AnchorSearch {
  pairs,        ///< one goal-directed search per anchor
  guided,       ///< the same, led by a distance field from a point near the moving one
  one_to_many,  ///< one search from the moving point, stopped once every anchor is reached
  fields        ///< a distance field per anchor, computed once and kept
};

/// What is known when the search is chosen, sizes and counts only, so that equal problems are solved alike on every
/// run.
struct AnchorSearchFacts {
  std::int64_t faces = 0;
  std::int64_t anchors = 0;
  std::int64_t evaluations = 0;  ///< positions of the moving point that are still expected
  double windows_per_pair = 0;   ///< what the pair searches so far took on average; 0 if there were none
};
struct AnchorSearchChoice {
  AnchorSearch search;
  std::string why;  ///< one sentence for the bill
};

/// The search that is expected to propagate the fewest windows. A pair search on a compact shape looks at a twentieth
/// of what a field takes, one on a winding shape, where straight distances say little, at half of it: hence the count.
AnchorSearchChoice cheapest_search(const AnchorSearchFacts& facts);

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
  /// Begins with pair searches, or, for many anchors, with one search for all. The solver outlives the object.
  AnchorDistances(const GeodesicSolver& solver, std::vector<SurfacePoint> anchors);

  /// Distances from each of the chosen anchors (indices, ascending) to all, one row each, for the choice of a start:
  /// exact, pairs searched once, or, where the first search shows that a pair is dear, upper bounds by paths along
  /// edges.
  std::vector<std::vector<double>> between(const std::vector<std::size_t>& chosen, const Execution& execution);

  /// What is known of the cost of the searches, for `evaluations` more positions.
  AnchorSearchFacts facts(std::int64_t evaluations) const;
  /// Changes to another search. For fields computes one per anchor.
  void use(AnchorSearch search, const Execution& execution);

  enum class Need { values, derivatives, directions };
  /// One entry per anchor. Directions give the neighbours along the paths and no derivatives.
  std::vector<AnchorGeodesic> at(const SurfacePoint& p, Need need, const Execution& execution);

 private:
  /// Runs body(i, execution) for i in [0, n), in parallel where the mesh is large enough; returns the windows
  /// propagated.
  double for_each(std::size_t n, const Execution& execution, const std::function<void(int, const Execution&)>& body);

  const GeodesicSolver& solver_;
  std::vector<SurfacePoint> anchors_;
  /// Makes sure that a field from a point near p is at hand; returns the distance between the two.
  double landmark_near(const SurfacePoint& p, const Execution& execution);
  std::vector<std::vector<double>> edge_path_rows(const std::vector<std::size_t>& chosen, const Execution& execution);

  AnchorSearch search_;
  struct Landmark {
    SurfacePoint at;
    GeodesicField field;
  };
  std::optional<Landmark> landmark_;
  double mean_distance_ = 0;  ///< of the anchors at the last evaluation
  std::vector<GeodesicField> fields_;
  double pair_windows_ = 0;
  std::int64_t pairs_searched_ = 0;
};

}  // namespace supple::surface
