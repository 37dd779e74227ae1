// Where the energy has kinks near a step: states at vertices and cut loci to which no line search leads.
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <utility>

#include "cut_loci.h"
#include "geodesic_elements.h"
#include "supple/numerics/minimizer.h"

namespace supple::embedded {
namespace {

/// A vertex within this many times the way of a point since the last accepted state may be where it wants to rest.
constexpr double reach_of_kinks = 2;
/// Points nearer to a vertex than this, in mean edges, are at it but for rounding.
constexpr double point_rounding = 1e-13;
/// The direction of a vertex is known to a share of its distance. Nearer to it than this, in mean edges, a step that is
/// to pass it on one side may pass it on the other.
constexpr double beside_vertex = 1e-9;
/// A point is in the way where the energy of its springs exceeds what was foretold by at least this share of the worst
/// point's excess. More points than the limit are not worth the time.
constexpr double share_of_surprise = 0.02;
constexpr std::size_t max_surprised_points = 64;
/// After this many shortened steps no kinks are looked for.
constexpr std::size_t max_tried_steps = 8;
/// A point by itself is brought near its minimum, no farther: the others move on.
constexpr int max_local_iterations = 12;
constexpr double local_tolerance = 1e-8;
/// So many of the cut loci that a step crossed are tried.
constexpr std::size_t max_crossed_loci = 4;
/// Paths are the same where their gradients differ by less than this.
constexpr double same_path = 1e-4;
/// A step is halved so often to find where it crossed a cut locus.
constexpr int halvings = 50;
/// A path is shorter than the one that it was by more than this share, and not by rounding.
constexpr double shorter = 1e-10;

}  // namespace

bool GeodesicElements::rests_at(const NetworkState& state, std::size_t point, std::int32_t vertex) const {
  const surface::SurfacePoint at = surface::vertex_point(state.mesh(), VertexId{vertex});
  const surface::VertexCone cone(state.mesh(), vertex);
  std::map<std::size_t, surface::TangentGeodesic> from_vertex;
  const auto path = [&](std::size_t number) -> const surface::TangentGeodesic& {
    const Ends& ends = paths_[number];
    const bool starts = static_cast<std::size_t>(ends.from) == point;
    if (!starts && static_cast<std::size_t>(ends.to) != point) return state.found()->geodesics[number];
    const auto [entry, is_new] = from_vertex.try_emplace(number);
    if (is_new) {
      const auto there = [&](std::int32_t end) { return state.points()[static_cast<std::size_t>(end)]; };
      const surface::PointPair pair{starts ? at : there(ends.from), starts ? there(ends.to) : at};
      solver_of(state).tangent_geodesics({&pair, 1}, {&entry->second, 1}, false);
    }
    return entry->second;
  };
  const Arrivals arrivals = arrivals_at(point, path);
  return arrivals.valid && !arrivals.paths.empty() && surface::steepest_descent(cone, arrivals.paths).slope >= 0;
}

namespace {

/// The excess of an element's energy after a step over what its derivatives before the step foretold.
template <class Element>
double excess_of(const Element& before, double after, const Eigen::VectorXd& all_steps) {
  auto step = before.gradient;
  for (Eigen::Index k = 0; k < step.size(); ++k) step[k] = all_steps[before.rows[static_cast<std::size_t>(k)]];
  return after - (before.value + before.gradient.dot(step) + 0.5 * step.dot(before.hessian * step));
}

}  // namespace

std::vector<std::size_t> GeodesicElements::surprised(const NetworkState& current, const NetworkState& whole) const {
  if (!current.found() || !whole.found() || whole.last_step().size() == 0) return {};
  const bool gives_way = current.host_lengths() && current.host_lengths()->order >= 2;
  std::vector<double> excess(springs_at_.size(), 0);
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const double after = spring_at(*whole.found(), i, 0).value;
    const bool parted = !current.found()->geodesics[i].coincident();
    const double more = gives_way && parted ? excess_of(host_spring_at(current, i, 2, false), after, whole.last_step())
                                            : excess_of(spring_at(*current.found(), i, 2), after, whole.last_step());
    for (const std::int32_t end : {springs_[i].from, springs_[i].to}) excess[static_cast<std::size_t>(end)] += more;
  }
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const double after = triangle_at(*whole.found(), t, 0).value;
    const double more = gives_way ? excess_of(host_triangle_at(current, t, 2, false), after, whole.last_step())
                                  : excess_of(triangle_at(*current.found(), t, 2), after, whole.last_step());
    for (const std::int32_t corner : triangles_[t].given.corners) excess[static_cast<std::size_t>(corner)] += more;
  }
  const double most = *std::ranges::max_element(excess);
  std::vector<std::size_t> points;
  for (std::size_t i = 0; i < excess.size(); ++i)
    if (!held_[i] && excess[i] > share_of_surprise * most) points.push_back(i);
  std::ranges::stable_sort(points, std::ranges::greater(), [&](std::size_t i) { return excess[i]; });
  if (points.size() > max_surprised_points) points.resize(max_surprised_points);
  return points;
}

