#include "supple/json/answers.h"
#include "supple/json/json_writer.h"

namespace supple::json {

std::string write_mesh(const std::string& id, std::int64_t created, const surface::MeshReport& report) {
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
  out.end_array().end_object();
  return out.take();
}

}  // namespace supple::json
