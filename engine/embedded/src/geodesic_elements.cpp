#include "geodesic_elements.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <span>
#include <utility>

#include "cut_loci.h"
#include "supple/base/parallel_tasks.h"
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
/// A barycentric coordinate up to which a point is on the side: rounding leaves one there that slides along it.
constexpr double on_border = 1e-12;
/// Paths whose derivatives by the host's nodes one task works out.
constexpr std::size_t paths_of_a_task = 4;
/// What was found for so many states is kept for others to come.
constexpr std::size_t most_kept_paths = 8;
/// How much stiffer than along it points are across a cut locus: a Newton step then leaves it by no more than rounding
/// and its curvature, and factorizations keep the digits that they need.
constexpr double stiffness_across = 1e4;
/// Paths at cut loci that a step crossed and that are tried.
constexpr std::size_t most_crossed = 4;
/// Paths are the same where their gradients differ by less than this.
constexpr double same_path = 1e-4;
/// Of a step, until it is known where it crossed one.
constexpr int halvings = 50;
/// A path is shorter than the one that it was by more than this share, and not by rounding.
constexpr double shorter = 1e-10;
/// Diagonals of the mesh that a point goes at most in one step.
constexpr double longest_way = 4;
/// A slope above this share of the pulls that make it counts as none.
constexpr double slope_rounding = 1e-12;

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
  share_forces(state, equal, sum.gradient, pulls_at(found), held_);
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
  if (kept_paths_.size() < most_kept_paths) kept_paths_.push_back(paths);
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

void GeodesicElements::add(const NetworkState& state, int order, numerics::EnergySum& sum) const {
  if (state.collapsed()) {
    sum.value = std::numeric_limits<double>::infinity();
    return;
  }
  const Walls walls = order >= 1 ? walls_at(state) : Walls();
  add_elements(state, order, walls, sum);
  if (order < 1 || !std::isfinite(sum.value)) return;
  for (const std::size_t point : free_)
    if (state.on_tip(point)) add_on_tip(state, point, order, sum);
  if (order >= 2) hold_at_cut_loci(state, sum);
  for (const Wall& wall : walls) {
    if (order < 2) break;
    // Nothing moves there: any stiffness will do.
    const double stiffness = stiffness_at(static_cast<std::size_t>(wall.point));
    for (int k = 0; k < 2; ++k)
      for (int l = 0; l <= k; ++l)
        sum.hessian.add(2 * wall.point + k, 2 * wall.point + l, stiffness * wall.out[k] * wall.out[l]);
  }
}

void GeodesicElements::hold_at_cut_loci(const NetworkState& state, numerics::EnergySum& sum) const {
  for (const EqualPaths& equal : state.found()->equal) {
    const auto from = static_cast<std::size_t>(paths_[equal.path].from);
    const auto to = static_cast<std::size_t>(paths_[equal.path].to);
    const double stiffness = stiffness_across * (stiffness_at(from) + stiffness_at(to));
    SpringElement element({paths_[equal.path].from, paths_[equal.path].to});
    for (const Eigen::Vector4d& across : equal.across) element.hessian += stiffness * across * across.transpose();
    element.add_to(sum, 2);
  }
}

void GeodesicElements::add_elements(const NetworkState& state, int order, const Walls& walls,
                                    numerics::EnergySum& sum) const {
  if (state.surface()) {
    add_on_host(state, order, walls, sum);
  } else {
    add_on_rigid_host(state, order, walls, sum);
  }
}

GeodesicElements::Walls GeodesicElements::walls_at(const NetworkState& state) const {
  Walls walls;
  const surface::TriangleMesh& mesh = state.mesh();
  for (const std::size_t point : free_) {
    if (state.on_tip(point)) continue;
    const surface::SurfacePoint& at = state.points()[point];
    for (int corner = 0; corner < 3; ++corner) {
      // The side opposite a corner is that of the next one.
      const std::int32_t side = 3 * index(at.face) + (corner + 1) % 3;
      if (at.barycentric[corner] > on_border || mesh.twin(side) >= 0) continue;
      const Eigen::Matrix<double, 3, 2> frame = surface::tangent_frame(mesh, at.face);
      const Eigen::Vector2d along =
          frame.transpose() * (mesh.positions()[mesh.head(side)] - mesh.positions()[mesh.tail(side)]);
      walls.push_back({static_cast<std::int32_t>(point), Eigen::Vector2d(along.y(), -along.x()).normalized()});
      break;
    }
  }
  if (walls.empty()) return walls;
  // Those that are pushed inwards, or not at all, are free.
  numerics::EnergySum free;
  free.clear(state.dimension(), 1);
  add_elements(state, 1, {}, free);
  std::erase_if(walls, [&](const Wall& wall) {
    return !std::isfinite(free.value) || !(free.gradient.segment<2>(2 * wall.point).dot(wall.out) < 0);
  });
  return walls;
}

const GeodesicElements::Wall* GeodesicElements::wall_of(const Walls& walls, std::int32_t point) {
  const auto found = std::ranges::lower_bound(walls, point, {}, &Wall::point);
  return found != walls.end() && found->point == point ? &*found : nullptr;
}

void GeodesicElements::add_on_rigid_host(const NetworkState& state, int order, const Walls& walls,
                                         numerics::EnergySum& sum) const {
  const FoundPaths& found = *state.found();
  const auto as_free = [&](auto& element, int corner, std::int32_t point) {
    if (order < 1) return;
    if (state.on_tip(static_cast<std::size_t>(point))) element.take_out(corner);
    if (const Wall* wall = wall_of(walls, point)) element.hold(corner, wall->out);
  };
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    SpringElement element = spring_at(found, i, order);
    if (!found.geodesics[i].coincident()) {
      as_free(element, 0, springs_[i].from);
      as_free(element, 1, springs_[i].to);
    }
    element.add_to(sum, order);
  }
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    TriangleElement element = triangle_at(found, t, order);
    for (int k = 0; k < 3; ++k) as_free(element, k, triangles_[t].given.corners[static_cast<std::size_t>(k)]);
    element.add_to(sum, order);
  }
}

