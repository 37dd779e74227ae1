#include "geodesic_elements.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "cut_loci.h"
#include "supple/base/parallel_tasks.h"

namespace supple::embedded {
namespace {

/// Paths whose derivatives by the host's nodes one task works out.
constexpr std::size_t paths_of_a_task = 4;
/// What was found for so many states is kept for others to come.
constexpr std::size_t max_kept_paths = 8;
/// Diagonals of the mesh that a point goes at most in one step.
constexpr double longest_way = 4;

}  // namespace

GeodesicElements::GeodesicElements(const surface::GeodesicSolver& solver, const Network& network,
                                   std::vector<bool> held, GeodesicElementsOptions options)
    : solver_(solver),
      springs_(network.springs),
      material_(network.material),
      springs_at_(network.points.size()),
      triangles_at_(network.points.size()),
      held_(std::move(held)),
      options_(options) {
  // A side of two triangles, or beside a spring, is one path.
  std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> known;
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const Spring& spring = springs_[i];
    paths_.push_back({spring.from, spring.to});
    if (!network.triangles.empty()) known.try_emplace(std::minmax(spring.from, spring.to), i);
    if (spring.weight <= 0) continue;
    springs_at_[static_cast<std::size_t>(spring.from)].push_back(static_cast<std::int32_t>(i));
    springs_at_[static_cast<std::size_t>(spring.to)].push_back(static_cast<std::int32_t>(i));
  }
  for (const MembraneTriangle& given : network.triangles) {
    std::array<Side, 3> sides;
    for (int k = 0; k < 3; ++k) {
      int from = k;
      int to = (k + 1) % 3;
      const auto corner = [&](int c) { return given.corners[static_cast<std::size_t>(c)]; };
      const auto [entry, is_new] = known.try_emplace(std::minmax(corner(from), corner(to)), paths_.size());
      if (is_new) paths_.push_back({corner(from), corner(to)});
      if (paths_[entry->second].from != corner(from)) std::swap(from, to);
      sides[static_cast<std::size_t>(k)] = {entry->second, from, to};
    }
    for (const std::int32_t corner : given.corners)
      triangles_at_[static_cast<std::size_t>(corner)].push_back(static_cast<std::int32_t>(triangles_.size()));
    triangles_.push_back({given, sides, TriangleEnergy(given.rest_lengths, network.material)});
  }
  for (std::size_t i = 0; i < held_.size(); ++i)
    if (!held_[i] && !(springs_at_[i].empty() && triangles_at_[i].empty())) free_.push_back(i);
}

void GeodesicElements::prepare(NetworkState& state, int order, const Execution& execution) {
  if (state.collapsed()) return;
  if (!state.found()) find_paths(state, execution);
  if (order >= 1 && state.surface() && !(state.host_lengths() && state.host_lengths()->order >= order))
    find_host_lengths(state, order, execution);
}

double GeodesicElements::largest_step(const NetworkState& /*state*/, const Eigen::VectorXd& step) const {
  double longest = 0;
  for (const std::size_t point : free_)
    longest = std::max(longest, step.segment<2>(2 * static_cast<Eigen::Index>(point)).squaredNorm());
  const double limit = longest_way * solver_.mesh().diagonal();
  return longest > limit * limit ? limit / std::sqrt(longest) : std::numeric_limits<double>::infinity();
}

void GeodesicElements::find_paths(NetworkState& state, const Execution& execution) {
  std::vector<EqualPaths> equal;
  if (!state.cut_loci().empty()) {
    const StageTimer timer(execution.cost, "search");
    equal = keep_at_cut_loci({solver_of(state), held_}, state);
  }
  const auto& points = state.points();
  pairs_.resize(paths_.size());
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    pairs_[i].from = points[static_cast<std::size_t>(paths_[i].from)];
    pairs_[i].to = points[static_cast<std::size_t>(paths_[i].to)];
  }
  const StageTimer timer(execution.cost, "search");
  // Windows are counted; the time that passes is billed once, and progress is the minimization's.
  CostLedger counted;
  const Execution own{execution.cancellation, nullptr, execution.cost ? &counted : nullptr};
  const std::shared_ptr<FoundPaths> found = unused_paths();
  const bool known = options_.kept_strips && last_;
  if (known)
    for (std::size_t i = 0; i < paths_.size(); ++i) found->geodesics[i].strip = last_->geodesics[i].strip;
  // What pulls on nodes is known by the path itself.
  if (state.surface()) found->paths.resize(paths_.size());
  const surface::PathsFound counts =
      solver_of(state).tangent_geodesics(pairs_, found->geodesics, known, own, found->paths);
  if (options_.mollifier_length > 0) find_mollified(*found, own);
  if (CostLedger* cost = execution.cost) {
    for (const auto& quantity : counted.quantities()) cost->add_quantity(quantity.name, quantity.value);
    cost->add_quantity("same_face", static_cast<double>(counts.same_face));
    cost->add_quantity("unfolded", static_cast<double>(counts.unfolded));
    cost->add_quantity("searched", static_cast<double>(counts.searched));
  }
  last_ = found;
  state.set_found(found);
  found->equal.clear();
  if (!equal.empty()) {
    let_go_of_longer(state, equal, found->geodesics);
    if (!equal.empty()) share_out(state, *found, std::move(equal));
  }
}

