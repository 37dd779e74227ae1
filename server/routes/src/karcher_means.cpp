#include "endpoint.h"
#include "handlers.h"
#include "points.h"
#include "results.h"

namespace supple::routes {
namespace {

surface::KarcherProblem problem_of(const Loader& loader, json::KarcherMeanRequest& request,
                                   const store::LoadedMesh& mesh) {
  surface::KarcherProblem problem;
  PointResolver points(loader, mesh, request);
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

PreparedComputation prepare_karcher_mean(const EndpointRequest& asked, const Loader& loader) {
  auto request = json::parse_karcher_mean(asked.body, loader.limits(), loader.cancellation());
  auto mesh = loader.mesh(request.mesh, request.deadline);
  auto problem = problem_of(loader, request, *mesh);
  return {.mesh = request.mesh,
          .deadline = request.deadline,
          .run = [request = std::move(request), mesh = std::move(mesh), problem = std::move(problem)](
                     const Execution& execution) { return compute(request, *mesh, problem, execution); }};
}

}  // namespace

void add_karcher_mean_route(http::Router& router, Services& services) {
  add_endpoint(router, services, {.kind = "karcher-means", .prepare = prepare_karcher_mean});
}

}  // namespace supple::routes