Network GeodesicElements::elements_of(std::size_t point, const NetworkState& state) const {
  Network own;
  own.material = material_;
  std::map<std::int32_t, std::int32_t> number;
  const auto number_of = [&](std::int32_t other) {
    const auto [entry, is_new] = number.try_emplace(other, static_cast<std::int32_t>(own.points.size()));
    if (is_new) own.points.push_back(state.points()[static_cast<std::size_t>(other)]);
    return entry->second;
  };
  number_of(static_cast<std::int32_t>(point));
  for (const std::int32_t s : springs_at_[point]) {
    Spring spring = springs_[static_cast<std::size_t>(s)];
    spring.from = number_of(spring.from);
    spring.to = number_of(spring.to);
    own.springs.push_back(spring);
  }
  for (const std::int32_t t : triangles_at_[point]) {
    MembraneTriangle triangle = triangles_[static_cast<std::size_t>(t)].given;
    for (std::int32_t& corner : triangle.corners) corner = number_of(corner);
    own.triangles.push_back(triangle);
  }
  return own;
}

void GeodesicElements::settle(NetworkState& state, const std::vector<std::size_t>& points,
                              const NetworkState& starts) const {
  for (const std::size_t i : points) {
    Network own = elements_of(i, state);
    own.points.front() = starts.points()[i];
    std::vector<bool> held(own.points.size(), true);
    held.front() = false;
    std::vector<bool> held_coordinates(2 * held.size(), true);
    GeodesicElementsOptions own_options = options_;
    own_options.cut_loci = options_.cut_loci && !state.surface();
    held_coordinates[0] = held_coordinates[1] = false;
    numerics::System<NetworkState> system(
        NetworkState(state.mesh(), own.points),
        {std::make_shared<GeodesicElements>(solver_of(state), own, held, own_options)},
        numerics::Unknowns(held_coordinates));
    // A triangle may be of no area with the others where they are: then there is nothing to settle from.
    if (!std::isfinite(system.evaluate(0).value)) continue;
    numerics::MinimizerOptions few;
    few.max_iterations = max_local_iterations;
    few.gradient_tolerance = local_tolerance * stiffness_at(i) * state.mesh().mean_edge_length();
    numerics::minimize(system, few);
    state.place(i, system.state().points().front());
  }
}

double GeodesicElements::stiffness_at(std::size_t point) const {
  double stiffness = 0;
  for (const std::int32_t s : springs_at_[point]) stiffness += 2 * springs_[static_cast<std::size_t>(s)].weight;
  // The second derivative of a triangle's energy by its lengths is about that.
  return stiffness + material_.youngs_modulus * material_.thickness * static_cast<double>(triangles_at_[point].size());
}

