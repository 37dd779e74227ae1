#include "diagram_finder.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>

#include "supple/surface/vertex_cone.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;
using surface::TangentGeodesic;

Execution unbilled(const Execution& execution) {
  Execution result = execution;
  result.cost = nullptr;
  result.progress = nullptr;
  return result;
}

/// The gradient of the distance by the coordinates of the end `to`.
Vector2d gradient_at(const surface::MovingPoints& sites, const surface::TriangleMesh& mesh, std::int32_t site,
                     const TangentGeodesic& geodesic) {
  if (!sites.on_tip(static_cast<std::size_t>(site))) return geodesic.to_direction;
  if (!std::isfinite(geodesic.to_angle)) return Vector2d::Zero();
  const surface::VertexCone cone(mesh, sites.vertex_of(mesh, static_cast<std::size_t>(site)));
  return -surface::cone_coordinates(cone, geodesic.to_angle);
}

/// Moving a place by dx changes its distances from sites 0 and k alike: (g0 - gk) . dx + p0 . ds0 - pk . dsk = 0. Of
/// more than three sites by least squares.
void solve_motion(VertexMotion& motion) {
  const auto count = motion.pulls.size();
  motion.along.assign(count, Vector2d::Zero());
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  for (std::size_t k = 1; k < count; ++k) {
    const Vector2d row = motion.pulls[0].by_place - motion.pulls[k].by_place;
    normal += row * row.transpose();
  }
  const double determinant = normal.determinant();
  // Sites all but in one direction: the vertex moves faster than anything can be said of.
  if (!(determinant > 1e-24 * normal.squaredNorm())) return;
  const Eigen::Matrix2d inverse = normal.inverse();
  for (std::size_t k = 1; k < count; ++k) {
    motion.along[k] = inverse * (motion.pulls[0].by_place - motion.pulls[k].by_place);
    motion.along[0] -= motion.along[k];
  }
}

/// Geodesics for pulls that the diagram does not know, of vertices that have become one.
void search_missing(const surface::GeodesicSolver& solver, const surface::MovingPoints& sites, Found& found,
                    const Execution& execution) {
  std::vector<surface::PointPair> pairs;
  std::vector<SitePull*> missing;
  std::size_t next = 0;
  for (const DiagramVertex& vertex : found.diagram.vertices) {
    for (const std::int32_t site : vertex.sites) {
      SitePull& pull = found.diagram.vertex_pulls[next++];
      if (pull.site >= 0) continue;
      pull.site = site;
      missing.push_back(&pull);
      pairs.push_back({found.diagram.points[static_cast<std::size_t>(vertex.point)].point,
                       sites.points()[static_cast<std::size_t>(site)], nullptr});
    }
  }
  if (pairs.empty()) return;
  std::vector<TangentGeodesic> geodesics(pairs.size());
  solver.tangent_geodesics(pairs, geodesics, false, unbilled(execution));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    SitePull& pull = *missing[i];
    pull = {pull.site, geodesics[i].distance, -geodesics[i].from_direction,
            gradient_at(sites, solver.mesh(), pull.site, geodesics[i])};
  }
}

void find_motions(const surface::GeodesicSolver& solver, const surface::MovingPoints& sites, Found& found,
                  const Execution& execution) {
  search_missing(solver, sites, found, execution);
  found.motions.resize(found.diagram.vertices.size());
  auto next = found.diagram.vertex_pulls.begin();
  for (std::size_t v = 0; v < found.motions.size(); ++v) {
    VertexMotion& motion = found.motions[v];
    const auto count = static_cast<std::ptrdiff_t>(found.diagram.vertices[v].sites.size());
    motion.pulls.assign(next, next + count);
    next += count;
    solve_motion(motion);
  }
}

}  // namespace

std::vector<TangentGeodesic> measure_edges(const surface::GeodesicSolver& solver, const Diagram& diagram,
                                           std::vector<std::int32_t>& edges, const Execution& execution) {
  edges.clear();
  std::vector<surface::PointPair> pairs;
  const auto point_of = [&](std::int32_t vertex) {
    return diagram.points[static_cast<std::size_t>(diagram.vertices[static_cast<std::size_t>(vertex)].point)].point;
  };
  for (std::size_t e = 0; e < diagram.edges.size(); ++e) {
    const auto& [a, b] = diagram.edges[e].vertices;
    if (a < 0 || b < 0 || a == b) continue;
    edges.push_back(static_cast<std::int32_t>(e));
    pairs.push_back({point_of(a), point_of(b), nullptr});
  }
  std::vector<TangentGeodesic> lengths(pairs.size());
  solver.tangent_geodesics(pairs, lengths, false, unbilled(execution));
  return lengths;
}

void DiagramFinder::find(SitesState& state, int order, const Execution& execution) const {
  std::shared_ptr<Found> found = state.found();
  if (!found) {
    found = std::make_shared<Found>();
    Execution own = execution;
    own.progress = nullptr;
    moving_.move_to(state.sites().points(), own);
    found->diagram = moving_.take_diagram();
    const StageTimer timer(execution.cost, "derivatives");
    if (needs_.edge_lengths)
      found->edge_lengths = measure_edges(solver_, found->diagram, found->measured_edges, execution);
    state.set_found(found);
  }
  if (order < 1 || !needs_.motions || found->motions.size() == found->diagram.vertices.size()) return;
  const StageTimer timer(execution.cost, "derivatives");
  find_motions(solver_, state.sites(), *found, execution);
}

}  // namespace supple::voronoi
