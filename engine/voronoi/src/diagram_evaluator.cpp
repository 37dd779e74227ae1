#include "diagram_evaluator.h"

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

/// The gradient of the geodesic's length by the tangent coordinates of the site at its end.
Vector2d gradient_at(const surface::MovingPoints& sites, const surface::TriangleMesh& mesh, std::int32_t site,
                     const TangentGeodesic& geodesic) {
  if (!sites.on_tip(static_cast<std::size_t>(site))) return geodesic.to_direction;
  if (!std::isfinite(geodesic.to_angle)) return Vector2d::Zero();
  const surface::VertexCone cone(mesh, sites.vertex_of(mesh, static_cast<std::size_t>(site)));
  return -surface::cone_coordinates(cone, geodesic.to_angle);
}

/// Computes the directions of a motion. The distances from sites 0 and k stay equal if the vertex moves by dx and the
/// sites by ds: (g0 - gk) . dx + p0 . ds0 - pk . dsk = 0, g the gradients by the point and p those by the site. For
/// more than three sites this is solved by least squares.
void solve_motion(VertexMotion& motion) {
  const auto count = motion.gradients.size();
  motion.directions.assign(count, Vector2d::Zero());
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  for (std::size_t k = 1; k < count; ++k) {
    const Vector2d row = motion.gradients[0].by_place - motion.gradients[k].by_place;
    normal += row * row.transpose();
  }
  const double determinant = normal.determinant();
  // All sites lie nearly in one direction: the vertex would move without bound, and its motion is left at zero.
  if (!(determinant > 1e-24 * normal.squaredNorm())) return;
  const Eigen::Matrix2d inverse = normal.inverse();
  for (std::size_t k = 1; k < count; ++k) {
    motion.directions[k] = inverse * (motion.gradients[0].by_place - motion.gradients[k].by_place);
    motion.directions[0] -= motion.directions[k];
  }
}

/// Computes the distance gradients that the diagram lacks, which are those of merged Voronoi vertices, by one geodesic
/// each.
void compute_missing_gradients(const surface::GeodesicSolver& solver, const surface::MovingPoints& sites,
                               DiagramEvaluation& evaluation, const Execution& execution) {
  std::vector<surface::PointPair> pairs;
  std::vector<SiteDistanceGradient*> missing;
  std::size_t next = 0;
  for (const DiagramVertex& vertex : evaluation.diagram.vertices) {
    for (const std::int32_t site : vertex.sites) {
      SiteDistanceGradient& gradient = evaluation.diagram.vertex_gradients[next++];
      if (gradient.site >= 0) continue;
      gradient.site = site;
      missing.push_back(&gradient);
      pairs.push_back({evaluation.diagram.points[static_cast<std::size_t>(vertex.point)].point,
                       sites.points()[static_cast<std::size_t>(site)], nullptr});
    }
  }
  if (pairs.empty()) return;
  std::vector<TangentGeodesic> geodesics(pairs.size());
  solver.tangent_geodesics(pairs, geodesics, false, unbilled(execution));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    SiteDistanceGradient& gradient = *missing[i];
    gradient = {gradient.site, geodesics[i].distance, -geodesics[i].from_direction,
                gradient_at(sites, solver.mesh(), gradient.site, geodesics[i])};
  }
}

void compute_motions(const surface::GeodesicSolver& solver, const surface::MovingPoints& sites,
                     DiagramEvaluation& evaluation, const Execution& execution) {
  compute_missing_gradients(solver, sites, evaluation, execution);
  evaluation.motions.resize(evaluation.diagram.vertices.size());
  auto next = evaluation.diagram.vertex_gradients.begin();
  for (std::size_t v = 0; v < evaluation.motions.size(); ++v) {
    VertexMotion& motion = evaluation.motions[v];
    const auto count = static_cast<std::ptrdiff_t>(evaluation.diagram.vertices[v].sites.size());
    motion.gradients.assign(next, next + count);
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

void DiagramEvaluator::evaluate(SitesState& state, int order, const Execution& execution) const {
  std::shared_ptr<DiagramEvaluation> evaluation = state.evaluation();
  if (!evaluation) {
    evaluation = std::make_shared<DiagramEvaluation>();
    Execution unreported = execution;
    unreported.progress = nullptr;
    moving_.move_to(state.sites().points(), unreported);
    evaluation->diagram = moving_.take_diagram();
    const StageTimer timer(execution.cost, "derivatives");
    if (required_.edge_lengths)
      evaluation->edge_lengths = measure_edges(solver_, evaluation->diagram, evaluation->measured_edges, execution);
    state.set_evaluation(evaluation);
  }
  if (order < 1 || !required_.motions || evaluation->motions.size() == evaluation->diagram.vertices.size()) return;
  const StageTimer timer(execution.cost, "derivatives");
  compute_motions(solver_, state.sites(), *evaluation, execution);
}

}  // namespace supple::voronoi
