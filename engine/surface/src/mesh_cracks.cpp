#include "mesh_cracks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>

#include "equal_points.h"
#include "mesh_connectivity.h"
#include "mesh_faults.h"
#include "near_points.h"
#include "supple/base/stop_pace.h"

namespace supple::surface {
namespace {

using Index = std::int32_t;

/// Units in the last place of single precision by which a corner may differ that was computed twice.
constexpr double single_precision_units = 4;
/// The last of six significant digits, the fewest that programs write, divided by the diagonal of the bounding box.
constexpr double last_of_six_digits = 1e-5;
/// The greatest gap of a crack, divided by the shortest edge at its corners.
constexpr double largest_gap_per_edge = 1.0 / 8;
/// Two faces at an edge that enclose a smaller angle (radians) lie on each other.
constexpr double flat_fold = 1e-3;

/// An edge that has one face, between the places of its two ends.
struct OpenEdge {
  Index lesser, greater;  ///< the places; equal ones are those of one class of vertices
  Index lesser_vertex, greater_vertex, opposite;
};

/// Joins the vertices of cracks pass by pass, each with a greater reach.
class CrackSewer {
 public:
  CrackSewer(const std::vector<Eigen::Vector3d>& positions, const std::vector<Triangle>& faces, Crossings crossings,
             const Execution& execution)
      : positions_(positions), faces_(faces), crossings_(crossings), execution_(execution), first_(positions.size()) {
    std::iota(first_.begin(), first_.end(), 0);
  }

  Cracks find() {
    if (collect_open_edges()) {
      measure();
      const double single = single_precision_units * std::numeric_limits<float>::epsilon() * largest_;
      for (const double reach : {0.0, single, std::max(single, last_of_six_digits * diagonal_)}) {
        if (!sew(reach)) continue;
        if (!collect_open_edges()) break;
      }
    }
    Cracks cracks;
    for (Index v = 0; v < static_cast<Index>(first_.size()); ++v) {
      const Index to = root(v);
      if (to != v) {
        ++cracks.vertices;
        cracks.gap = std::max(cracks.gap, (positions_[v] - positions_[to]).norm());
      }
    }
    cracks.first = std::move(first_);
    return cracks;
  }

 private:
  Index root(Index v) {
    while (first_[v] != v) v = first_[v] = first_[first_[v]];
    return v;
  }

  void join(Index a, Index b) {
    a = root(a);
    b = root(b);
    first_[std::max(a, b)] = std::min(a, b);
  }

  /// The edges of one face, of the faces that have an area, with the vertices that are joined so far; and the vertices
  /// on them. False where there are none.
  bool collect_open_edges() {
    for (Triangle& face : faces_)
      for (Index& v : face) v = root(v);
    std::erase_if(faces_, [this](const Triangle& face) { return is_degenerate(positions_, face); });
    std::int64_t excess = 0;
    const std::vector<Index> partners =
        pair_manifold_halfedges(static_cast<Index>(positions_.size()), faces_, excess, execution_);
    edges_.clear();
    vertices_.clear();
    for (Index h = 0; h < static_cast<Index>(partners.size()); ++h) {
      if (partners[h] >= 0) continue;
      const Triangle& face = faces_[h / 3];
      edges_.push_back({-1, -1, face[h % 3], face[(h + 1) % 3], face[(h + 2) % 3]});
      vertices_.push_back(face[h % 3]);
      vertices_.push_back(face[(h + 1) % 3]);
    }
    std::sort(vertices_.begin(), vertices_.end());
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
    return !edges_.empty();
  }

  void measure() {
    Eigen::Vector3d lower = positions_[faces_[0][0]], upper = lower;
    for (const Triangle& face : faces_) {
      for (const Index v : face) {
        lower = lower.cwiseMin(positions_[v]);
        upper = upper.cwiseMax(positions_[v]);
      }
    }
    diagonal_ = (upper - lower).norm();
    largest_ = lower.cwiseAbs().cwiseMax(upper.cwiseAbs()).maxCoeff();
  }

