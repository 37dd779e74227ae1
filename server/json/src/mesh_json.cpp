#include "supple/json/answers.h"
#include "supple/json/json_writer.h"

namespace supple::json {
namespace {

void write_repair(JsonWriter& out, const surface::RepairOutcome& repair) {
  out.begin_object().key("made").begin_array();
  for (const auto& [kind, name] : repair_names)
    if (repair.made(kind)) out.string(name);
  out.end_array()
      .field("welded_vertices", repair.welded_vertices)
      .field("weld_distance", repair.weld_distance)
      .field("dropped_degenerate_faces", repair.dropped_degenerate_faces)
      .field("dropped_duplicate_faces", repair.dropped_duplicate_faces)
      .field("split_edges", repair.split_edges)
      .field("split_vertices", repair.split_vertices)
      .field("removed_vertices", repair.removed_vertices);
  out.key("vertices").begin_array();
  for (std::size_t v = 0; v + 1 < repair.vertex_starts.size(); ++v) {
    const auto vertices = repair.vertices_of(v);
    if (vertices.empty()) {
      out.null();
    } else if (vertices.size() == 1) {
      out.integer(vertices[0]);
    } else {
      out.begin_array();
      for (const auto vertex : vertices) out.integer(vertex);
      out.end_array();
    }
  }
  out.end_array().key("faces").begin_array();
  for (const auto face : repair.new_faces) face < 0 ? out.null() : out.integer(face);
  out.end_array().end_object();
}

}  // namespace

std::string write_mesh(const std::string& id, std::int64_t created, const surface::MeshReport& report,
                       const surface::RepairOutcome* repair) {
  JsonWriter out;
  out.begin_object()
      .field("id", id)
      .field("created", time_text(created))
      .field("vertices", report.vertices)
      .field("faces", report.faces)
      .field("edges", report.edges)
      .field("components", report.components)
      .field("boundary_loops", report.boundary_loops)
      .field("genus", report.genus)
      .field("saddle_vertices", report.saddle_vertices);
  out.key("bounding_box").begin_object().key("lower").numbers(report.lower).key("upper").numbers(report.upper);
  out.field("diagonal", (report.upper - report.lower).norm()).end_object();
  out.field("area", report.area);
  out.key("edge_length")
      .begin_object()
      .field("min", report.edge_min)
      .field("mean", report.edge_mean)
      .field("max", report.edge_max)
      .end_object();
  out.key("angle").begin_object().field("min", report.smallest_angle).field("max", report.largest_angle).end_object();
  out.key("warnings").begin_array();
  for (const auto& warning : report.warnings) out.string(warning);
  out.end_array();
  if (repair) write_repair(out.key("repair"), *repair);
  out.end_object();
  return out.take();
}

}  // namespace supple::json
