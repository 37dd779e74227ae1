#include "path_cache.h"

#include <algorithm>
#include <utility>

#include "cut_loci.h"
#include "supple/base/parallel_tasks.h"

namespace supple::embedded {
namespace {

/// Number of paths whose lengths one task differentiates by the host's nodes.
constexpr std::size_t paths_of_a_task = 4;
/// Maximum number of FoundPaths whose memory is used again once no state refers to them.
constexpr std::size_t max_allocated = 8;

}  // namespace

PathCache::PathCache(const surface::GeodesicSolver& solver, std::shared_ptr<const ElasticNetwork> network,
                     PathCacheOptions options)
    : solver_(solver), network_(std::move(network)), options_(options) {}

PathCache::Found PathCache::find(NetworkState& state, const Execution& execution) {
  Found result;
  if (!state.cut_loci().empty()) {
    const StageTimer timer(execution.cost, "search");
    result.equal = return_to_cut_loci({solver_of(state), network_->fixed()}, state);
  }
  const auto& paths = network_->paths();
  const auto& points = state.points();
  pairs_.resize(paths.size());
  for (std::size_t i = 0; i < paths.size(); ++i) {
    pairs_[i].from = points[static_cast<std::size_t>(paths[i].from)];
    pairs_[i].to = points[static_cast<std::size_t>(paths[i].to)];
  }
  const StageTimer timer(execution.cost, "search");
  // The searches count their windows in a ledger of their own, because `timer` bills their time. They report no
  // progress, because the minimization does.
  CostLedger counted;
  const Execution own{execution.cancellation, nullptr, execution.cost ? &counted : nullptr};
  result.paths = unused_paths();
  FoundPaths& found = *result.paths;
  const bool has_strips = options_.reuses_strips && last_;
  if (has_strips)
    for (std::size_t i = 0; i < paths.size(); ++i) found.geodesics[i].strip = last_->geodesics[i].strip;
  // The forces on nodes need the points at which a path crosses edges.
  if (state.surface()) found.paths.resize(paths.size());
  const surface::PathCounts counts =
      solver_of(state).tangent_geodesics(pairs_, found.geodesics, has_strips, own, found.paths);
  if (options_.mollifier_length > 0) find_mollified(found, own);
  if (CostLedger* cost = execution.cost) {
    for (const auto& quantity : counted.quantities()) cost->add_quantity(quantity.name, quantity.value);
    cost->add_quantity("same_face", static_cast<double>(counts.same_face));
    cost->add_quantity("unfolded", static_cast<double>(counts.unfolded));
    cost->add_quantity("searched", static_cast<double>(counts.searched));
  }
  last_ = result.paths;
  state.set_found(result.paths);
  found.equal.clear();
  if (!result.equal.empty()) drop_non_shortest(state, result.equal, found.geodesics);
  return result;
}

void PathCache::find_host_lengths(NetworkState& state, int order, const Execution& execution) const {
  const StageTimer timer(execution.cost, "host_derivatives");
  const std::size_t count = network_->paths().size();
  const auto lengths = std::make_shared<HostLengths>();
  lengths->order = order;
  lengths->lengths.resize(count);
  const std::size_t tasks = (count + paths_of_a_task - 1) / paths_of_a_task;
  const Execution quiet{execution.cancellation, nullptr, nullptr};
  parallel_tasks(static_cast<int>(tasks), quiet, "host_derivatives", [&](int task, const Execution&) {
    const std::size_t begin = static_cast<std::size_t>(task) * paths_of_a_task;
    for (std::size_t i = begin; i < std::min(count, begin + paths_of_a_task); ++i)
      if (!state.found()->geodesics[i].coincident())
        lengths->lengths[i] = surface::host_derivatives(state.mesh(), state.found()->paths[i], order);
  });
  state.set_host_lengths(lengths);
}

std::shared_ptr<FoundPaths> PathCache::unused_paths() {
  for (const auto& paths : allocated_)
    if (paths.use_count() == 1) return paths;
  auto paths = std::make_shared<FoundPaths>();
  paths->geodesics.resize(network_->paths().size());
  if (allocated_.size() < max_allocated) allocated_.push_back(paths);
  return paths;
}

void PathCache::find_mollified(FoundPaths& found, const Execution& execution) const {
  surface::GeodesicOptions options;
  options.derivatives = 2;
  options.mollifier = options_.mollifier_length;
  std::vector<surface::Geodesic> geodesics(pairs_.size());
  solver_.pairs(pairs_, geodesics, options, execution);
  found.mollified.assign(pairs_.size(), {});
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    if (!geodesics[i].derivatives || !geodesics[i].mollified_distance) continue;
    found.mollified[i] = {*geodesics[i].mollified_distance, geodesics[i].derivatives->tangent_gradient,
                          geodesics[i].derivatives->tangent_hessian};
  }
}

}  // namespace supple::embedded
