#include "geodesic_springs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "spring_energy.h"

namespace supple::embedded {
namespace {

/// A vertex within this many times the way of a point since the last accepted state may be where it wants to rest.
constexpr double reach_of_kinks = 2;
/// Points nearer to a vertex than this, in mean edges, are at it but for rounding.
constexpr double point_rounding = 1e-13;
/// Of many points that may rest at vertices, so many are tried one by one where all at once do not lower the energy.
constexpr std::size_t most_single_kinks = 4;
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
}

void GeodesicSprings::prepare(NetworkState& state, int /*order*/, const Execution& execution) {
  if (state.found()) return;
  const auto& points = state.points();
  std::vector<surface::PointPair> pairs(springs_.size());
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    pairs[i].from = points[static_cast<std::size_t>(springs_[i].from)];
    pairs[i].to = points[static_cast<std::size_t>(springs_[i].to)];
  }
  const StageTimer timer(execution.cost, "search");
  // Windows are counted; the time that passes is billed once, and progress is the minimization's.
  CostLedger counted;
  const Execution own{execution.cancellation, nullptr, execution.cost ? &counted : nullptr};
  auto found = std::make_shared<FoundPaths>();
  found->geodesics.resize(springs_.size());
  const bool known = options_.kept_strips && last_;
  if (known)
    for (std::size_t i = 0; i < springs_.size(); ++i) found->geodesics[i].strip = last_->geodesics[i].strip;
  const surface::PathsFound counts = solver_.tangent_geodesics(pairs, found->geodesics, known, own);
  if (options_.mollifier_length > 0) find_mollified(pairs, *found, own);
  if (CostLedger* cost = execution.cost) {
    for (const auto& quantity : counted.quantities()) cost->add_quantity(quantity.name, quantity.value);
    cost->add_quantity("same_face", static_cast<double>(counts.same_face));
    cost->add_quantity("unfolded", static_cast<double>(counts.unfolded));
    cost->add_quantity("searched", static_cast<double>(counts.searched));
  }
  last_ = found;
  state.set_found(std::move(found));
}

void GeodesicSprings::find_mollified(const std::vector<surface::PointPair>& pairs, FoundPaths& found,
                                     const Execution& execution) const {
  surface::GeodesicOptions options;
  options.derivatives = 2;
  options.mollifier = options_.mollifier_length;
  std::vector<surface::Geodesic> geodesics(pairs.size());
  solver_.pairs(pairs, geodesics, options, execution);
  found.mollified.resize(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!geodesics[i].derivatives || !geodesics[i].mollified_distance) continue;
    found.mollified[i] = {*geodesics[i].mollified_distance, geodesics[i].derivatives->tangent_gradient,
                          geodesics[i].derivatives->tangent_hessian};
  }
}

void GeodesicSprings::add(const NetworkState& state, int order, numerics::EnergySum& sum) const {
  const FoundPaths& found = *state.found();
  std::vector<std::pair<std::size_t, Arrivals>> tips;
  const auto arrivals_at = [&](std::size_t point) -> Arrivals& {
    const auto known = std::ranges::find(tips, point, &std::pair<std::size_t, Arrivals>::first);
    return known != tips.end() ? known->second : tips.emplace_back(point, Arrivals{}).second;
  };
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const Spring& spring = springs_[i];
    const surface::TangentGeodesic& geodesic = found.geodesics[i];
    SpringElement element;
    if (geodesic.coincident())
      element = spring_element_at_zero(spring, geodesic.turn, i);
    else if (!found.mollified.empty())
      element = spring_element(spring, found.mollified[i]);
    else
      element = spring_element(spring, length_derivatives(geodesic, order >= 2));
    if (order >= 1 && !geodesic.coincident()) {
      const std::array<std::pair<std::size_t, double>, 2> ends = {
          {{static_cast<std::size_t>(spring.from), geodesic.from_angle},
           {static_cast<std::size_t>(spring.to), geodesic.to_angle}}};
      for (int end = 0; end < 2; ++end) {
        const auto& [point, angle] = ends[static_cast<std::size_t>(end)];
        if (!state.on_tip(point)) continue;
        take_out(element, end);
        Arrivals& arrivals = arrivals_at(point);
        if (std::isfinite(angle)) arrivals.push_back({angle, pull_of(spring, geodesic.distance)});
      }
    }
    element.add_to(sum, order);
  }
  for (const auto& [point, arrivals] : tips) add_on_tip(state, point, arrivals, order, sum);
}

void GeodesicSprings::add_on_tip(const NetworkState& state, std::size_t point, const Arrivals& arrivals, int order,
                                 numerics::EnergySum& sum) const {
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

std::vector<GeodesicSprings::Kink> GeodesicSprings::kinks(const NetworkState& current,
                                                          const std::vector<NetworkState>& tried,
                                                          double /*reach*/) const {
  const surface::TriangleMesh& mesh = current.mesh();
  struct Rest {
    std::size_t point;
    std::int32_t vertex;
    double away;
  };
  std::vector<Rest> rests;
  for (std::size_t i = 0; i < current.points().size(); ++i) {
    if (held_[i] || current.on_tip(i) || springs_at_[i].empty()) continue;
    const Eigen::Vector3d here = surface::position(mesh, current.points()[i]);
    std::vector<std::int32_t> asked;
    std::optional<Rest> nearest;
    const auto look_at_face = [&](FaceId face, double reach) {
      for (const std::int32_t vertex : mesh.faces()[index(face)]) {
        const double away = (mesh.positions()[vertex] - here).norm();
        if (away > reach || (nearest && away >= nearest->away) || std::ranges::find(asked, vertex) != asked.end())
          continue;
        asked.push_back(vertex);
        if (!surface::VertexCone(mesh, vertex).bends_paths() || !rests_at(current, i, vertex)) continue;
        nearest = Rest{i, vertex, away};
      }
    };
    for (const NetworkState& state : tried) {
      const double way = (surface::position(mesh, state.points()[i]) - here).norm();
      if (!(way > 0)) continue;
      look_at_face(state.points()[i].face, reach_of_kinks * way);
      look_at_face(current.points()[i].face, reach_of_kinks * way);
    }
    if (nearest) rests.push_back(*nearest);
  }
  if (rests.empty()) return {};
  std::ranges::stable_sort(rests, {}, &Rest::away);
  std::vector<Kink> kinks;
  const auto offer = [&](std::span<const Rest> chosen) {
    Kink kink{current, 0, 0, true};
    std::uint64_t id = 0;
    for (const Rest& rest : chosen) {
      kink.state.place(rest.point, surface::vertex_point(mesh, VertexId{rest.vertex}));
      kink.distance = std::hypot(kink.distance, rest.away);
      kink.same_place = kink.same_place && rest.away <= point_rounding * mesh.mean_edge_length();
      id = id * 0x9e3779b97f4a7c15ULL + rest.point * 0x100000001b3ULL + static_cast<std::uint64_t>(rest.vertex) + 1;
    }
    kink.id = static_cast<std::int64_t>(id);
    kinks.push_back(std::move(kink));
  };
  offer(rests);
  if (rests.size() > 1)
    for (std::size_t i = 0; i < std::min(rests.size(), most_single_kinks); ++i) offer({&rests[i], 1});
  return kinks;
}

void GeodesicSprings::bill(CostLedger& cost, double seconds) const {
  cost.add_stage("assembly", seconds);
  cost.add_effect(name(), true, "the springs follow shortest paths on the surface", 1, seconds);
}

}  // namespace supple::embedded
