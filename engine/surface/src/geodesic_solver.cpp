#include "supple/surface/geodesic_solver.h"

#include "distance_check.h"
#include "edge_graph.h"
#include "field_data.h"
#include "path_assembly.h"
#include "solver_implementation.h"
#include "supple/base/error.h"

namespace supple::surface {

namespace {

SearchState state_of(const WindowSearch& search) {
  return {&search.mesh(), search.trails(), search.records(), search.sources(), search.ties()};
}

void bill(const WindowSearch& search, const Execution& execution) {
  if (!execution.cost) return;
  execution.cost->add_quantity("windows", static_cast<double>(search.windows_created()));
  execution.cost->add_quantity("batches", static_cast<double>(search.batches()));
}

/// Upper bound of the distance: the length of a known path, plus the rounding of its positions' coordinates.
double length_bound(const std::vector<PathPoint>& path) {
  double length = 0;
  double coordinates = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    length += (path[i].position - path[i - 1].position).norm();
    coordinates += path[i].position.lpNorm<1>();
  }
  return length * (1 + 1e-9) + edge_rounding * coordinates;
}

}  // namespace

GeodesicSolver::GeodesicSolver(std::shared_ptr<const TriangleMesh> mesh)
    : GeodesicSolver(std::move(mesh), Execution{}) {}
GeodesicSolver::GeodesicSolver(std::shared_ptr<const TriangleMesh> mesh, const Execution& execution)
    : implementation_(std::make_unique<Implementation>(std::move(mesh), execution)) {}
GeodesicSolver::~GeodesicSolver() = default;

const TriangleMesh& GeodesicSolver::mesh() const { return *implementation_->search_mesh->mesh; }
const std::shared_ptr<const TriangleMesh>& GeodesicSolver::shared_mesh() const {
  return implementation_->search_mesh->mesh;
}

std::int64_t GeodesicSolver::memory_bytes() const {
  const std::lock_guard lock(implementation_->mutex);
  std::size_t bytes = implementation_->search_mesh->memory_bytes();
  for (const auto& search : implementation_->idle) bytes += search->memory_bytes();
  return static_cast<std::int64_t>(bytes);
}

double GeodesicSolver::distance(const SurfacePoint& from, const SurfacePoint& to, const Execution& execution) const {
  return geodesic(from, to, {}, execution).distance;
}

Geodesic GeodesicSolver::geodesic(const SurfacePoint& from_point, const SurfacePoint& to,
                                  const GeodesicOptions& options, const Execution& execution,
                                  const PairHints& hints) const {
  const SurfacePoint from = rounded_to_vertex(from_point);
  const SearchMesh& search_mesh = *implementation_->search_mesh;
  if (mesh().component(index(from.face)) != mesh().component(index(to.face))) return {};
  SearchTarget target = make_target(search_mesh, to);
  if (arrive_near_vertex(search_mesh, {&from, 1}, target)) {
    return assemble({&search_mesh, {}, nullptr, {&from, 1}}, target, options);
  }
  Implementation::Lease search(*implementation_);
  SearchSettings settings;
  settings.goal_directed = true;
  if (hints.known_path && hints.known_path->size() > 1 &&
      hints.known_path->front().position == position(mesh(), from) &&
      hints.known_path->back().position == target.position) {
    settings.limit = length_bound(*hints.known_path);
  }
  if (hints.landmark) {
    settings.landmark = hints.landmark->vertex_distances();
    settings.landmark_distance = hints.landmark_distance;
  }
  {
    const StageTimer timer(execution.cost, "search");
    search->run({&from, 1}, {&target, 1}, settings, execution);
  }
  bill(*search, execution);
  check_target(*search, target);
  const StageTimer timer(execution.cost, "assembly");
  return assemble(state_of(*search), target, options);
}

