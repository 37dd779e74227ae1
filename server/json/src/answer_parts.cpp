#include "answer_parts.h"

#include <cmath>

namespace supple::json {

void write_bill(JsonWriter& out, const Bill& bill) {
  out.key("effects").begin_array();
  for (const auto& effect : bill.ledger.effects()) {
    out.begin_object()
        .field("name", effect.name)
        .field("ran", effect.ran)
        .field("why", effect.why)
        .field("count", effect.count)
        .field("seconds", effect.seconds)
        .end_object();
  }
  out.end_array();
  out.key("cost").begin_object().field("seconds", bill.seconds).key("stages").begin_array();
  for (const auto& stage : bill.ledger.stages()) {
    out.begin_object()
        .field("name", stage.name)
        .field("seconds", stage.seconds)
        .field("count", stage.count)
        .end_object();
  }
  out.end_array().key("quantities").begin_object();
  for (const auto& quantity : bill.ledger.quantities()) out.field(quantity.name, quantity.value);
  out.end_object().end_object();
}

void write_point(JsonWriter& out, const surface::SurfacePoint& point) {
  out.begin_object().field("face", index(point.face)).key("barycentric").numbers(point.barycentric).end_object();
}

void write_points_in_space(JsonWriter& out, std::span<const PlacedPoint> points) {
  if (points.empty()) return;
  out.key("points_in_space").begin_array();
  for (const auto& [pointer, nearest] : points) {
    out.begin_object().field("pointer", pointer).field("face", index(nearest.point.face));
    out.key("barycentric").numbers(nearest.point.barycentric);
    out.key("position").numbers(nearest.position);
    out.field("distance", nearest.distance).end_object();
  }
  out.end_array();
}

void write_positions(JsonWriter& out, std::string_view name, const surface::TriangleMesh& mesh,
                     std::span<const surface::SurfacePoint> points) {
  out.key(name).begin_array();
  for (const auto& point : points) out.numbers(surface::position(mesh, point));
  out.end_array();
}

void write_indices(JsonWriter& out, std::span<const std::int32_t> indices) {
  out.begin_array();
  for (const auto i : indices) out.integer(i);
  out.end_array();
}

void write_warnings(JsonWriter& out, std::span<const std::string> warnings) {
  out.key("warnings").begin_array();
  for (const auto& warning : warnings) out.string(warning);
  out.end_array();
}

void write_path(JsonWriter& out, const std::vector<surface::PathPoint>& path) {
  out.begin_array();
  for (const auto& point : path) {
    out.begin_object().field("face", index(point.point.face));
    out.key("barycentric").numbers(point.point.barycentric);
    out.key("position").numbers(point.position);
    if (point.vertex != VertexId::none) out.field("vertex", index(point.vertex));
    out.end_object();
  }
  out.end_array();
}

void write_number_or_null(JsonWriter& out, double value) { std::isfinite(value) ? out.number(value) : out.null(); }

void write_number_or_null(JsonWriter& out, std::string_view name, double value) {
  write_number_or_null(out.key(name), value);
}

}  // namespace supple::json
