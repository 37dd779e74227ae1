#include "geodesic_springs.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "supple/numerics/minimizer.h"

namespace supple::embedded {
namespace {

/// A vertex within this many times the way of a point since the last accepted state may be where it wants to rest.
constexpr double reach_of_kinks = 2;
/// Points nearer to a vertex than this, in mean edges, are at it but for rounding.
constexpr double point_rounding = 1e-13;
/// Points whose springs exceed what was foretold by less than this share of the worst point's are not in the way; nor
/// are more than so many worth the time.
constexpr double share_of_surprise = 0.02;
constexpr std::size_t most_surprised = 64;
constexpr std::size_t most_trials = 8;
/// A point by itself is brought near its minimum, no farther: the others move on.
constexpr int most_local_iterations = 12;
constexpr double local_tolerance = 1e-8;
/// What was found for so many states is kept for others to come.
constexpr std::size_t most_kept_paths = 8;
/// A slope above this share of the pulls that make it counts as none.
constexpr double slope_rounding = 1e-12;

SpringLengthDerivatives length_derivatives(const surface::TangentGeodesic& geodesic, bool second) {
  SpringLengthDerivatives result;
  result.length = geodesic.distance;
  result.gradient << -geodesic.from_direction, geodesic.to_direction;
  if (second) result.hessian = geodesic.hessian();
  return result;
}

/// Takes an end away from an element: what happens at a tip is added by itself.
void take_out(SpringElement& element, int end) {
  element.gradient.segment<2>(2 * end).setZero();
  element.hessian.middleRows<2>(2 * end).setZero();
  element.hessian.middleCols<2>(2 * end).setZero();
}

}  // namespace

GeodesicSprings::GeodesicSprings(const surface::GeodesicSolver& solver, const Network& network, std::vector<bool> held,
                                 GeodesicSpringsOptions options)
    : solver_(solver),
      springs_(network.springs),
      springs_at_(network.points.size()),
      held_(std::move(held)),
      options_(options) {
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    if (springs_[i].weight <= 0) continue;
    springs_at_[static_cast<std::size_t>(springs_[i].from)].push_back(static_cast<std::int32_t>(i));
    springs_at_[static_cast<std::size_t>(springs_[i].to)].push_back(static_cast<std::int32_t>(i));
  }
  for (std::size_t i = 0; i < held_.size(); ++i)
    if (!held_[i] && !springs_at_[i].empty()) free_.push_back(i);
}

void GeodesicSprings::prepare(NetworkState& state, int /*order*/, const Execution& execution) {
  if (state.found()) return;
  const auto& points = state.points();
  pairs_.resize(springs_.size());
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    pairs_[i].from = points[static_cast<std::size_t>(springs_[i].from)];
    pairs_[i].to = points[static_cast<std::size_t>(springs_[i].to)];
  }
  const StageTimer timer(execution.cost, "search");
  // Windows are counted; the time that passes is billed once, and progress is the minimization's.
  CostLedger counted;
  const Execution own{execution.cancellation, nullptr, execution.cost ? &counted : nullptr};
  const std::shared_ptr<FoundPaths> found = unused_paths();
  const bool known = options_.kept_strips && last_;
  if (known)
    for (std::size_t i = 0; i < springs_.size(); ++i) found->geodesics[i].strip = last_->geodesics[i].strip;
  const surface::PathsFound counts = solver_.tangent_geodesics(pairs_, found->geodesics, known, own);
  if (options_.mollifier_length > 0) find_mollified(*found, own);
  if (CostLedger* cost = execution.cost) {
    for (const auto& quantity : counted.quantities()) cost->add_quantity(quantity.name, quantity.value);
    cost->add_quantity("same_face", static_cast<double>(counts.same_face));
    cost->add_quantity("unfolded", static_cast<double>(counts.unfolded));
    cost->add_quantity("searched", static_cast<double>(counts.searched));
  }
  last_ = found;
  state.set_found(found);
}

std::shared_ptr<FoundPaths> GeodesicSprings::unused_paths() {
  // States come and go; what the ones that went have left is used again, since new memory costs as much as a search.
  for (const auto& paths : kept_paths_)
    if (paths.use_count() == 1) return paths;
  auto paths = std::make_shared<FoundPaths>();
  paths->geodesics.resize(springs_.size());
  if (kept_paths_.size() < most_kept_paths) kept_paths_.push_back(paths);
  return paths;
}