  /// Half of the gap that a crack may have at each of vertices_, so that no two that are near a third are further
  /// apart.
  std::vector<double> half_gaps(double reach) const {
    std::vector<double> shortest(positions_.size(), std::numeric_limits<double>::infinity());
    for (const Triangle& face : faces_) {
      for (int i = 0; i < 3; ++i) {
        const Index a = face[i], b = face[(i + 1) % 3];
        const double length = (positions_[a] - positions_[b]).norm();
        shortest[a] = std::min(shortest[a], length);
        shortest[b] = std::min(shortest[b], length);
      }
    }
    std::vector<double> gaps;
    gaps.reserve(vertices_.size());
    for (const Index v : vertices_) gaps.push_back(0.5 * std::min(reach, largest_gap_per_edge * shortest[v]));
    return gaps;
  }

  /// Joins the cracks whose gap is within the reach, and says whether there are any.
  bool sew(double reach) {
    std::vector<Eigen::Vector3d> points;
    points.reserve(vertices_.size());
    for (const Index v : vertices_) points.push_back(positions_[v]);
    const std::vector<Index> places =
        reach > 0 ? first_near_points(points, half_gaps(reach), execution_) : first_equal_points(points, execution_);
    const auto place_of = [&](Index v) {
      return places[std::lower_bound(vertices_.begin(), vertices_.end(), v) - vertices_.begin()];
    };
    std::vector<OpenEdge> edges;
    edges.reserve(edges_.size());
    for (OpenEdge edge : edges_) {
      edge.lesser = place_of(edge.lesser_vertex);
      edge.greater = place_of(edge.greater_vertex);
      if (edge.lesser == edge.greater) continue;
      if (edge.lesser > edge.greater) {
        std::swap(edge.lesser, edge.greater);
        std::swap(edge.lesser_vertex, edge.greater_vertex);
      }
      edges.push_back(edge);
    }
    sort_stoppably(edges, execution_.cancellation, [](const OpenEdge& a, const OpenEdge& b) {
      return std::array{a.lesser, a.greater, a.lesser_vertex, a.greater_vertex, a.opposite} <
             std::array{b.lesser, b.greater, b.lesser_vertex, b.greater_vertex, b.opposite};
    });
    bool any = false;
    for (auto group = edges.begin(); group != edges.end();) {
      const auto end = std::find_if(group, edges.end(), [&](const OpenEdge& edge) {
        return edge.lesser != group->lesser || edge.greater != group->greater;
      });
      const bool pair = end - group == 2 && !lie_on_each_other(group[0], group[1]);
      if (pair || (end - group > 2 && reach == 0 && crossings_ == Crossings::joined)) {
        for (auto edge = group + 1; edge != end; ++edge) {
          any = any || edge->lesser_vertex != group->lesser_vertex || edge->greater_vertex != group->greater_vertex;
          join(group->lesser_vertex, edge->lesser_vertex);
          join(group->greater_vertex, edge->greater_vertex);
        }
      }
      group = end;
    }
    return any;
  }

  /// Whether the faces of two edges in one place leave it in the same direction: so do the two sides of a thin sheet.
  bool lie_on_each_other(const OpenEdge& a, const OpenEdge& b) const {
    const Eigen::Vector3d along = (positions_[a.greater_vertex] - positions_[a.lesser_vertex]).normalized();
    const auto inwards = [&](const OpenEdge& edge) {
      const Eigen::Vector3d to_opposite = positions_[edge.opposite] - positions_[edge.lesser_vertex];
      return Eigen::Vector3d((to_opposite - along * along.dot(to_opposite)).normalized());
    };
    const Eigen::Vector3d u = inwards(a), v = inwards(b);
    return u.dot(v) > 0 && u.cross(v).norm() < flat_fold;
  }

  const std::vector<Eigen::Vector3d>& positions_;
  std::vector<Triangle> faces_;
  Crossings crossings_;
  const Execution& execution_;
  std::vector<Index> first_;
  std::vector<OpenEdge> edges_;
  std::vector<Index> vertices_;  ///< of the edges, in ascending order
  double diagonal_ = 0;
  double largest_ = 0;
};

}  // namespace

Cracks find_cracks(const std::vector<Eigen::Vector3d>& positions, const std::vector<Triangle>& faces,
                   Crossings crossings, const Execution& execution) {
  return CrackSewer(positions, faces, crossings, execution).find();
}

}  // namespace supple::surface
