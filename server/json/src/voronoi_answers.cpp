#include "supple/json/voronoi_answers.h"

#include <algorithm>
#include <string_view>

#include "answer_parts.h"

namespace supple::json {
namespace {

using voronoi::Diagram;
using voronoi::DiagramStatistics;

void write_index_or_null(JsonWriter& out, std::int32_t index) { index < 0 ? out.null() : out.integer(index); }

void write_indices_or_null(JsonWriter& out, std::string_view name, std::span<const std::int32_t> indices) {
  out.key(name).begin_array();
  for (const auto index : indices) write_index_or_null(out, index);
  out.end_array();
}

void write_spread(JsonWriter& out, std::string_view name, const DiagramStatistics::Spread& spread) {
  out.key(name).begin_object();
  out.field("mean", spread.mean)
      .field("least", spread.least)
      .field("greatest", spread.greatest)
      .field("deviation", spread.deviation)
      .end_object();
}

void write_statistics(JsonWriter& out, std::string_view name, const DiagramStatistics& statistics) {
  out.key(name).begin_object();
  write_spread(out, "edge_length", statistics.edge_length);
  write_spread(out, "planarity", statistics.planarity);
  write_spread(out, "area", statistics.area);
  write_spread(out, "vertex_distance", statistics.vertex_distance);
  out.end_object();
}

void write_cells(JsonWriter& out, const Diagram& diagram) {
  out.key("cells").begin_array();
  for (std::size_t i = 0; i < diagram.cells.size(); ++i) {
    const auto& cell = diagram.cells[i];
    out.begin_object().field("site", i).field("area", cell.area).key("boundary").begin_array();
    for (const auto& border : cell.boundary) write_indices(out, border);
    out.end_array();
    write_indices(out.key("neighbours"), cell.neighbours);
    out.end_object();
  }
  out.end_array();
}

void write_voronoi_vertices(JsonWriter& out, const Diagram& diagram) {
  out.key("vertices").begin_array();
  for (const auto& vertex : diagram.vertices) {
    const auto& point = diagram.points[static_cast<std::size_t>(vertex.point)];
    out.begin_object().key("point");
    write_point(out, point.point);
    out.key("position").numbers(point.position);
    write_indices(out.key("sites"), vertex.sites);
    out.field("distance", point.distance).field("index", vertex.point).end_object();
  }
  out.end_array();
}

void write_voronoi_edges(JsonWriter& out, const Diagram& diagram) {
  out.key("edges").begin_array();
  for (const auto& edge : diagram.edges) {
    write_indices(out.begin_object().key("sites"), edge.sites);
    write_indices_or_null(out, "vertices", edge.vertices);
    write_indices(out.field("length", edge.length).key("points"), edge.points);
    out.end_object();
  }
  out.end_array();
}

void write_border_positions(JsonWriter& out, const Diagram& diagram) {
  out.key("positions").begin_array();
  for (const auto& point : diagram.points) out.numbers(point.position);
  out.end_array();
}

void write_pieces(JsonWriter& out, const surface::TriangleMesh& mesh, const Diagram& diagram) {
  out.key("pieces").begin_object();
  write_indices_or_null(out, "vertex_sites", diagram.vertex_sites);
  write_indices_or_null(out, "face_sites", diagram.face_sites);
  out.key("cut_faces").begin_array();
  for (const auto& piece : diagram.pieces) {
    out.begin_object()
        .field("site", piece.site)
        .field("face", piece.face)
        .field("area", piece.area)
        .key("corners")
        .begin_array();
    for (std::int32_t k = 0; k < piece.corner_count; ++k) {
      const auto& corner = diagram.corners[static_cast<std::size_t>(piece.first_corner) + static_cast<std::size_t>(k)];
      out.numbers(surface::position(mesh, {FaceId{piece.face}, corner}));
    }
    out.end_array().end_object();
  }
  out.end_array().end_object();
}

/// Writes what the answers have in common, up to the area without a site.
void write_diagram(JsonWriter& out, const std::string& mesh_id, const surface::TriangleMesh& mesh,
                   const Diagram& diagram, const DiagramInclude& include, const Limits& limits) {
  const auto check = [](std::string_view what, std::size_t count, std::size_t limit, const char* field) {
    if (count > limit) {
      problem::throw_limit("request.limit_exceeded", std::string(what), static_cast<double>(limit),
                           static_cast<double>(count), "", field);
    }
  };
  check("The number of points of the cells' borders", diagram.points.size(), limits.max_border_points, "/sites");
  if (include.pieces)
    check("The number of corners of the pieces of cut faces", diagram.corners.size(), limits.max_piece_corners,
          "/pieces");
  out.field("mesh", mesh_id).key("sites").begin_array();
  for (const auto& site : diagram.sites) write_point(out, site);
  out.end_array();
  write_positions(out, "site_positions", mesh, diagram.sites);
  write_cells(out, diagram);
  write_voronoi_vertices(out, diagram);
  write_voronoi_edges(out, diagram);
  out.key("dual").begin_array();
  for (const auto& triangle : diagram.dual) write_indices(out, triangle);
  out.end_array();
  write_border_positions(out, diagram);
  if (include.points) {
    out.key("points").begin_array();
    for (const auto& point : diagram.points) write_point(out, point.point);
    out.end_array();
  }
  if (include.pieces) write_pieces(out, mesh, diagram);
  out.field("unreached_area", diagram.unreached_area);
}

/// The borders of an intermediate result, which are straight within a face.
class SimplifiedBorders {
 public:
  explicit SimplifiedBorders(const Diagram& diagram) : indices_(diagram.points.size(), -1) {
    for (const auto& edge : diagram.edges) {
      auto& line = lines_.emplace_back();
      const auto is_inner = [&](std::int32_t point) {
        return diagram.points[static_cast<std::size_t>(point)].kind == voronoi::DiagramPoint::Kind::inner;
      };
      // A closed border with fewer than four points on edges lies within a face: all of its points are written.
      const auto inner = std::count_if(edge.points.begin(), edge.points.end(), is_inner);
      const bool keeps_all_points = edge.points.front() == edge.points.back() && inner + 4 > std::ssize(edge.points);
      for (std::size_t k = 0; k < edge.points.size(); ++k) {
        const bool is_end = k == 0 || k + 1 == edge.points.size();
        if (keeps_all_points || is_end || !is_inner(edge.points[k])) line.push_back(index_of(edge.points[k]));
      }
    }
  }