std::vector<double> GeodesicElements::pulls_at(const FoundPaths& found) const {
  std::vector<double> pulls(paths_.size(), 0);
  for (std::size_t i = 0; i < springs_.size(); ++i)
    pulls[i] = 2 * springs_[i].weight * (length_of(found, i, false).length - springs_[i].rest_length);
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const TriangleEnergy::Value energy = triangles_[t].energy.at(lengths_of(found, t));
    for (int k = 0; k < 3; ++k) pulls[triangles_[t].sides[static_cast<std::size_t>(k)].path] += energy.first[k];
  }
  return pulls;
}

std::vector<bool> GeodesicElements::ends_that_push_at_cut_loci(const FoundPaths& found) const {
  std::vector<bool> ends(held_.size(), false);
  const std::vector<double> pulls = pulls_at(found);
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    if (!(pulls[i] < 0) || found.is_unique(i)) continue;
    for (const std::int32_t end : {paths_[i].from, paths_[i].to})
      if (!held_[static_cast<std::size_t>(end)]) ends[static_cast<std::size_t>(end)] = true;
  }
  return ends;
}

void GeodesicElements::share_out(NetworkState& state, FoundPaths& found, std::vector<EqualPaths> equal) const {
  // With all of the force in the first path of each.
  for (EqualPaths& own : equal) found.geodesics[own.path] = own.geodesics.front();
  numerics::EnergySum sum;
  sum.clear(state.dimension(), 1);
  add_on_rigid_host(state, 1, {}, sum);
  if (!std::isfinite(sum.value)) return;
  const std::vector<double> pulls = pulls_at(found);
  let_go_of_pulling(state, equal, pulls);
  if (equal.empty()) return;
  share_forces(state, equal, sum.gradient, pulls, held_);
  found.equal = std::move(equal);
}

void GeodesicElements::find_host_lengths(NetworkState& state, int order, const Execution& execution) const {
  const StageTimer timer(execution.cost, "host_derivatives");
  const auto lengths = std::make_shared<HostLengths>();
  lengths->order = order;
  lengths->lengths.resize(paths_.size());
  const std::size_t tasks = (paths_.size() + paths_of_a_task - 1) / paths_of_a_task;
  const Execution quiet{execution.cancellation, nullptr, nullptr};
  parallel_tasks(static_cast<int>(tasks), quiet, "host_derivatives", [&](int task, const Execution&) {
    const std::size_t begin = static_cast<std::size_t>(task) * paths_of_a_task;
    for (std::size_t i = begin; i < std::min(paths_.size(), begin + paths_of_a_task); ++i)
      if (!state.found()->geodesics[i].coincident())
        lengths->lengths[i] = surface::host_derivatives(state.mesh(), state.found()->paths[i], order);
  });
  state.set_host_lengths(lengths);
}

std::shared_ptr<FoundPaths> GeodesicElements::unused_paths() {
  // States come and go; what the ones that went have left is used again, since new memory costs as much as a search.
  for (const auto& paths : kept_paths_)
    if (paths.use_count() == 1) return paths;
  auto paths = std::make_shared<FoundPaths>();
  paths->geodesics.resize(paths_.size());
  if (kept_paths_.size() < max_kept_paths) kept_paths_.push_back(paths);
  return paths;
}

