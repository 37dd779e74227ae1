#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "supple/base/execution.h"
#include "supple/surface/geodesic_solver.h"

namespace supple::surface {

/// The search that finds the distances between fixed anchors and a moving point.
enum class AnchorSearch {
  pairs,        ///< one goal-directed search for each anchor
  guided,       ///< the same, guided by a distance field from a landmark, which is a point near the moving one
  one_to_many,  ///< one search from the moving point, which ends when every anchor is reached
  fields        ///< a distance field for each anchor, computed once and queried for every position
};

/// The facts by which the search is chosen. They are sizes and counts, and no times, so that equal problems are solved
/// in the same way on every run.
struct AnchorSearchFacts {
  std::int64_t faces = 0;
  std::int64_t anchors = 0;
  std::int64_t evaluations = 0;  ///< positions of the moving point that are still expected
  double windows_per_pair = 0;   ///< average over the pair searches so far; 0 if there were none
};
struct AnchorSearchChoice {
  AnchorSearch search;
  std::string why;  ///< one sentence for the bill
};

/// The search that is expected to propagate the fewest windows. The count of windows per pair matters: a pair search
/// takes a twentieth of a field's windows on a compact shape, but half of them on a winding shape, where straight
/// distances say little about geodesic ones.
AnchorSearchChoice cheapest_search(const AnchorSearchFacts& facts);

/// A shortest path between an anchor and the moving point p, with derivatives with respect to p.
struct AnchorGeodesic {
  double distance = 0;
  bool certain = true;  ///< no second shortest path was found: p is not on the anchor's cut locus
  /// Derivatives of the distance in tangent_frame of p's face; zero if p is the anchor.
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  Eigen::Matrix2d hessian = Eigen::Matrix2d::Zero();
  bool coincident = false;
  /// The point of the path next to p, if paths were asked for and p is not the anchor.
  std::optional<SurfacePoint> neighbour;
};

/// Distances between fixed anchors and a moving point.
class AnchorDistances {
 public:
  /// Begins with pair searches, or with one search for all if there are many anchors. The solver must outlive the
  /// object.
  AnchorDistances(const GeodesicSolver& solver, std::vector<SurfacePoint> anchors);

  /// Distances from each of the chosen anchors (indices, ascending) to all anchors, one row each, for the choice of a
  /// start. They are exact, and each pair is searched for once. If the first search shows that a pair is expensive,
  /// they are upper bounds by paths along edges.
  std::vector<std::vector<double>> between(const std::vector<std::size_t>& chosen, const Execution& execution);

  /// The facts for the choice of a search, for `evaluations` more positions.
  AnchorSearchFacts facts(std::int64_t evaluations) const;
  /// Changes to another search. For AnchorSearch::fields it computes the field of each anchor.
  void use(AnchorSearch search, const Execution& execution);

  enum class Need { values, derivatives, directions };
  /// The geodesics from p to all anchors. Need::directions gives AnchorGeodesic::neighbour and no derivatives.
  std::vector<AnchorGeodesic> at(const SurfacePoint& p, Need need, const Execution& execution);

 private:
  /// Runs body(i, execution) for i in [0, n), in parallel if the mesh is large enough. Returns the number of windows
  /// that were propagated.
  double for_each(std::size_t n, const Execution& execution, const std::function<void(int, const Execution&)>& body);

  const GeodesicSolver& solver_;
  std::vector<SurfacePoint> anchors_;
  /// Computes a new landmark if there is none near p. Returns the distance between the landmark and p.
  double landmark_near(const SurfacePoint& p, const Execution& execution);
  std::vector<std::vector<double>> edge_path_rows(const std::vector<std::size_t>& chosen, const Execution& execution);

  AnchorSearch search_;
  struct Landmark {
    SurfacePoint at;
    GeodesicField field;
  };
  std::optional<Landmark> landmark_;
  double mean_distance_ = 0;  ///< mean over the anchors at the last evaluation
  std::vector<GeodesicField> fields_;
  double pair_windows_ = 0;
  std::int64_t pairs_searched_ = 0;
};

}  // namespace supple::surface
