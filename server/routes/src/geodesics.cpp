#include <algorithm>

#include "computation_route.h"
#include "handlers.h"
#include "known_path.h"
#include "points.h"

namespace supple::routes {
namespace {

using surface::Geodesic;
using surface::SurfacePoint;
using Ends = std::vector<std::pair<SurfacePoint, SurfacePoint>>;
using Path = std::vector<surface::PathPoint>;

struct Work {
  json::GeodesicsRequest request;
  std::shared_ptr<const store::LoadedMesh> mesh;
  Ends ends;
  std::vector<Path> known_paths;  ///< one for each pair; empty where there is none
};

Work prepare(const Services& services, const http::Request& http_request) {
  Work work;
  work.request = json::parse_geodesics(json_body(http_request), services.limits.json);
  work.mesh = load_mesh(services, http_request, work.request.mesh, work.request.deadline);
  const auto& pairs = work.request.pairs;
  PointResolver points(services, http_request, *work.mesh, work.request);
  work.ends.reserve(pairs.size());
  work.known_paths.resize(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto pointer = "/pairs/" + std::to_string(i);
    const SurfacePoint from = points.resolve(pairs[i].from, pointer + "/from");
    work.ends.emplace_back(from, points.resolve(pairs[i].to, pointer + "/to"));
    if (pairs[i].known_path.empty()) continue;
    work.known_paths[i] =
        checked_path(points, pairs[i].known_path, work.ends[i].first, work.ends[i].second, pointer + "/known_path");
  }
  return work;
}

void bill_effects(const Work& work, const surface::GeodesicOptions& options, const std::vector<Geodesic>& results,
                  CostLedger& ledger) {
  const auto mollified = std::count_if(
      results.begin(), results.end(), [](const Geodesic& geodesic) { return geodesic.mollified_distance.has_value(); });
  const char* const why = work.request.mollifier == json::Switch::off ? "the request turns it off"
                          : work.request.mollifier == json::Switch::on
                              ? "the request turns it on"
                              : "single distances keep their exact derivatives";
  ledger.add_effect("mollifier", options.mollifier > 0 && mollified > 0, why, mollified);
  const auto warm =
      std::count_if(work.known_paths.begin(), work.known_paths.end(), [](const Path& path) { return !path.empty(); });
  ledger.add_effect("known_path", warm > 0, warm > 0 ? "the request brings known paths" : "the request brings none",
                    warm);
}

store::Result compute(const Work& work, const Execution& outer) {
  surface::GeodesicOptions options;
  options.derivatives = work.request.derivatives;
  options.path = work.request.paths;
  if (work.request.mollifier == json::Switch::on) options.mollifier = work.request.mollifier_length;
  std::vector<Geodesic> results(work.ends.size());
  const auto bill = billed(outer, [&](const Execution& execution) {
    std::vector<surface::PointPair> pairs;
    pairs.reserve(work.ends.size());
    for (std::size_t i = 0; i < work.ends.size(); ++i)
      pairs.push_back(
          {work.ends[i].first, work.ends[i].second, work.known_paths[i].empty() ? nullptr : &work.known_paths[i]});
    work.mesh->solver(execution).pairs(pairs, results, options, execution);
    bill_effects(work, options, results, *execution.cost);
  });
  return json_result(json::write_geodesics(work.request, work.mesh->mesh(), work.ends, results, bill));
}

}  // namespace

void add_geodesics_route(http::Router& router, Services& services) {
  const auto handler = [&services](const http::Request& http_request) {
    require_ready(services);
    auto work = std::make_shared<const Work>(prepare(services, http_request));
    jobs::Computation computation{"geodesics", work->request.mesh, work->request.deadline, {}};
    computation.run = [work](const Execution& execution) { return compute(*work, execution); };
    return answer_computation(services, http_request, std::move(computation));
  };
  router.add({"POST", "/v1/geodesics", handler, {services.limits.max_json, "--max-json"}});
}

}  // namespace supple::routes
