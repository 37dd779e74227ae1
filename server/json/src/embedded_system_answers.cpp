#include "supple/json/embedded_system_answers.h"

#include <algorithm>

#include "answer_parts.h"

namespace supple::json {
namespace {

void write_spring_state(JsonWriter& out, const embedded::Spring& spring, const embedded::SpringState& state,
                        bool with_path) {
  out.begin_object().key("between").begin_array().integer(spring.from).integer(spring.to).end_array();
  out.field("length", state.length)
      .field("energy", state.energy)
      .field("compressed", state.compressed)
      .field("at_cut_locus", state.at_cut_locus);
  if (with_path) {
    out.key("path");
    write_path(out, state.path);
  }
  out.end_object();
}

void write_relaxation_history(JsonWriter& out, const std::vector<embedded::RelaxationStep>& history) {
  out.key("history").begin_array();
  for (const auto& step : history) {
    out.begin_object()
        .field("energy", step.energy)
        .field("gradient_norm", step.gradient_norm)
        .field("step_length", step.step_length)
        .field("regularization", step.regularization)
        .end_object();
  }
  out.end_array();
}

void write_terms(JsonWriter& out, const embedded::RelaxationOptions& options, const embedded::Network& network,
                 const embedded::Relaxation& relaxation) {
  const double network_energy = relaxation.network_energy;
  double membrane = 0;
  for (const auto& triangle : relaxation.triangles) membrane += triangle.energy;
  out.field("energy", relaxation.energy).key("terms").begin_array();
  const auto write = [&](std::string_view name, double energy) {
    out.begin_object().field("name", name).field("energy", energy).end_object();
  };
  const bool geodesic = options.spring_length == embedded::SpringLength::geodesic;
  // Without triangles, all energy of the network is that of its springs, even if it has none.
  if (relaxation.triangles.empty() || !network.springs.empty())
    write(geodesic ? "geodesic_springs" : "euclidean_springs", std::max(0.0, network_energy - membrane));
  if (!relaxation.triangles.empty()) write("membrane", network.springs.empty() ? network_energy : membrane);
  for (const auto& term : relaxation.host.terms) write(term.name, term.energy);
  out.end_array();
}

void write_vertices(JsonWriter& out, std::span<const Eigen::Vector3d> vertices) {
  out.key("vertices").begin_array();
  for (const auto& vertex : vertices) out.numbers(vertex);
  out.end_array();
}

void write_host(JsonWriter& out, const embedded::Relaxation& relaxation) {
  const embedded::HostState& host = relaxation.host;
  if (host.vertices.empty()) return;
  out.key("host").begin_object();
  write_vertices(out, host.vertices);
  out.field("largest_displacement", host.largest_displacement);
  if (host.volume_ratio != 0) out.field("volume_ratio", host.volume_ratio);
  if (!host.tetrahedra.empty())
    out.field("tetrahedra", host.tetrahedra.size()).field("nodes", host.vertices.size() + host.inside.size());
  if (!relaxation.stops.empty()) {
    out.key("stops").begin_array();
    for (const auto& stop : relaxation.stops)
      out.begin_object()
          .field("energy", stop.energy)
          .field("gradient_norm", stop.gradient_norm)
          .field("iterations", stop.iterations)
          .field("load_steps", stop.load_steps)
          .field("jumps", stop.jumps)
          .field("stopped", embedded::to_string(stop.stopped))
          .field("reached", stop.reached)
          .end_object();
    out.end_array();
  }
  out.end_object();
}

}  // namespace

std::string write_embedded_system(const EmbeddedSystemRequest& request, const surface::TriangleMesh& mesh,
                                  const embedded::Network& network, const embedded::Relaxation& relaxation,
                                  const std::vector<std::array<std::int32_t, 3>>* triangles, const Bill& bill) {
  const auto& options = request.options;
  JsonWriter out;
  out.begin_object().field("mesh", request.mesh).key("points").begin_array();
  for (const auto& point : relaxation.points) write_point(out, point);
  out.end_array();
  write_positions(out, "positions", mesh, relaxation.points);
  out.key("springs").begin_array();
  for (std::size_t i = 0; i < relaxation.springs.size(); ++i)
    write_spring_state(out, network.springs[i], relaxation.springs[i], options.paths);
  out.end_array();
  if (triangles) {
    out.key("triangles").begin_array();
    for (const auto& corners : *triangles) write_indices(out, corners);
    out.end_array();
  }
  if (!relaxation.triangles.empty()) {
    out.key("membrane").begin_array();
    for (const auto& triangle : relaxation.triangles)
      out.begin_object()
          .field("energy", triangle.energy)
          .key("stretches")
          .numbers(triangle.stretches)
          .field("at_cut_locus", triangle.at_cut_locus)
          .end_object();
    out.end_array();
  }
  write_host(out, relaxation);
  write_terms(out, options, network, relaxation);
  out.field("gradient_norm", relaxation.gradient_norm).field("iterations", relaxation.iterations);
  write_relaxation_history(out, relaxation.history);
  out.field("stopped", embedded::to_string(relaxation.stopped)).field("mollified", relaxation.mollified);
  write_indices(out.key("at_vertices"), relaxation.at_vertices);
  write_indices(out.key("loose_points"), relaxation.loose_points);
  write_warnings(out, relaxation.warnings);
  out.key("accuracy")
      .begin_object()
      .field("tolerance", options.tolerance)
      .field("gradient_tolerance", relaxation.gradient_tolerance)
      .field("gradient_norm", relaxation.gradient_norm)
      .field("mollifier_length", options.mollifier_length)
      .end_object();
  write_points_in_space(out, request.points_in_space);
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

std::string write_partial_relaxation(int iteration, const embedded::RelaxationStep& step,
                                     const surface::TriangleMesh& mesh, std::span<const surface::SurfacePoint> points,
                                     bool moves) {
  JsonWriter out;
  out.begin_object()
      .field("iteration", iteration)
      .field("energy", step.energy)
      .field("gradient_norm", step.gradient_norm);
  if (points.size() <= max_partial_positions) write_positions(out, "positions", mesh, points);
  if (moves && mesh.positions().size() <= max_partial_positions) write_vertices(out, mesh.positions());
  out.end_object();
  return out.take();
}

}  // namespace supple::json
