#include <algorithm>
#include <atomic>
#include <mutex>
#include <numeric>

#include "computation_route.h"
#include "handlers.h"
#include "known_path.h"
#include "points.h"
#include "supple/base/threads.h"

namespace supple::routes {
namespace {

using surface::Geodesic;
using surface::SurfacePoint;
using Ends = std::vector<std::pair<SurfacePoint, SurfacePoint>>;
using Path = std::vector<surface::PathPoint>;

/// Targets of one search; more are split, so that threads share the work of a single source.
constexpr std::size_t max_targets = 256;

struct Work {
  json::GeodesicsRequest request;
  std::shared_ptr<const store::LoadedMesh> mesh;
  Ends ends;
  std::vector<Path> known_paths;  ///< one for each pair; empty where there is none
};

Work prepare(const Services& services, const http::Request& http_request) {
  Work work;
  work.request = json::parse_geodesics(json_body(http_request), services.limits.json);
  work.mesh = load_mesh(services, work.request.mesh);
  const auto& mesh = work.mesh->mesh();
  const auto& pairs = work.request.pairs;
  work.ends.reserve(pairs.size());
  work.known_paths.resize(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto pointer = "/pairs/" + std::to_string(i);
    work.ends.emplace_back(resolve(mesh, pairs[i].from, pointer + "/from"),
                           resolve(mesh, pairs[i].to, pointer + "/to"));
    if (pairs[i].known_path.empty()) continue;
    work.known_paths[i] =
        checked_path(mesh, pairs[i].known_path, work.ends[i].first, work.ends[i].second, pointer + "/known_path");
  }
  return work;
}

bool same_point(const SurfacePoint& a, const SurfacePoint& b) {
  return a.face == b.face && a.barycentric == b.barycentric;
}

bool before(const SurfacePoint& a, const SurfacePoint& b) {
  if (a.face != b.face) return a.face < b.face;
  return std::lexicographical_compare(a.barycentric.begin(), a.barycentric.end(), b.barycentric.begin(),
                                      b.barycentric.end());
}

/// The pairs as groups that one search answers: those of the same first point without a known path.
std::vector<std::vector<std::size_t>> group(const Work& work) {
  std::vector<std::size_t> order(work.ends.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return before(work.ends[i].first, work.ends[j].first); });
  std::vector<std::vector<std::size_t>> groups;
  for (const auto i : order) {
    const bool joins = !groups.empty() && groups.back().size() < max_targets && work.known_paths[i].empty() &&
                       work.known_paths[groups.back().front()].empty() &&
                       same_point(work.ends[groups.back().front()].first, work.ends[i].first);
    if (!joins) groups.emplace_back();
    groups.back().push_back(i);
  }
  return groups;
}

void compute_group(const Work& work, const std::vector<std::size_t>& members, const surface::GeodesicOptions& options,
                   const Execution& execution, std::vector<Geodesic>& results) {
  const auto& solver = work.mesh->solver;
  const auto first = members.front();
  if (members.size() == 1) {
    const auto* known = work.known_paths[first].empty() ? nullptr : &work.known_paths[first];
    results[first] =
        solver.geodesic(work.ends[first].first, work.ends[first].second, options, execution, {.known_path = known});
    return;
  }
  std::vector<SurfacePoint> targets;
  targets.reserve(members.size());
  for (const auto i : members) targets.push_back(work.ends[i].second);
  auto found = solver.geodesics(work.ends[first].first, targets, options, execution);
  for (std::size_t k = 0; k < members.size(); ++k) results[members[k]] = std::move(found[k]);
}

void compute_all(const Work& work, const surface::GeodesicOptions& options, const Execution& execution,
                 std::vector<Geodesic>& results) {
  const auto groups = group(work);
  if (groups.size() == 1) return compute_group(work, groups.front(), options, execution, results);
  std::mutex mutex;
  std::size_t done = 0;
  parallel_for(static_cast<int>(groups.size()), [&](int g) {
    const auto& members = groups[static_cast<std::size_t>(g)];
    CostLedger ledger;
    Execution inner;
    inner.cancellation = execution.cancellation;
    inner.cost = &ledger;
    inner.cancellation.throw_if_requested();
    compute_group(work, members, options, inner, results);
    const std::lock_guard lock(mutex);
    execution.cost->merge(ledger);
    done += members.size();
    if (execution.progress) {
      execution.progress->report(static_cast<double>(done) / static_cast<double>(results.size()), "search");
    }
  });
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
    compute_all(work, options, execution, results);
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