void GeodesicSprings::find_mollified(FoundPaths& found, const Execution& execution) const {
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

SpringElement GeodesicSprings::element_of(const FoundPaths& found, std::size_t spring, int order) const {
  const surface::TangentGeodesic& geodesic = found.geodesics[spring];
  if (geodesic.coincident()) return spring_element_at_zero(springs_[spring], geodesic.turn, spring);
  if (!found.mollified.empty()) return spring_element(springs_[spring], found.mollified[spring]);
  return spring_element(springs_[spring], length_derivatives(geodesic, order >= 2));
}

void GeodesicSprings::add(const NetworkState& state, int order, numerics::EnergySum& sum) const {
  const FoundPaths& found = *state.found();
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    SpringElement element = element_of(found, i, order);
    if (order >= 1 && !found.geodesics[i].coincident()) {
      if (state.on_tip(static_cast<std::size_t>(springs_[i].from))) take_out(element, 0);
      if (state.on_tip(static_cast<std::size_t>(springs_[i].to))) take_out(element, 1);
    }
    element.add_to(sum, order);
  }
  if (order < 1) return;
  for (const std::size_t point : free_)
    if (state.on_tip(point)) add_on_tip(state, point, order, sum);
}

void GeodesicSprings::add_on_tip(const NetworkState& state, std::size_t point, int order,
                                 numerics::EnergySum& sum) const {
  Arrivals arrivals;
  bool parted = false;
  for (const std::int32_t i : springs_at_[point]) {
    const Spring& spring = springs_[static_cast<std::size_t>(i)];
    const surface::TangentGeodesic& geodesic = state.found()->geodesics[static_cast<std::size_t>(i)];
    if (geodesic.coincident()) continue;
    parted = true;
    const double angle = static_cast<std::size_t>(spring.from) == point ? geodesic.from_angle : geodesic.to_angle;
    if (std::isfinite(angle)) arrivals.push_back({angle, pull_of(spring, geodesic.distance)});
  }
  // Springs to points in the same place are differentiable there.
  if (!parted) return;
  const surface::VertexCone cone(state.mesh(), state.vertex_of(point));
  const auto row = 2 * static_cast<Eigen::Index>(point);
  if (!arrivals.empty()) {
    const surface::SteepestDescent descent = surface::steepest_descent(cone, arrivals);
    double pulls = 0;
    for (const surface::ArrivingPath& arrival : arrivals) pulls += std::abs(arrival.weight);
    if (descent.slope < -slope_rounding * pulls)
      sum.gradient.segment<2>(row) += descent.slope * surface::cone_coordinates(cone, descent.angle);
  }
  if (order < 2) return;
  // The Hessian of flat pieces: the way down is as long as if the surface were flat.
  double stiffness = 0;
  for (const std::int32_t spring : springs_at_[point])
    stiffness += 2 * springs_[static_cast<std::size_t>(spring)].weight;
  for (int k = 0; k < 2; ++k) sum.hessian.add(row + k, row + k, stiffness);
}

bool GeodesicSprings::rests_at(const NetworkState& state, std::size_t point, std::int32_t vertex) const {
  const surface::SurfacePoint at = surface::vertex_point(state.mesh(), VertexId{vertex});
  const surface::VertexCone cone(state.mesh(), vertex);
  Arrivals arrivals;
  for (const std::int32_t i : springs_at_[point]) {
    const Spring& spring = springs_[static_cast<std::size_t>(i)];
    const auto other =
        static_cast<std::size_t>(static_cast<std::size_t>(spring.from) == point ? spring.to : spring.from);
    const surface::PointPair pair{at, state.points()[other]};
    surface::TangentGeodesic found;
    solver_.tangent_geodesics({&pair, 1}, {&found, 1}, false);
    if (found.coincident()) {
      // A point in one place with another rests with it, unless their spring pushes them apart.
      if (spring.rest_length > 0) return false;
      continue;
    }
    if (std::isfinite(found.from_angle)) arrivals.push_back({found.from_angle, pull_of(spring, found.distance)});
  }
  return !arrivals.empty() && surface::steepest_descent(cone, arrivals).slope >= 0;
}

std::vector<std::size_t> GeodesicSprings::surprised(const NetworkState& current, const NetworkState& whole) const {
  if (!current.found() || !whole.found() || whole.last_step().size() == 0) return {};
  std::vector<double> excess(springs_at_.size(), 0);
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const SpringElement before = element_of(*current.found(), i, 2);
    Eigen::Vector4d step;
    for (int k = 0; k < 4; ++k) step[k] = whole.last_step()[before.rows[static_cast<std::size_t>(k)]];
    const double foretold = before.value + before.gradient.dot(step) + 0.5 * step.dot(before.hessian * step);
    const double more = element_of(*whole.found(), i, 0).value - foretold;
    for (const std::int32_t end : {springs_[i].from, springs_[i].to}) excess[static_cast<std::size_t>(end)] += more;
  }
  const double most = *std::ranges::max_element(excess);
  std::vector<std::size_t> points;
  for (std::size_t i = 0; i < excess.size(); ++i)
    if (!held_[i] && excess[i] > share_of_surprise * most) points.push_back(i);
  std::ranges::stable_sort(points, std::ranges::greater(), [&](std::size_t i) { return excess[i]; });
  if (points.size() > most_surprised) points.resize(most_surprised);
  return points;
}