std::vector<GeodesicElements::Kink> GeodesicElements::kinks_of(std::size_t point, const NetworkState& current,
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

namespace {

/// All that are known between the ends of a path.
std::vector<surface::TangentGeodesic> shortest_paths(const FoundPaths& found, std::size_t path) {
  if (const EqualPaths* equal = found.equal_to(path)) return equal->geodesics;
  return {found.geodesics[path]};
}

}  // namespace

std::optional<GeodesicElements::Crossed> GeodesicElements::cut_locus_crossed(std::size_t path, double pull,
                                                                             const NetworkState& current,
                                                                             const NetworkState& there) const {
  if (current.found()->geodesics[path].coincident() || there.found()->geodesics[path].coincident()) return std::nullopt;
  const auto [from, to] = paths_[path];
  Eigen::Vector4d step;
  step << there.last_step().segment<2>(2 * from), there.last_step().segment<2>(2 * to);
  const std::vector<surface::TangentGeodesic> before = shortest_paths(*current.found(), path);
  std::optional<Crossed> nearest;
  for (const surface::TangentGeodesic& after : shortest_paths(*there.found(), path)) {
    const surface::TangentGeodesic other =
        after.before_turns(there.turn(static_cast<std::size_t>(from)), there.turn(static_cast<std::size_t>(to)));
    const Eigen::Vector4d slope = other.continued(-step).gradient();
    if (std::ranges::any_of(before, [&](const auto& one) { return (one.gradient() - slope).norm() < same_path; }))
      continue;
    const auto excess = [&](double share) {
      // Those before are equally long: where one of them is left for another, that one becomes longer than both.
      double longest = 0;
      for (const surface::TangentGeodesic& one : before)
        longest = std::max(longest, one.continued(share * step).distance);
      return longest - other.continued((share - 1) * step).distance;
    };
    if (!(excess(1) > shorter * other.distance)) continue;
    const bool in_place = std::abs(excess(0)) <= shorter * other.distance;
    if (!in_place && !(excess(0) < 0)) continue;
    double low = 0, high = in_place ? 0 : 1;
    for (int k = 0; k < halvings && !in_place; ++k) {
      const double middle = 0.5 * (low + high);
      (excess(middle) < 0 ? low : high) = middle;
    }
    if (nearest && nearest->share <= high) continue;
    std::vector<surface::TangentGeodesic> equal;
    equal.reserve(before.size() + 1);
    for (const surface::TangentGeodesic& one : before) equal.push_back(one.continued(high * step));
    equal.push_back(other.continued((high - 1) * step));
    CutLocus locus{path, from, to};
    locus.for_next_step = in_place;
    locus.sides = sides_of(equal, locus, held_);
    if (!locus.sides.empty()) nearest = Crossed{-pull * excess(1), high, std::move(locus)};
  }
  return nearest;
}

std::vector<GeodesicElements::CrossedOnWay> GeodesicElements::cut_loci_on_ways(
    const NetworkState& current, const std::vector<NetworkState>& tried) const {
  std::vector<CrossedOnWay> crossed;
  const std::vector<double> pulls = pulls_at(*current.found());
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    const auto a = static_cast<std::size_t>(paths_[i].from);
    const auto b = static_cast<std::size_t>(paths_[i].to);
    if (!(pulls[i] < 0) || (held_[a] && held_[b]) || current.on_tip(a) || current.on_tip(b)) continue;
    // The nearest.
    for (auto there = tried.rbegin(); there != tried.rend(); ++there) {
      if (!there->found() || there->on_tip(a) || there->on_tip(b)) continue;
      auto one = cut_locus_crossed(i, pulls[i], current, *there);
      if (!one) continue;
      crossed.push_back({std::move(*one), there->last_step()});
      break;
    }
  }
  std::ranges::stable_sort(crossed, std::ranges::greater(),
                           [](const CrossedOnWay& one) { return one.crossed.surprise; });
  return crossed;
}

