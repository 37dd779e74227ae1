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

/// Units in the last place of single precision by which two computations of the same corner may differ.
constexpr double single_precision_units = 4;
/// The last of six significant digits, relative to the diagonal of the bounding box. Programs write at least six
/// digits.
constexpr double last_of_six_digits = 1e-5;
/// Maximum gap of a crack, relative to the shortest edge at its corners.
constexpr double max_gap_per_edge = 1.0 / 8;
/// Two faces at an edge count as folded onto each other if they enclose a smaller angle (radians).
constexpr double fold_angle_tolerance = 1e-3;

/// An edge that has one face.
struct BoundaryEdge {
  Index lesser_class, greater_class;  ///< classes of its end points; vertices of one class coincide
  Index lesser_vertex, greater_vertex, opposite;
};

/// Joins the vertices of cracks in several passes with growing maximum gaps.
class CrackStitcher {
 public:
  CrackStitcher(const std::vector<Eigen::Vector3d>& positions, const std::vector<Triangle>& faces,
                MultipleEdges multiple_edges, const Execution& execution)
      : positions_(positions),
        faces_(faces),
        multiple_edges_(multiple_edges),
        execution_(execution),
        first_(positions.size()) {
    std::iota(first_.begin(), first_.end(), 0);
  }

  Cracks find() {
    if (collect_boundary_edges()) {
      measure();
      const double single_precision_gap =
          single_precision_units * std::numeric_limits<float>::epsilon() * largest_coordinate_;
      for (const double max_gap :
           {0.0, single_precision_gap, std::max(single_precision_gap, last_of_six_digits * diagonal_)}) {
        if (!stitch(max_gap)) continue;
        if (!collect_boundary_edges()) break;
      }
    }
    Cracks cracks;
    for (Index v = 0; v < static_cast<Index>(first_.size()); ++v) {
      const Index representative = root(v);
      if (representative != v) {
        ++cracks.vertices;
        cracks.gap = std::max(cracks.gap, (positions_[v] - positions_[representative]).norm());
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

  void unite(Index a, Index b) {
    a = root(a);
    b = root(b);
    first_[std::max(a, b)] = std::min(a, b);
  }

  /// Replaces vertices by those to which they are joined, and removes degenerate faces. Collects the edges that have
  /// one face, and their vertices. Returns whether there are any.
  bool collect_boundary_edges() {
    for (Triangle& face : faces_)
      for (Index& v : face) v = root(v);
    std::erase_if(faces_, [this](const Triangle& face) { return is_degenerate(positions_, face); });
    std::int64_t non_manifold_edges = 0;
    const std::vector<Index> partners =
        pair_manifold_halfedges(static_cast<Index>(positions_.size()), faces_, non_manifold_edges, execution_);
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
    largest_coordinate_ = lower.cwiseAbs().cwiseMax(upper.cwiseAbs()).maxCoeff();
  }

  /// Half of the maximum gap at each of vertices_. With half, two vertices that are joined to a third one are within
  /// the maximum gap of each other.
  std::vector<double> half_gaps(double max_gap) const {
    std::vector<double> shortest_edge(positions_.size(), std::numeric_limits<double>::infinity());
    for (const Triangle& face : faces_) {
      for (int i = 0; i < 3; ++i) {
        const Index a = face[i], b = face[(i + 1) % 3];
        const double length = (positions_[a] - positions_[b]).norm();
        shortest_edge[a] = std::min(shortest_edge[a], length);
        shortest_edge[b] = std::min(shortest_edge[b], length);
      }
    }
    std::vector<double> gaps;
    gaps.reserve(vertices_.size());
    for (const Index v : vertices_) gaps.push_back(0.5 * std::min(max_gap, max_gap_per_edge * shortest_edge[v]));
    return gaps;
  }

  /// Joins the cracks whose gap is at most `max_gap`. Returns whether any were joined.
  bool stitch(double max_gap) {
    std::vector<Eigen::Vector3d> points;
    points.reserve(vertices_.size());
    for (const Index v : vertices_) points.push_back(positions_[v]);
    const std::vector<Index> classes = max_gap > 0 ? first_near_points(points, half_gaps(max_gap), execution_)
                                                   : first_equal_points(points, execution_);
    const auto class_of = [&](Index v) {
      return classes[std::lower_bound(vertices_.begin(), vertices_.end(), v) - vertices_.begin()];
    };
    std::vector<BoundaryEdge> edges;
    edges.reserve(edges_.size());
    for (BoundaryEdge edge : edges_) {
      edge.lesser_class = class_of(edge.lesser_vertex);
      edge.greater_class = class_of(edge.greater_vertex);
      if (edge.lesser_class == edge.greater_class) continue;
      if (edge.lesser_class > edge.greater_class) {
        std::swap(edge.lesser_class, edge.greater_class);
        std::swap(edge.lesser_vertex, edge.greater_vertex);
      }
      edges.push_back(edge);
    }
    sort_stoppably(edges, execution_.cancellation, [](const BoundaryEdge& a, const BoundaryEdge& b) {
      return std::array{a.lesser_class, a.greater_class, a.lesser_vertex, a.greater_vertex, a.opposite} <
             std::array{b.lesser_class, b.greater_class, b.lesser_vertex, b.greater_vertex, b.opposite};
    });
    bool any = false;
    for (auto group = edges.begin(); group != edges.end();) {
      const auto end = std::find_if(group, edges.end(), [&](const BoundaryEdge& edge) {
        return edge.lesser_class != group->lesser_class || edge.greater_class != group->greater_class;
      });
      const bool pair = end - group == 2 && !are_folded(group[0], group[1]);
      if (pair || (end - group > 2 && max_gap == 0 && multiple_edges_ == MultipleEdges::joined)) {
        for (auto edge = group + 1; edge != end; ++edge) {
          any = any || edge->lesser_vertex != group->lesser_vertex || edge->greater_vertex != group->greater_vertex;
          unite(group->lesser_vertex, edge->lesser_vertex);
          unite(group->greater_vertex, edge->greater_vertex);
        }
      }
      group = end;
    }
    return any;
  }

  /// Whether the faces of two coincident edges leave the edge in nearly the same direction, as the two sides of a thin
  /// sheet do.
  bool are_folded(const BoundaryEdge& a, const BoundaryEdge& b) const {
    const Eigen::Vector3d along = (positions_[a.greater_vertex] - positions_[a.lesser_vertex]).normalized();
    const auto inwards = [&](const BoundaryEdge& edge) {
      const Eigen::Vector3d to_opposite = positions_[edge.opposite] - positions_[edge.lesser_vertex];
      return Eigen::Vector3d((to_opposite - along * along.dot(to_opposite)).normalized());
    };
    const Eigen::Vector3d u = inwards(a), v = inwards(b);
    return u.dot(v) > 0 && u.cross(v).norm() < fold_angle_tolerance;
  }

  const std::vector<Eigen::Vector3d>& positions_;
  std::vector<Triangle> faces_;
  MultipleEdges multiple_edges_;
  const Execution& execution_;
  std::vector<Index> first_;
  std::vector<BoundaryEdge> edges_;
  std::vector<Index> vertices_;  ///< vertices of the edges, in ascending order
  double diagonal_ = 0;
  double largest_coordinate_ = 0;
};

}  // namespace

Cracks find_cracks(const std::vector<Eigen::Vector3d>& positions, const std::vector<Triangle>& faces,
                   MultipleEdges multiple_edges, const Execution& execution) {
  return CrackStitcher(positions, faces, multiple_edges, execution).find();
}

}  // namespace supple::surface
