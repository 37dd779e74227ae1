#include <algorithm>
#include <array>
#include <chrono>
#include <optional>

#include "computation_route.h"
#include "handlers.h"
#include "part_of_execution.h"
#include "points.h"
#include "supple/embedded/export.h"
#include "supple/embedded/network_builders.h"
#include "supple/json/embedded_system_answers.h"

namespace supple::routes {
namespace {

using json::EmbeddedSystemRequest;

/// What builders take of the whole computation, as far as progress is concerned.
constexpr double building_share = 0.2;
/// Between two intermediate states that are written down; job queues show no more of them.
constexpr std::chrono::milliseconds state_period{100};

enum class NetworkFile { none, obj, vtu, svg };
constexpr std::array<std::string_view, 4> media_types{"application/json", "model/obj", "application/x-vtu+xml",
                                                      "image/svg+xml"};

/// Throws "http.not_acceptable".
NetworkFile negotiate_network_file(const http::Request& request) {
  const auto type = http::negotiate(request.header("Accept"), {media_types.begin(), media_types.end()});
  if (!type) {
    throw Error("http.not_acceptable",
                "A network is sent as application/json, model/obj, application/x-vtu+xml or image/svg+xml.");
  }
  return static_cast<NetworkFile>(std::find(media_types.begin(), media_types.end(), *type) - media_types.begin());
}

void check_built(std::size_t count, const char* field, std::size_t limit, const char* setting) {
  if (count <= limit) return;
  problem::throw_limit("request.limit_exceeded", std::string("The number of built entries of ") + field,
                       static_cast<double>(limit), static_cast<double>(count), setting, field);
}

/// How many pairs of points lie in faces that share an edge, each pair once for each edge. O(points + faces).
std::size_t count_adjacent_pairs(const surface::TriangleMesh& mesh, const std::vector<surface::SurfacePoint>& points) {
  std::vector<std::size_t> in_face(static_cast<std::size_t>(mesh.face_count()));
  for (const auto& point : points) ++in_face[static_cast<std::size_t>(index(point.face))];
  std::size_t pairs = 0;
  for (std::int32_t h = 0; h < mesh.halfedge_count(); ++h) {
    if (mesh.twin(h) < h) continue;
    pairs += in_face[static_cast<std::size_t>(surface::TriangleMesh::face_of(h))] *
             in_face[static_cast<std::size_t>(surface::TriangleMesh::face_of(mesh.twin(h)))];
  }
  return pairs;
}

struct BuiltNetwork {
  embedded::Network network;
  std::optional<std::vector<std::array<std::int32_t, 3>>> triangles;
};

/// Builds what the request does not give one by one.
class NetworkBuilder {
 public:
  NetworkBuilder(const EmbeddedSystemRequest& request, const store::LoadedMesh& mesh, const json::Limits& limits)
      : request_(request), mesh_(mesh), limits_(limits) {}

  BuiltNetwork build(std::vector<surface::SurfacePoint> given, const Execution& execution) const {
    BuiltNetwork built;
    built.network.fixed_points = request_.fixed_points;
    built.network.points = points(std::move(given), PartOfExecution(execution, 0, 0.5).execution());
    add_springs(built, PartOfExecution(execution, 0.5, 0.5).execution());
    return built;
  }

 private:
  std::vector<surface::SurfacePoint> points(std::vector<surface::SurfacePoint> given,
                                            const Execution& execution) const {
    if (const auto* in_faces = std::get_if<json::PointsInFaces>(&request_.points)) {
      execution.checkpoint(0, "points");
      const StageTimer timer(execution.cost, "points");
      check_built(static_cast<std::size_t>(mesh_.mesh().face_count()), "/points", limits_.max_points, "--max-points");
      return embedded::points_in_faces(mesh_.mesh(), in_faces->barycentric);
    }
    if (const auto* disks = std::get_if<json::PoissonDiskPoints>(&request_.points)) {
      execution.checkpoint(0, "points");
      const StageTimer timer(execution.cost, "points");
      return embedded::poisson_disk_points(mesh_.solver, disks->radius, disks->seed, limits_.max_points, execution);
    }
    return given;
  }

  void add_springs(BuiltNetwork& built, const Execution& execution) const {
    const auto* builder = std::get_if<json::SpringBuilder>(&request_.springs);
    if (!builder) {
      built.network.springs = std::get<std::vector<embedded::Spring>>(request_.springs);
      return;
    }
    execution.checkpoint(0, "springs");
    const StageTimer timer(execution.cost, "springs");
    std::vector<embedded::Pair> pairs;
    if (builder->kind == json::SpringBuilder::Kind::adjacent_faces) {
      check_built(count_adjacent_pairs(mesh_.mesh(), built.network.points), "/springs", limits_.max_springs,
                  "--max-springs");
      pairs = embedded::pairs_of_adjacent_faces(mesh_.mesh(), built.network.points);
    } else {
      auto dual = embedded::triangulate(mesh_.solver, built.network.points, execution);
      pairs = std::move(dual.edges);
      built.triangles = std::move(dual.triangles);
    }
    check_built(pairs.size(), "/springs", limits_.max_springs, "--max-springs");
    built.network.springs.reserve(pairs.size());
    for (const auto& [from, to] : pairs)
      built.network.springs.push_back({from, to, builder->rest_length, builder->weight});
  }

