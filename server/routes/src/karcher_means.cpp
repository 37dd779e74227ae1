#include "computation_route.h"
#include "handlers.h"
#include "points.h"

namespace supple::routes {
namespace {

surface::KarcherProblem problem_of(const Services& services, const http::Request& http_request,
                                   json::KarcherMeanRequest& request, const store::LoadedMesh& mesh) {
  surface::KarcherProblem problem;
  PointResolver points(services, http_request, mesh, request);
  problem.points = points.resolve(request.points, "/points");
  problem.weights = request.weights;
  problem.method = request.method;
  problem.tolerance = request.tolerance;
  problem.max_iterations = request.max_iterations;
  problem.starts = request.starts;
  if (request.start) problem.start = points.resolve(*request.start, "/start");
  using KeptFields = surface::KarcherProblem::KeptFields;
  problem.kept_fields = request.kept_fields == json::Switch::on    ? KeptFields::on
                        : request.kept_fields == json::Switch::off ? KeptFields::off
                                                                   : KeptFields::automatic;
  return problem;
}

store::Result compute(const json::KarcherMeanRequest& request, const store::LoadedMesh& mesh,
                      const surface::KarcherProblem& problem, const Execution& outer) {
  surface::KarcherMean mean;
  const auto bill = billed(outer, [&](const Execution& execution) {
    mean = surface::karcher_mean(mesh.solver(execution), problem, execution);
  });
  return json_result(json::write_karcher_mean(request, mesh.mesh(), mean, bill));
}

}  // namespace

void add_karcher_mean_route(http::Router& router, Services& services) {
  const auto handler = [&services](const http::Request& http_request) {
    require_ready(services);
    auto request = json::parse_karcher_mean(json_body(http_request), services.limits.json);
    auto mesh = load_mesh(services, http_request, request.mesh, request.deadline);
    auto problem = problem_of(services, http_request, request, *mesh);
    jobs::Computation computation{"karcher-means", request.mesh, request.deadline, {}};
    computation.run = [request = std::move(request), mesh = std::move(mesh), problem = std::move(problem)](
                          const Execution& execution) { return compute(request, *mesh, problem, execution); };
    return answer_computation(services, http_request, std::move(computation));
  };
  router.add({"POST", "/v1/karcher-means", handler, {services.limits.max_json, "--max-json"}});
}

}  // namespace supple::routes
