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

void find_motions(const surface::GeodesicSolver& solver, const surface::MovingPoints& sites, Found& found,
                  const Execution& execution) {
  std::vector<surface::SurfacePoint> places;
  std::vector<std::int32_t> of_sites;
  for (const DiagramVertex& vertex : found.diagram.vertices) {
    for (const std::int32_t site : vertex.sites) {
      places.push_back(found.diagram.points[static_cast<std::size_t>(vertex.point)].point);
      of_sites.push_back(site);
    }
  }
  const std::vector<SitePull> pulls = site_pulls(solver, sites, places, of_sites, execution);
  found.motions.resize(found.diagram.vertices.size());
  std::size_t next = 0;
  for (std::size_t v = 0; v < found.motions.size(); ++v) {
    VertexMotion& motion = found.motions[v];
    for (std::size_t k = 0; k < found.diagram.vertices[v].sites.size(); ++k) motion.pulls.push_back(pulls[next++]);
    solve_motion(motion);
  }
}

void find_border_pulls(const surface::GeodesicSolver& solver, const surface::MovingPoints& sites, Found& found,
                       const Execution& execution) {
  std::vector<surface::SurfacePoint> places;
  std::vector<std::int32_t> of_sites;
  for (const BorderSample& sample : found.diagram.border_samples) {
    for (const std::int32_t site : sample.sites) {
      places.push_back(sample.point);
      of_sites.push_back(site);
    }
  }
  found.border_pulls = site_pulls(solver, sites, places, of_sites, execution);
}

/// What the diagram knows already, but for sites on vertices, whose coordinates are those of the cone.
void find_cell_pulls(const surface::GeodesicSolver& solver, const surface::MovingPoints& sites, Found& found,
                     const Execution& execution) {
  std::vector<surface::SurfacePoint> places;
  std::vector<std::int32_t> of_sites;
  std::vector<std::size_t> numbers;
  found.cell_pulls.clear();
  for (const CellSample& sample : found.diagram.cell_samples) {
    if (sites.on_tip(static_cast<std::size_t>(sample.site))) {
      numbers.push_back(found.cell_pulls.size());
      places.push_back(sample.point);
      of_sites.push_back(sample.site);
    }
    found.cell_pulls.push_back({sample.site, sample.distance, Vector2d::Zero(), sample.by_site});
  }
  const std::vector<SitePull> pulls = site_pulls(solver, sites, places, of_sites, execution);
  for (std::size_t i = 0; i < numbers.size(); ++i) found.cell_pulls[numbers[i]] = pulls[i];
}

}  // namespace

std::vector<SitePull> site_pulls(const surface::GeodesicSolver& solver, const surface::MovingPoints& sites,
                                 const std::vector<surface::SurfacePoint>& places,
                                 const std::vector<std::int32_t>& of_sites, const Execution& execution) {
  std::vector<surface::PointPair> pairs;
  pairs.reserve(places.size());
  for (std::size_t i = 0; i < places.size(); ++i)
    pairs.push_back({places[i], sites.points()[static_cast<std::size_t>(of_sites[i])], nullptr});
  std::vector<TangentGeodesic> geodesics(pairs.size());
  solver.tangent_geodesics(pairs, geodesics, false, unbilled(execution));
  std::vector<SitePull> pulls;
  pulls.reserve(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i)
    pulls.push_back({of_sites[i], geodesics[i].distance, -geodesics[i].from_direction,
                     gradient_at(sites, solver.mesh(), of_sites[i], geodesics[i])});
  return pulls;
}

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
    if (needs_.cell_samples) find_cell_pulls(solver_, state.sites(), *found, execution);
    state.set_found(found);
  }
  if (order < 1 || (found->motions.size() == found->diagram.vertices.size() &&
                    (!needs_.border_pulls || found->border_pulls.size() == 2 * found->diagram.border_samples.size())))
    return;
  const StageTimer timer(execution.cost, "derivatives");
  if (found->motions.size() != found->diagram.vertices.size()) find_motions(solver_, state.sites(), *found, execution);
  if (needs_.border_pulls) find_border_pulls(solver_, state.sites(), *found, execution);
}

}  // namespace supple::voronoi