  const EmbeddedSystemRequest& request_;
  const store::LoadedMesh& mesh_;
  const json::Limits& limits_;
};

/// Publishes the states on the way, as often as anyone can see them.
class StatePublisher {
 public:
  StatePublisher(const surface::TriangleMesh& mesh, ProgressSink& sink) : mesh_(mesh), sink_(sink) {}

  void operator()(const embedded::RelaxationStep& step, std::span<const surface::SurfacePoint> points) {
    const int iteration = iteration_++;
    const auto now = std::chrono::steady_clock::now();
    if (iteration > 0 && now - last_ < state_period) return;
    last_ = now;
    sink_.publish(json::write_partial_relaxation(iteration, step, mesh_, points));
  }

 private:
  const surface::TriangleMesh& mesh_;
  ProgressSink& sink_;
  int iteration_ = 0;
  std::chrono::steady_clock::time_point last_{};
};

std::string write_network_file(NetworkFile file, const surface::TriangleMesh& mesh, const embedded::Network& network,
                               const embedded::Relaxation& relaxation) {
  if (file == NetworkFile::obj) return embedded::write_obj(mesh, network, relaxation);
  if (file == NetworkFile::vtu) return embedded::write_vtu(mesh, network, relaxation);
  return embedded::write_convergence_svg(relaxation.history);
}

store::Result compute(const EmbeddedSystemRequest& request, const store::LoadedMesh& mesh,
                      const std::vector<surface::SurfacePoint>& given, NetworkFile file, const json::Limits& limits,
                      const Execution& outer) {
  BuiltNetwork built;
  embedded::Relaxation relaxation;
  store::Result result;
  const auto bill = billed(outer, [&](const Execution& execution) {
    const bool builds = !std::holds_alternative<std::vector<json::PointSpec>>(request.points) ||
                        std::holds_alternative<json::SpringBuilder>(request.springs);
    const double first = builds ? building_share : 0;
    built = NetworkBuilder(request, mesh, limits).build(given, PartOfExecution(execution, 0, first).execution());
    auto options = request.options;
    options.paths = options.paths || file == NetworkFile::obj || file == NetworkFile::vtu;
    if (execution.progress) options.observer = StatePublisher(mesh.mesh(), *execution.progress);
    const PartOfExecution relaxing(execution, first, 1 - first);
    relaxation = embedded::relax(mesh.solver, built.network, options, relaxing.execution());
    if (file != NetworkFile::none) {
      execution.checkpoint(1, "export");
      const StageTimer timer(execution.cost, "export");
      result.body = write_network_file(file, mesh.mesh(), built.network, relaxation);
    }
  });
  if (file == NetworkFile::none) {
    const auto* triangles = built.triangles ? &*built.triangles : nullptr;
    return json_result(json::write_embedded_system(request, mesh.mesh(), built.network, relaxation, triangles, bill));
  }
  result.content_type = media_types.at(static_cast<std::size_t>(file));
  result.headers = {{"Supple-Seconds", plain_number(bill.seconds)}, {"Supple-Stopped", relaxation.stopped}};
  return result;
}

}  // namespace

void add_embedded_system_route(http::Router& router, Services& services) {
  const auto handler = [&services](const http::Request& http_request) {
    require_ready(services);
    const auto file = negotiate_network_file(http_request);
    auto request = json::parse_embedded_system(json_body(http_request), services.limits.json);
    auto mesh = load_mesh(services, request.mesh);
    std::vector<surface::SurfacePoint> given;
    if (const auto* points = std::get_if<std::vector<json::PointSpec>>(&request.points))
      given = resolve(mesh->mesh(), *points, "/points");
    jobs::Computation computation{"embedded-systems", request.mesh, request.deadline, {}};
    computation.run = [request = std::move(request), mesh = std::move(mesh), given = std::move(given), file,
                       limits = services.limits.json](const Execution& execution) {
      return compute(request, *mesh, given, file, limits, execution);
    };
    return answer_computation(services, http_request, std::move(computation));
  };
  router.add({"POST", "/v1/embedded-systems", handler, {services.limits.max_json, "--max-json"}});
}

}  // namespace supple::routes
