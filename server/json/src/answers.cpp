#include "supple/json/answers.h"

#include <algorithm>
#include <cmath>

#include "answer_parts.h"

namespace supple::json {
namespace {

using surface::SurfacePoint;
using surface::TriangleMesh;

/// A competing path that is longer by less than this, relative, puts a point near the cut locus.
constexpr double near_cut_locus = 1e-6;

void write_frame(JsonWriter& out, const TriangleMesh& mesh, FaceId face) {
  const auto frame = surface::tangent_frame(mesh, face);
  out.begin_object().field("face", index(face)).key("axes").begin_array();
  out.numbers(frame.col(0).eval()).numbers(frame.col(1).eval()).end_array().end_object();
}

void write_field_accuracy(JsonWriter& out, surface::FieldMethod method, double allowed, double bound) {
  out.key("accuracy").begin_object();
  out.field("method", field_method_names.name_of(method));
  out.field("relative_error", allowed);
  write_number_or_null(out, "relative_error_bound", bound);
  out.end_object();
}

void write_derivatives(JsonWriter& out, const GeodesicsRequest& request, const TriangleMesh& mesh,
                       const std::pair<SurfacePoint, SurfacePoint>& ends, const surface::Geodesic& geodesic) {
  out.field("differentiable", geodesic.derivatives.has_value());
  if (!geodesic.derivatives) return;
  const auto& derivatives = *geodesic.derivatives;
  out.key("gradient").begin_object();
  out.key("barycentric").numbers(derivatives.gradient).key("tangent").numbers(derivatives.tangent_gradient);
  out.end_object();
  if (request.derivatives == 2) {
    out.key("hessian").begin_object().key("barycentric");
    write_rows(out, derivatives.hessian);
    out.key("tangent");
    write_rows(out, derivatives.tangent_hessian);
    out.end_object();
  }
  out.key("frames").begin_object().key("from");
  write_frame(out, mesh, ends.first.face);
  out.key("to");
  write_frame(out, mesh, ends.second.face);
  out.end_object();
}

void write_geodesic(JsonWriter& out, const GeodesicsRequest& request, const TriangleMesh& mesh,
                    const std::pair<SurfacePoint, SurfacePoint>& ends, const surface::Geodesic& geodesic) {
  out.begin_object().key("distance");
  if (geodesic.unreachable) {
    out.null().field("unreachable", true).end_object();
    return;
  }
  const double excess = geodesic.competing_excess;
  out.number(geodesic.distance).field("unreachable", false).field("unique", geodesic.unique);
  out.field("near_cut_locus", excess <= near_cut_locus * geodesic.distance);
  if (std::isfinite(excess)) out.field("competing_excess", std::max(excess, 0.0));
  out.key("pinned_at").begin_array();
  for (const auto vertex : geodesic.pinned_at) out.integer(index(vertex));
  out.end_array();
  if (geodesic.mollified_distance) out.field("mollified_distance", *geodesic.mollified_distance);
  if (request.derivatives > 0) write_derivatives(out, request, mesh, ends, geodesic);
  if (request.paths) {
    out.key("path");
    write_path(out, geodesic.path);
  }
  out.end_object();
}

}  // namespace

std::string write_geodesics(const GeodesicsRequest& request, const TriangleMesh& mesh,
                            const std::vector<std::pair<SurfacePoint, SurfacePoint>>& ends,
                            const std::vector<surface::Geodesic>& results, const Bill& bill) {
  JsonWriter out;
  out.begin_object().field("mesh", request.mesh).key("results").begin_array();
  for (std::size_t i = 0; i < results.size(); ++i) write_geodesic(out, request, mesh, ends[i], results[i]);
  out.end_array();
  write_field_accuracy(out, surface::FieldMethod::windows, 0, 0);
  write_points_in_space(out, request.points_in_space);
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

std::string write_geodesic_field(const GeodesicFieldRequest& request, const surface::GeodesicField& field,
                                 const Bill& bill) {
  const auto& distances = field.vertex_distances();
  JsonWriter out;
  out.begin_object().field("mesh", request.mesh).field("vertices", distances.size()).key("distances").begin_array();
  std::int64_t unreached = 0;
  for (const double distance : distances) {
    if (std::isinf(distance)) {
      out.null();
      ++unreached;
    } else {
      out.number(distance);
    }
  }
  out.end_array().field("unreached", unreached);
  write_field_accuracy(out, request.method, request.relative_error, field.relative_error_bound());
  write_points_in_space(out, request.points_in_space);
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

std::string write_karcher_mean(const KarcherMeanRequest& request, const TriangleMesh& mesh,
                               const surface::KarcherMean& mean, const Bill& bill) {
  JsonWriter out;
  out.begin_object().field("mesh", request.mesh).key("mean");
  write_point(out, mean.mean);
  out.key("position").numbers(mean.position);
  out.field("objective", mean.objective)
      .field("gradient_norm", mean.gradient_norm)
      .field("iterations", mean.iterations)
      .field("start", mean.start)
      .key("history")
      .begin_array();
  for (const auto& step : mean.history) {
    out.begin_object()
        .field("objective", step.objective)
        .field("gradient_norm", step.gradient_norm)
        .field("step_length", step.step_length)
        .field("regularization", step.regularization)
        .end_object();
  }
  out.end_array().field("stopped", surface::to_string(mean.stopped));
  out.key("accuracy")
      .begin_object()
      .field("tolerance", request.tolerance)
      .field("gradient_tolerance", request.tolerance * mesh.diagonal())
      .field("gradient_norm", mean.gradient_norm)
      .end_object();
  write_points_in_space(out, request.points_in_space);
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

std::string write_exponential_map(const ExponentialMapRequest& request, const TriangleMesh& mesh,
                                  const surface::ExponentialMap& map, double requested_length, const Bill& bill) {
  JsonWriter out;
  out.begin_object().field("mesh", request.mesh).key("end");
  write_point(out, map.end);
  out.key("position").numbers(surface::position(mesh, map.end));
  out.key("end_direction").numbers(map.end_direction);
  out.field("length", map.length)
      .field("reached_boundary", map.reached_boundary)
      .field("transport_angle", map.transport_angle);
  if (request.trace) {
    out.key("trace");
    write_path(out, map.trace);
  }
  out.key("accuracy").begin_object().field("method", "straightest").field("requested_length", requested_length);
  out.end_object();
  write_points_in_space(out, request.points_in_space);
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

}  // namespace supple::json