  /// "positions", "vertices" and "borders".
  void write(JsonWriter& out, const Diagram& diagram) const {
    out.key("positions").begin_array();
    for (const auto point : points) out.numbers(diagram.points[static_cast<std::size_t>(point)].position);
    out.end_array().key("vertices").begin_array();
    for (const auto& vertex : diagram.vertices)
      if (const auto index = indices_[static_cast<std::size_t>(vertex.point)]; index >= 0) out.integer(index);
    out.end_array().key("borders").begin_array();
    for (const auto& line : lines_) write_indices(out, line);
    out.end_array();
  }

  std::vector<std::int32_t> points;  ///< the diagram's points that are written, in their order

 private:
  std::int32_t index_of(std::int32_t point) {
    auto& found = indices_[static_cast<std::size_t>(point)];
    if (found < 0) {
      found = static_cast<std::int32_t>(points.size());
      points.push_back(point);
    }
    return found;
  }

  std::vector<std::int32_t> indices_;
  std::vector<std::vector<std::int32_t>> lines_;
};

void write_diagram_accuracy(JsonWriter& out, const voronoi::DiagramOptions& options) {
  using Method = voronoi::DiagramMethod;
  const double error = options.method == Method::bounded ? options.relative_error : 0;
  out.key("accuracy").begin_object().field("method", diagram_method_names.name_of(options.method));
  out.field("relative_error", error).key("relative_error_bound");
  options.method == Method::edges ? out.null() : out.number(error);
  out.field("border_deviation", options.border_deviation).end_object();
}

void write_optimization_history(JsonWriter& out, const std::vector<voronoi::OptimizationStep>& history) {
  out.key("history").begin_array();
  for (const auto& step : history) {
    out.begin_object()
        .field("energy", step.energy)
        .field("gradient_norm", step.gradient_norm)
        .field("step_length", step.step_length)
        .end_object();
  }
  out.end_array();
}

void write_site_moves(JsonWriter& out, const voronoi::SiteMoveTrials& moves) {
  out.key("site_moves")
      .begin_object()
      .field("held_searches", moves.held_searches)
      .field("passes", moves.passes)
      .field("tried", moves.tried)
      .field("taken", moves.taken)
      .field("energy_before", moves.energy_before)
      .field("last_gain", moves.last_gain)
      .end_object();
}

}  // namespace

std::string write_voronoi_diagram(const VoronoiDiagramRequest& request, const surface::TriangleMesh& mesh,
                                  const Diagram& diagram, const DiagramStatistics* statistics, const Bill& bill,
                                  const Limits& limits) {
  JsonWriter out;
  out.begin_object();
  write_diagram(out, request.mesh, mesh, diagram, request.include, limits);
  if (statistics) write_statistics(out, "statistics", *statistics);
  write_warnings(out, diagram.warnings);
  write_diagram_accuracy(out, request.options);
  write_points_in_space(out, request.points_in_space);
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

std::string write_voronoi_optimization(const VoronoiOptimizationRequest& request, const surface::TriangleMesh& mesh,
                                       const voronoi::Optimization& optimization, const Bill& bill,
                                       const Limits& limits) {
  JsonWriter out;
  out.begin_object();
  write_diagram(out, request.mesh, mesh, optimization.diagram, request.include, limits);
  out.field("energy", optimization.energy).key("terms").begin_array();
  for (const auto& term : optimization.terms)
    out.begin_object().field("name", term.name).field("energy", term.energy).end_object();
  out.end_array();
  out.field("gradient_norm", optimization.gradient_norm).field("iterations", optimization.iterations);
  write_optimization_history(out, optimization.history);
  out.field("stopped", voronoi::to_string(optimization.stopped));
  if (optimization.site_moves.held_searches > 0) write_site_moves(out, optimization.site_moves);
  out.key("statistics").begin_object();
  write_statistics(out, "before", optimization.before);
  write_statistics(out, "after", optimization.after);
  out.end_object();
  write_warnings(out, optimization.diagram.warnings);
  out.key("accuracy")
      .begin_object()
      .field("tolerance", request.options.tolerance)
      .field("gradient_tolerance", optimization.gradient_tolerance)
      .field("gradient_norm", optimization.gradient_norm)
      .field("border_deviation", request.options.border_deviation)
      .end_object();
  write_points_in_space(out, request.points_in_space);
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

std::string write_partial_optimization(int iteration, const voronoi::OptimizationStep& step,
                                       const surface::TriangleMesh& mesh, const Diagram& diagram) {
  JsonWriter out;
  out.begin_object()
      .field("iteration", iteration)
      .field("energy", step.energy)
      .field("gradient_norm", step.gradient_norm)
      .field("step_length", step.step_length);
  if (diagram.sites.size() <= max_partial_sites) {
    out.key("sites").begin_array();
    for (const auto& site : diagram.sites) write_point(out, site);
    out.end_array();
    write_positions(out, "site_positions", mesh, diagram.sites);
  }
  const SimplifiedBorders borders(diagram);
  if (borders.points.size() <= max_partial_border_points) borders.write(out, diagram);
  out.end_object();
  return out.take();
}

}  // namespace supple::json