void GeodesicSprings::settle(NetworkState& state, const std::vector<std::size_t>& points,
                             const NetworkState& starts) const {
  for (const std::size_t i : points) {
    Network own;
    own.points.push_back(starts.points()[i]);
    double stiffness = 0;
    for (const std::int32_t s : springs_at_[i]) {
      const Spring& spring = springs_[static_cast<std::size_t>(s)];
      const auto other = static_cast<std::size_t>(spring.from) == i ? spring.to : spring.from;
      own.springs.push_back({0, static_cast<std::int32_t>(own.points.size()), spring.rest_length, spring.weight});
      own.points.push_back(state.points()[static_cast<std::size_t>(other)]);
      stiffness += 2 * spring.weight;
    }
    std::vector<bool> held(own.points.size(), true);
    held.front() = false;
    std::vector<bool> held_coordinates(2 * held.size(), true);
    held_coordinates[0] = held_coordinates[1] = false;
    numerics::System<NetworkState> system(NetworkState(state.mesh(), own.points),
                                          {std::make_shared<GeodesicSprings>(solver_, own, held, options_)},
                                          numerics::Unknowns(held_coordinates));
    numerics::MinimizerOptions few;
    few.max_iterations = most_local_iterations;
    few.gradient_tolerance = local_tolerance * stiffness * state.mesh().mean_edge_length();
    numerics::minimize(system, few);
    state.place(i, system.state().points().front());
  }
}

std::vector<GeodesicSprings::Kink> GeodesicSprings::kinks_of(std::size_t point, const NetworkState& current,
                                                             const std::vector<NetworkState>& tried) const {
  if (current.on_tip(point)) return {};
  const surface::TriangleMesh& mesh = current.mesh();
  const Eigen::Vector3d here = surface::position(mesh, current.points()[point]);
  std::vector<Kink> kinks;
  const auto look_at_face = [&](FaceId face, double reach) {
    for (const std::int32_t vertex : mesh.faces()[index(face)]) {
      const double away = (mesh.positions()[vertex] - here).norm();
      if (away > reach || std::ranges::find(kinks, vertex, &Kink::id) != kinks.end()) continue;
      if (!surface::VertexCone(mesh, vertex).bends_paths() || !rests_at(current, point, vertex)) continue;
      kinks.push_back({current, vertex, away, away <= point_rounding * mesh.mean_edge_length()});
      kinks.back().state.place(point, surface::vertex_point(mesh, VertexId{vertex}));
    }
  };
  for (const NetworkState& state : tried) {
    const double way = (surface::position(mesh, state.points()[point]) - here).norm();
    if (!(way > 0)) continue;
    look_at_face(state.points()[point].face, reach_of_kinks * way);
    look_at_face(current.points()[point].face, reach_of_kinks * way);
  }
  return kinks;
}

std::vector<GeodesicSprings::Kink> GeodesicSprings::kinks(const NetworkState& current,
                                                          const std::vector<NetworkState>& tried,
                                                          double /*reach*/) const {
  if (tried.empty()) return {};
  if (free_.size() == 1) return kinks_of(free_.front(), current, tried);
  // After so many trials the way down is no longer blocked by a few points.
  if (tried.size() > most_trials) return {};
  const NetworkState& whole = tried.front();
  const std::vector<std::size_t> points = surprised(current, whole);
  if (points.empty()) return {};
  const auto trials = static_cast<std::int64_t>(tried.size());
  std::vector<Kink> kinks;
  kinks.push_back({whole, 2 * trials, whole.last_step().norm(), false});
  settle(kinks.back().state, points, tried.back());
  // Where these points and the others do not suit each other yet, the last trial with these points settled is better
  // than the trial.
  kinks.push_back({tried.back(), 2 * trials + 1, tried.back().last_step().norm(), false});
  settle(kinks.back().state, points, tried.back());
  return kinks;
}

void GeodesicSprings::bill(CostLedger& cost, double seconds) const {
  cost.add_stage("assembly", seconds);
  cost.add_effect(name(), true, "the springs follow shortest paths on the surface", 1, seconds);
}

}  // namespace supple::embedded