std::vector<Geodesic> GeodesicSolver::geodesics(const SurfacePoint& from_point, std::span<const SurfacePoint> to,
                                                const GeodesicOptions& options, const Execution& execution) const {
  const SurfacePoint from = rounded_to_vertex(from_point);
  const SearchMesh& search_mesh = *implementation_->search_mesh;
  std::vector<Geodesic> results(to.size());
  std::vector<SearchTarget> targets;
  std::vector<std::size_t> target_indices;
  const std::int32_t component = mesh().component(index(from.face));
  for (std::size_t i = 0; i < to.size(); ++i) {
    execution.cancellation.throw_if_requested();
    if (mesh().component(index(to[i].face)) != component) continue;
    SearchTarget target = make_target(search_mesh, to[i]);
    if (arrive_near_vertex(search_mesh, {&from, 1}, target)) {
      results[i] = assemble({&search_mesh, {}, nullptr, {&from, 1}}, target, options);
      continue;
    }
    targets.push_back(target);
    target_indices.push_back(i);
  }
  if (targets.empty()) return results;
  Implementation::Lease search(*implementation_);
  const SearchSettings settings;
  {
    const StageTimer timer(execution.cost, "search");
    search->run({&from, 1}, targets, settings, execution);
  }
  bill(*search, execution);
  const StageTimer timer(execution.cost, "assembly");
  const SearchState state = state_of(*search);
  for (std::size_t i = 0; i < targets.size(); ++i) {
    execution.cancellation.throw_if_requested();
    check_target(*search, targets[i]);
    results[target_indices[i]] = assemble(state, targets[i], options);
  }
  return results;
}

GeodesicField GeodesicSolver::field(std::span<const SurfacePoint> sources, const FieldOptions& options,
                                    const Execution& execution) const {
  if (sources.empty()) throw Error("field.no_sources", "A distance field needs at least one source.");
  auto data = std::make_shared<GeodesicField::Data>();
  data->mesh = implementation_->search_mesh;
  for (const SurfacePoint& source : sources) data->sources.push_back(rounded_to_vertex(source));
  const auto vertices = static_cast<std::size_t>(mesh().vertex_count());
  if (options.method == FieldMethod::edge_graph) {
    const StageTimer timer(execution.cost, "search");
    EdgeGraphField found = edge_graph_field(*data->mesh, data->sources, options.max_distance, execution);
    data->distances = std::move(found.distances);
    data->vertex_sources = std::move(found.vertex_sources);
    data->fill_sources_in_faces();
    return GeodesicField(std::move(data));
  }
  Implementation::Lease search(*implementation_);
  SearchSettings settings;
  settings.keep_windows = options.keep_windows;
  settings.relative_error = options.relative_error;
  settings.limit = options.max_distance;
  settings.known_distances = options.known_distances;
  {
    const StageTimer timer(execution.cost, "search");
    search->run(data->sources, {}, settings, execution);
  }
  bill(*search, execution);
  const StageTimer timer(execution.cost, "assembly");
  data->relative_error_bound = options.relative_error;
  data->window_count = search->windows_created();
  data->distances.resize(vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    const auto vertex = static_cast<std::int32_t>(v);
    const double distance = search->distance(vertex) < infinity ? search->length_of_path(vertex) : infinity;
    data->distances[v] = distance <= options.max_distance ? distance : infinity;
  }
  // With known distances the check does not apply: the field is right only where the given sources are the nearest.
  if (options.known_distances.empty()) {
    check_distances(mesh(), data->distances, options.relative_error, options.max_distance);
  }
  if (options.keep_windows) {
    search->take_logged_windows(data->records, data->windows, data->first);
    data->trails.assign(search->trails().begin(), search->trails().end());
    data->ties.assign(search->ties().begin(), search->ties().end());
    data->fill_sources_in_faces();
    data->fill_vertex_sources();
  }
  data->has_windows = options.keep_windows;
  return GeodesicField(std::move(data));
}

}  // namespace supple::surface