std::vector<GeodesicElements::Kink> GeodesicElements::cut_loci_crossed(const NetworkState& current,
                                                                       const std::vector<NetworkState>& tried) const {
  if (!options_.cut_loci || current.surface() || !current.found() || !current.found()->mollified.empty()) return {};
  std::vector<Kink> kinks;
  // All that the points are at already are one kink.
  std::optional<Kink> in_place;
  const auto add_to = [](NetworkState& state, const CutLocus& locus) {
    std::vector<CutLocus> loci = state.cut_loci();
    std::erase_if(loci, [&](const CutLocus& other) { return other.path == locus.path; });
    loci.insert(std::ranges::upper_bound(loci, locus.path, {}, &CutLocus::path), locus);
    state.set_cut_loci(std::move(loci));
  };
  for (const auto& [crossed, step] : cut_loci_on_ways(current, tried)) {
    if (crossed.locus.for_next_step) {
      if (!in_place) {
        in_place = Kink{current, -1 - static_cast<std::int64_t>(paths_.size()), 0, true};
        in_place->state.move(Eigen::VectorXd::Zero(current.dimension()));
      }
      add_to(in_place->state, crossed.locus);
    } else if (kinks.size() < max_crossed_loci) {
      const Eigen::VectorXd way = crossed.share * step;
      Kink& kink =
          kinks.emplace_back(Kink{current, -1 - static_cast<std::int64_t>(crossed.locus.path), way.norm(), false});
      add_to(kink.state, crossed.locus);
      kink.state.move(way);
    }
  }
  if (in_place) kinks.push_back(std::move(*in_place));
  return kinks;
}

std::optional<GeodesicElements::Kink> GeodesicElements::points_put_at_vertices(const NetworkState& current) const {
  const surface::TriangleMesh& mesh = current.mesh();
  std::optional<Kink> kink;
  for (const std::size_t i : free_) {
    if (current.on_tip(i)) continue;
    const surface::SurfacePoint& point = current.points()[i];
    const Eigen::Vector3d here = surface::position(mesh, point);
    for (const std::int32_t vertex : mesh.faces()[index(point.face)]) {
      if ((mesh.positions()[vertex] - here).norm() > beside_vertex * mesh.mean_edge_length()) continue;
      if (!surface::VertexCone(mesh, vertex).bends_paths()) continue;
      if (!kink) kink = Kink{current, -2 - static_cast<std::int64_t>(paths_.size()), 0, true};
      kink->state.place(i, surface::vertex_point(mesh, VertexId{vertex}));
      break;
    }
  }
  return kink;
}

std::vector<GeodesicElements::Kink> GeodesicElements::kinks(const NetworkState& current,
                                                            const std::vector<NetworkState>& tried,
                                                            double /*reach*/) const {
  if (tried.empty()) return {};
  std::vector<Kink> kinks = cut_loci_crossed(current, tried);
  if (auto at_vertices = points_put_at_vertices(current)) kinks.push_back(std::move(*at_vertices));
  if (free_.size() == 1) {
    std::ranges::move(kinks_of(free_.front(), current, tried), std::back_inserter(kinks));
    return kinks;
  }
  // After so many trials the way down is no longer blocked by a few points.
  if (tried.size() > max_tried_steps) return kinks;
  const NetworkState& whole = tried.front();
  const std::vector<std::size_t> points = surprised(current, whole);
  if (points.empty()) return kinks;
  const auto trials = static_cast<std::int64_t>(tried.size());
  kinks.push_back({whole, 2 * trials, whole.last_step().norm(), false});
  settle(kinks.back().state, points, tried.back());
  // Where these points and the others do not suit each other yet, the last trial with these points settled is better
  // than the trial.
  kinks.push_back({tried.back(), 2 * trials + 1, tried.back().last_step().norm(), false});
  settle(kinks.back().state, points, tried.back());
  return kinks;
}

}  // namespace supple::embedded
