#pragma once

#include <string>

#include "supple/json/answers.h"
#include "supple/json/voronoi_requests.h"

/// The answers of Voronoi diagrams as JSON text; they throw what those of answers.h throw, and
/// "request.limit_exceeded" where the borders have more points than limits.max_border_points, or the pieces that are
/// asked for more corners than limits.max_piece_corners.
namespace supple::json {

/// `statistics` may be null: then there are none in the answer.
std::string write_voronoi_diagram(const VoronoiDiagramRequest& request, const surface::TriangleMesh& mesh,
                                  const voronoi::Diagram& diagram, const voronoi::DiagramStatistics* statistics,
                                  const Bill& bill, const Limits& limits);

std::string write_voronoi_optimization(const VoronoiOptimizationRequest& request, const surface::TriangleMesh& mesh,
                                       const voronoi::Optimization& optimization, const Bill& bill,
                                       const Limits& limits);

/// Limits for the sites and the border points in an intermediate result: those of larger diagrams are left out.
inline constexpr std::size_t max_partial_sites = 5000;
inline constexpr std::size_t max_partial_border_points = 20'000;

/// The diagram after an iteration. Its borders are straight within a face.
std::string write_partial_optimization(int iteration, const voronoi::OptimizationStep& step,
                                       const surface::TriangleMesh& mesh, const voronoi::Diagram& diagram);

}  // namespace supple::json