void GeodesicElements::find_mollified(FoundPaths& found, const Execution& execution) const {
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

LengthDerivatives GeodesicElements::length_of(const FoundPaths& found, std::size_t path, bool second) const {
  if (!found.mollified.empty()) return found.mollified[path];
  if (const EqualPaths* equal = found.equal_to(path)) return equal->length;
  const surface::TangentGeodesic& geodesic = found.geodesics[path];
  LengthDerivatives result;
  result.length = geodesic.distance;
  result.gradient << -geodesic.from_direction, geodesic.to_direction;
  if (second) result.hessian = geodesic.hessian();
  return result;
}

SpringElement GeodesicElements::spring_at(const FoundPaths& found, std::size_t spring, int order) const {
  const surface::TangentGeodesic& geodesic = found.geodesics[spring];
  if (geodesic.coincident()) return spring_element_at_zero(springs_[spring], geodesic.turn, spring);
  return spring_element(springs_[spring], length_of(found, spring, order >= 2));
}

Eigen::Vector3d GeodesicElements::lengths_of(const FoundPaths& found, std::size_t triangle) const {
  Eigen::Vector3d lengths;
  for (int k = 0; k < 3; ++k)
    lengths[k] = length_of(found, triangles_[triangle].sides[static_cast<std::size_t>(k)].path, false).length;
  return lengths;
}

TriangleElement GeodesicElements::triangle_at(const FoundPaths& found, std::size_t triangle, int order) const {
  const Triangle& own = triangles_[triangle];
  TriangleElement element(own.given.corners);
  const TriangleEnergy::Value energy = own.energy.at(lengths_of(found, triangle));
  element.value = energy.energy;
  if (order < 1 || !std::isfinite(energy.energy)) return element;
  Eigen::Matrix<double, 6, 3> slopes = Eigen::Matrix<double, 6, 3>::Zero();
  for (int k = 0; k < 3; ++k) {
    const Side& side = own.sides[static_cast<std::size_t>(k)];
    const LengthDerivatives length = length_of(found, side.path, order >= 2);
    const int from = 2 * side.from_corner;
    const int to = 2 * side.to_corner;
    slopes.block<2, 1>(from, k) = length.gradient.head<2>();
    slopes.block<2, 1>(to, k) = length.gradient.tail<2>();
    if (order < 2) continue;
    element.hessian.block<2, 2>(from, from) += energy.first[k] * length.hessian.topLeftCorner<2, 2>();
    element.hessian.block<2, 2>(from, to) += energy.first[k] * length.hessian.topRightCorner<2, 2>();
    element.hessian.block<2, 2>(to, from) += energy.first[k] * length.hessian.bottomLeftCorner<2, 2>();
    element.hessian.block<2, 2>(to, to) += energy.first[k] * length.hessian.bottomRightCorner<2, 2>();
  }
  element.gradient = slopes * energy.first;
  if (order >= 2) element.hessian += slopes * energy.second * slopes.transpose();
  return element;
}

HostLength GeodesicElements::host_length_at(const NetworkState& state, std::size_t path, int order, bool convex) const {
  const surface::HostDerivatives& exact = state.host_lengths()->lengths[path];
  // Ends that rounding puts in one place have no direction across which to divide by their distance.
  const auto& way = state.found()->paths[path];
  if (!convex || way.empty() || way.front().position == way.back().position)
    return host_length(state, exact, paths_[path].from, paths_[path].to, order);
  surface::HostDerivatives near = exact;
  near.hessian = surface::convex_host_hessian(state.mesh(), way, exact.vertices);
  return host_length(state, near, paths_[path].from, paths_[path].to, order);
}

HostElement GeodesicElements::host_spring_at(const NetworkState& state, std::size_t spring, int order,
                                             bool convex) const {
  const Spring& own = springs_[spring];
  const double excess = state.found()->geodesics[spring].distance - own.rest_length;
  if (order < 1) return {own.weight * excess * excess};
  const HostLength length = host_length_at(state, spring, order, convex);
  return element_of_lengths(own.weight * excess * excess, Eigen::VectorXd::Constant(1, 2 * own.weight * excess),
                            Eigen::MatrixXd::Constant(1, 1, 2 * own.weight), {&length, 1}, order, convex);
}

HostElement GeodesicElements::host_triangle_at(const NetworkState& state, std::size_t triangle, int order,
                                               bool convex) const {
  const Triangle& own = triangles_[triangle];
  const TriangleEnergy::Value energy = own.energy.at(lengths_of(*state.found(), triangle));
  if (order < 1 || !std::isfinite(energy.energy)) return {energy.energy};
  std::array<HostLength, 3> lengths;
  for (std::size_t k = 0; k < 3; ++k) lengths[k] = host_length_at(state, own.sides[k].path, order, convex);
  return element_of_lengths(energy.energy, energy.first, energy.second, lengths, order, convex);
}

void GeodesicElements::bill(CostLedger& cost, double seconds) const {
  cost.add_stage("assembly", seconds);
  const double all = static_cast<double>(springs_.size() + triangles_.size());
  if (!springs_.empty() || triangles_.empty())
    cost.add_effect("geodesic_springs", true, "the springs follow shortest paths on the surface", 1,
                    all > 0 ? seconds * static_cast<double>(springs_.size()) / all : seconds);
  if (!triangles_.empty())
    cost.add_effect("membrane", true, "there are triangles, whose sides are shortest paths", 1,
                    seconds * static_cast<double>(triangles_.size()) / all);
}

}  // namespace supple::embedded
