#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "geodesic_elements.h"
#include "relaxation_run.h"
#include "supple/base/random.h"

namespace supple::embedded {
namespace {

/// Iterations of one search with some points held.
constexpr int max_held_iterations = 50;
/// A round that lowers the energy by less than this share is the last one: steps to and fro across a valley gain as
/// much again and again.
constexpr double smallest_gain = 1e-6;
/// Lengths in mean edges by which jammed points are moved, the longest first.
constexpr std::array trial_lengths{0.3, 0.03, 3e-3, 3e-4};
/// Directions of a single point all around, and of several points together.
constexpr int directions_of_one = 12;
constexpr int directions_of_several = 24;
/// How often a group moves on before others have their turn.
constexpr int max_moves_of_a_group = 20;
/// Groups that are tried between two searches: with more, the search is the better judge.
constexpr std::size_t max_groups = 64;

/// The elements that move with some points, which become the first points of the result, in their order.
Network elements_with(const Network& network, const std::vector<std::int32_t>& group,
                      const std::vector<surface::SurfacePoint>& points) {
  Network own;
  own.material = network.material;
  std::vector<std::int32_t> number(network.points.size(), -1);
  const auto number_of = [&](std::int32_t point) {
    std::int32_t& known = number[static_cast<std::size_t>(point)];
    if (known < 0) {
      known = static_cast<std::int32_t>(own.points.size());
      own.points.push_back(points[static_cast<std::size_t>(point)]);
    }
    return known;
  };
  for (const std::int32_t point : group) number_of(point);
  const auto in_group = [&](std::int32_t point) {
    const std::int32_t known = number[static_cast<std::size_t>(point)];
    return known >= 0 && static_cast<std::size_t>(known) < group.size();
  };
  for (Spring spring : network.springs) {
    if (!(spring.weight > 0) || !(in_group(spring.from) || in_group(spring.to))) continue;
    spring.from = number_of(spring.from);
    spring.to = number_of(spring.to);
    own.springs.push_back(spring);
  }
  for (MembraneTriangle triangle : network.triangles) {
    if (std::ranges::none_of(triangle.corners, in_group)) continue;
    for (std::int32_t& corner : triangle.corners) corner = number_of(corner);
    own.triangles.push_back(triangle);
  }
  return own;
}

/// Unit vectors of `size` numbers.
std::vector<Eigen::VectorXd> directions_all_around(Eigen::Index size, std::uint64_t seed) {
  std::vector<Eigen::VectorXd> directions;
  if (size == 2) {
    for (int k = 0; k < directions_of_one; ++k) {
      const double angle = 2 * std::numbers::pi * k / directions_of_one;
      directions.emplace_back(Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
    return directions;
  }
  RandomStream random("directions of jammed points", seed);
  for (int k = 0; k < directions_of_several; ++k) {
    Eigen::VectorXd& direction = directions.emplace_back(size);
    for (double& number : direction) number = random.normal();
    direction.normalize();
  }
  return directions;
}

}  // namespace

/// The ends of paths that push and are at their cut loci can jam all others: a step that is good for these is none for
/// them. So they are held while the others come to rest, then the others while they do, and then all are free again.
/// This is repeated while it lowers the energy and iterations are left. Where it does not, they are moved by
/// themselves. On a host that gives way it is done once: its nodes are pushed across cut loci, too, and cannot be kept
/// there.
RelaxationRun::Stop RelaxationRun::leave_jam(bool mollified, const Execution& execution) {
  auto stop = Stop::step_too_small;
  if (!state_.found()) return stop;
  const int all_iterations = iteration_limit_;
  bool goes_on = true;
  while (goes_on && stop == Stop::step_too_small) {
    const std::vector<bool> jammed = jammed_points();
    if (std::ranges::none_of(jammed, std::identity())) break;
    const double before = result_.energy;
    const auto has_gained = [&] { return result_.energy < before - smallest_gain * std::abs(before); };
    std::vector<bool> without_jammed = points_.held;
    std::vector<bool> without_others = points_.held;
    for (std::size_t i = 0; i < jammed.size(); ++i) (jammed[i] ? without_jammed : without_others)[i] = true;
    for (const auto& held_points : {without_jammed, without_others}) {
      iteration_limit_ = std::min(all_iterations, result_.iterations + max_held_iterations);
      if (may_go_on()) minimize(mollified, execution, held_points);
    }
    iteration_limit_ = all_iterations;
    if (!may_go_on()) return Stop::iteration_limit;
    // Distances that are not mollified say nothing about an energy that is.
    const bool has_moved = !mollified && !has_gained() && move_jammed(jammed);
    stop = minimize(mollified, execution);
    goes_on = !host_.gives_way() && (has_moved || has_gained());
  }
  return stop;
}

std::vector<bool> RelaxationRun::jammed_points() const {
  const GeodesicElements elements(solver(), network_, points_.held, {});
  return elements.ends_that_push_at_cut_loci(*state_.found());
}

bool RelaxationRun::move_jammed(const std::vector<bool>& jammed) {
  std::vector<std::vector<std::int32_t>> groups;
  std::vector<std::int32_t> all;
  for (std::size_t i = 0; i < jammed.size(); ++i)
    if (jammed[i]) all.push_back(static_cast<std::int32_t>(i));
  groups.reserve(all.size());
  for (const std::int32_t point : all) groups.push_back({point});
  const auto is_jammed = [&](std::int32_t point) { return jammed[static_cast<std::size_t>(point)]; };
  const auto add_pair = [&](std::int32_t a, std::int32_t b) {
    if (!is_jammed(a) || !is_jammed(b)) return;
    std::vector<std::int32_t> pair{std::min(a, b), std::max(a, b)};
    if (std::ranges::find(groups, pair) == groups.end()) groups.push_back(std::move(pair));
  };
  for (const Spring& spring : network_.springs)
    if (spring.weight > 0) add_pair(spring.from, spring.to);
  for (const MembraneTriangle& triangle : network_.triangles)
    for (std::size_t k = 0; k < 3; ++k) add_pair(triangle.corners[k], triangle.corners[(k + 1) % 3]);
  if (all.size() > 2) groups.push_back(all);
  bool has_moved = false;
  for (std::size_t k = 0; k < std::min(groups.size(), max_groups); ++k)
    has_moved = move_group(groups[k], k) || has_moved;
  return has_moved;
}

bool RelaxationRun::move_group(const std::vector<std::int32_t>& group, std::uint64_t seed) {
  const Network own = elements_with(network_, group, state_.points());
  GeodesicElements elements(solver(), own, std::vector<bool>(own.points.size(), false),
                            {.kept_strips = keeps_strips(), .cut_loci = false});
  NetworkState best(state_.mesh(), own.points);
  const Execution quiet{execution_.cancellation, nullptr, nullptr};
  const auto energy_of = [&](NetworkState& state) {
    execution_.cancellation.throw_if_requested();
    numerics::EnergySum sum;
    elements.prepare(state, 0, quiet);
    elements.add(state, 0, sum);
    return sum.value;
  };
  double least = energy_of(best);
  const auto size = 2 * static_cast<Eigen::Index>(group.size());
  const std::vector<Eigen::VectorXd> directions = directions_all_around(size, seed);
  Eigen::VectorXd step = Eigen::VectorXd::Zero(best.dimension());
  int moves = 0;
  const auto goes_on = [&](double length) {
    for (const Eigen::VectorXd& direction : directions) {
      step.head(size) = length * direction;
      NetworkState beside = best;
      beside.move(step);
      const double energy = energy_of(beside);
      if (!(energy < least - smallest_gain * std::abs(result_.energy))) continue;
      least = energy;
      best = std::move(beside);
      ++moves;
      return true;
    }
    return false;
  };
  for (const double share : trial_lengths)
    while (moves < max_moves_of_a_group && goes_on(share * state_.mesh().mean_edge_length())) continue;
  if (moves == 0) return false;
  for (std::size_t i = 0; i < group.size(); ++i) state_.place(static_cast<std::size_t>(group[i]), best.points()[i]);
  return true;
}

}  // namespace supple::embedded