void GeodesicElements::add_on_host(const NetworkState& state, int order, const Walls& walls,
                                   numerics::EnergySum& sum) const {
  const auto as_free = [&](HostElement element, std::span<const std::int32_t> points) {
    for (const std::int32_t point : points) {
      if (order < 1) break;
      if (state.on_tip(static_cast<std::size_t>(point))) element.take_out(point);
      if (const Wall* wall = wall_of(walls, point)) element.hold(point, wall->out);
    }
    return element;
  };
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    if (state.found()->geodesics[i].coincident()) {
      // One place of the material stays one place, however the host moves.
      spring_at(*state.found(), i, order).add_to(sum, order);
      continue;
    }
    const std::array<std::int32_t, 2> ends{springs_[i].from, springs_[i].to};
    as_free(host_spring_at(state, i, order, sum.convex), ends).add_to(sum, order);
  }
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const HostElement element = host_triangle_at(state, t, order, sum.convex);
    if (!std::isfinite(element.value)) {
      sum.value = element.value;
      return;
    }
    as_free(element, triangles_[t].given.corners).add_to(sum, order);
  }
}

GeodesicElements::Arrivals GeodesicElements::arrivals_at(std::size_t point, const PathOf& path) const {
  Arrivals arrivals;
  const auto arrive = [&](const surface::TangentGeodesic& geodesic, std::size_t number, double pull) {
    if (geodesic.coincident()) return;
    arrivals.parted = true;
    const double angle =
        static_cast<std::size_t>(paths_[number].from) == point ? geodesic.from_angle : geodesic.to_angle;
    if (std::isfinite(angle)) arrivals.paths.push_back({angle, pull});
  };
  for (const std::int32_t s : springs_at_[point]) {
    const auto i = static_cast<std::size_t>(s);
    const surface::TangentGeodesic& geodesic = path(i);
    arrive(geodesic, i, 2 * springs_[i].weight * (geodesic.distance - springs_[i].rest_length));
    arrivals.stiffness += 2 * springs_[i].weight;
    // Points in one place rest together, unless their spring pushes them apart.
    if (geodesic.coincident() && springs_[i].rest_length > 0) arrivals.valid = false;
  }
  for (const std::int32_t t : triangles_at_[point]) {
    const Triangle& triangle = triangles_[static_cast<std::size_t>(t)];
    Eigen::Vector3d lengths;
    for (int k = 0; k < 3; ++k) lengths[k] = path(triangle.sides[static_cast<std::size_t>(k)].path).distance;
    const TriangleEnergy::Value energy = triangle.energy.at(lengths);
    arrivals.valid = arrivals.valid && std::isfinite(energy.energy);
    for (int k = 0; k < 3; ++k) {
      const Side& side = triangle.sides[static_cast<std::size_t>(k)];
      const Ends& ends = paths_[side.path];
      if (static_cast<std::size_t>(ends.from) != point && static_cast<std::size_t>(ends.to) != point) continue;
      arrive(path(side.path), side.path, energy.first[k]);
      arrivals.stiffness += std::max(0.0, energy.second(k, k));
    }
  }
  return arrivals;
}

void GeodesicElements::add_on_tip(const NetworkState& state, std::size_t point, int order,
                                  numerics::EnergySum& sum) const {
  const FoundPaths& found = *state.found();
  const Arrivals arrivals =
      arrivals_at(point, [&](std::size_t path) -> const surface::TangentGeodesic& { return found.geodesics[path]; });
  // Springs to points in the same place are differentiable there.
  if (!arrivals.parted) return;
  const surface::VertexCone cone(state.mesh(), state.vertex_of(point));
  const auto row = 2 * static_cast<Eigen::Index>(point);
  if (!arrivals.paths.empty()) {
    const surface::SteepestDescent descent = surface::steepest_descent(cone, arrivals.paths);
    double pulls = 0;
    for (const surface::ArrivingPath& arrival : arrivals.paths) pulls += std::abs(arrival.weight);
    if (descent.slope < -slope_rounding * pulls)
      sum.gradient.segment<2>(row) += descent.slope * surface::cone_coordinates(cone, descent.angle);
  }
  if (order < 2) return;
  // The Hessian of flat pieces: the way down is as long as if the surface were flat.
  for (int k = 0; k < 2; ++k) sum.hessian.add(row + k, row + k, arrivals.stiffness);
}

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

/// By how much an element's energy after a step exceeds what its derivatives before foretold.
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
  if (points.size() > most_surprised) points.resize(most_surprised);
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
    few.max_iterations = most_local_iterations;
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
    } else if (kinks.size() < most_crossed) {
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

std::vector<GeodesicElements::Kink> GeodesicElements::kinks(const NetworkState& current,
                                                            const std::vector<NetworkState>& tried,
                                                            double /*reach*/) const {
  if (tried.empty()) return {};
  std::vector<Kink> kinks = cut_loci_crossed(current, tried);
  if (free_.size() == 1) {
    std::ranges::move(kinks_of(free_.front(), current, tried), std::back_inserter(kinks));
    return kinks;
  }
  // After so many trials the way down is no longer blocked by a few points.
  if (tried.size() > most_trials) return kinks;
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
