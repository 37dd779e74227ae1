#include <algorithm>

#include "endpoint.h"
#include "handlers.h"
#include "known_path.h"
#include "points.h"
#include "results.h"

namespace supple::routes {
namespace {

using surface::Geodesic;
using surface::SurfacePoint;
using Ends = std::vector<std::pair<SurfacePoint, SurfacePoint>>;
using Path = std::vector<surface::PathPoint>;

/// What geodesics are computed from.
struct GeodesicsInput {
  json::GeodesicsRequest request;
  std::shared_ptr<const store::LoadedMesh> mesh;
  Ends ends;
  std::vector<Path> known_paths;  ///< one for each pair; empty where there is none
};

GeodesicsInput geodesics_input(const EndpointRequest& asked, const Loader& loader) {
  GeodesicsInput input;
  input.request = json::parse_geodesics(asked.body, loader.limits(), loader.cancellation());
  input.mesh = loader.mesh(input.request.mesh, input.request.deadline);
  const auto& pairs = input.request.pairs;
  PointResolver points(loader, *input.mesh, input.request);
  input.ends.reserve(pairs.size());
  input.known_paths.resize(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto pointer = "/pairs/" + std::to_string(i);
    const SurfacePoint from = points.resolve(pairs[i].from, pointer + "/from");
    input.ends.emplace_back(from, points.resolve(pairs[i].to, pointer + "/to"));
    if (pairs[i].known_path.empty()) continue;
    input.known_paths[i] =
        checked_path(points, pairs[i].known_path, input.ends[i].first, input.ends[i].second, pointer + "/known_path");
  }
  return input;
}

void bill_effects(const GeodesicsInput& input, const surface::GeodesicOptions& options,
                  const std::vector<Geodesic>& results, CostLedger& ledger) {
  const auto mollified = std::count_if(
      results.begin(), results.end(), [](const Geodesic& geodesic) { return geodesic.mollified_distance.has_value(); });
  const char* const why = input.request.mollifier == json::Switch::off ? "the request turns it off"
                          : input.request.mollifier == json::Switch::on
                              ? "the request turns it on"
                              : "single distances keep their exact derivatives";
  ledger.add_effect("mollifier", options.mollifier > 0 && mollified > 0, why, mollified);
  const auto warm =
      std::count_if(input.known_paths.begin(), input.known_paths.end(), [](const Path& path) { return !path.empty(); });
  ledger.add_effect("known_path", warm > 0, warm > 0 ? "the request brings known paths" : "the request brings none",
                    warm);
}

store::Result compute(const GeodesicsInput& input, const Execution& outer) {
  surface::GeodesicOptions options;
  options.derivatives = input.request.derivatives;
  options.path = input.request.paths;
  if (input.request.mollifier == json::Switch::on) options.mollifier = input.request.mollifier_length;
  std::vector<Geodesic> results(input.ends.size());
  const auto bill = billed(outer, [&](const Execution& execution) {
    std::vector<surface::PointPair> pairs;
    pairs.reserve(input.ends.size());
    for (std::size_t i = 0; i < input.ends.size(); ++i)
      pairs.push_back(
          {input.ends[i].first, input.ends[i].second, input.known_paths[i].empty() ? nullptr : &input.known_paths[i]});
    input.mesh->solver(execution).pairs(pairs, results, options, execution);
    bill_effects(input, options, results, *execution.cost);
  });
  return json_result(json::write_geodesics(input.request, input.mesh->mesh(), input.ends, results, bill));
}

PreparedComputation prepare_geodesics(const EndpointRequest& asked, const Loader& loader) {
  auto input = std::make_shared<const GeodesicsInput>(geodesics_input(asked, loader));
  return {.mesh = input->request.mesh, .deadline = input->request.deadline, .run = [input](const Execution& execution) {
            return compute(*input, execution);
          }};
}

}  // namespace

void add_geodesics_route(http::Router& router, Services& services) {
  add_endpoint(router, services, {.kind = "geodesics", .prepare = prepare_geodesics});
}

}  // namespace supple::routes
