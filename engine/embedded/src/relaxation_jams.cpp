// How a relaxation continues where paths under compression at their cut loci jam the whole network.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "network_energy.h"
#include "relaxation_phases.h"
#include "supple/base/random.h"

namespace supple::embedded {
namespace {

using Termination = numerics::MinimizerTermination;

/// Iterations of one search with some points fixed.
constexpr int max_iterations_with_fixed_points = 50;
/// A pass that lowers the energy by less than this fraction is the last one: steps to and fro across a valley gain as
/// much again and again.
constexpr double min_gain = 1e-6;
/// Lengths in mean edges by which jammed points are moved, the longest first.
constexpr std::array trial_lengths{0.3, 0.03, 3e-3, 3e-4};
/// Number of directions in which a single point is moved, evenly spread, and in which several are moved together.
constexpr int directions_of_one = 12;
constexpr int directions_of_several = 24;
/// Moves of one group before the next group is tried.
constexpr int max_moves_of_a_group = 20;
/// Groups that are tried between two searches.
constexpr std::size_t max_groups = 64;

using Group = std::vector<std::int32_t>;

/// The elements of the points of a group, which become the first points of the result, in their order.
Network elements_with(const Network& network, const Group& group, const std::vector<surface::SurfacePoint>& points) {
  Network own;
  own.material = network.material;
  std::vector<std::int32_t> numbers(network.points.size(), -1);
  const auto number_of = [&](std::int32_t point) {
    std::int32_t& number = numbers[static_cast<std::size_t>(point)];
    if (number < 0) {
      number = static_cast<std::int32_t>(own.points.size());
      own.points.push_back(points[static_cast<std::size_t>(point)]);
    }
    return number;
  };
  for (const std::int32_t point : group) number_of(point);
  const auto in_group = [&](std::int32_t point) {
    const std::int32_t number = numbers[static_cast<std::size_t>(point)];
    return number >= 0 && static_cast<std::size_t>(number) < group.size();
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

/// Unit vectors with `size` entries.
std::vector<Eigen::VectorXd> spread_directions(Eigen::Index size, std::uint64_t seed) {
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

/// Every jammed point, the two ends of every spring and side of a triangle whose ends are both jammed, and all jammed
/// points together.
std::vector<Group> groups_of(const Network& network, const std::vector<bool>& jammed) {
  Group all;
  for (std::size_t i = 0; i < jammed.size(); ++i)
    if (jammed[i]) all.push_back(static_cast<std::int32_t>(i));
  std::vector<Group> groups;
  groups.reserve(all.size());
  for (const std::int32_t point : all) groups.push_back({point});
  const auto is_jammed = [&](std::int32_t point) { return jammed[static_cast<std::size_t>(point)]; };
  const auto add_pair = [&](std::int32_t a, std::int32_t b) {
    if (!is_jammed(a) || !is_jammed(b)) return;
    Group pair{std::min(a, b), std::max(a, b)};
    if (std::ranges::find(groups, pair) == groups.end()) groups.push_back(std::move(pair));
  };
  for (const Spring& spring : network.springs)
    if (spring.weight > 0) add_pair(spring.from, spring.to);
  for (const MembraneTriangle& triangle : network.triangles)
    for (std::size_t k = 0; k < 3; ++k) add_pair(triangle.corners[k], triangle.corners[(k + 1) % 3]);
  if (all.size() > 2) groups.push_back(all);
  return groups;
}

/// The elements of a group with their exact energy, while the group moves on the surface.
class MovedGroup {
 public:
  MovedGroup(const RelaxationContext& context, const Equilibrium& at, const Group& group)
      : group_(group),
        execution_(context.execution),
        own_(elements_with(context.network, group, at.state.points())),
        energy_(at.solver(context.solver),
                std::make_shared<const ElasticNetwork>(own_, std::vector<bool>(own_.points.size(), false)),
                {.reuses_strips = context.reuses_strips()}),
        best_(at.state.mesh(), own_.points),
        lowest_(energy_of(best_)),
        min_decrease_(min_gain * std::abs(at.energy)) {}

  /// Moves the group in directions all around to lower energies, at most `max_moves_of_a_group` times. Returns whether
  /// it moved.
  bool lower(std::uint64_t seed) {
    const auto size = 2 * static_cast<Eigen::Index>(group_.size());
    const std::vector<Eigen::VectorXd> directions = spread_directions(size, seed);
    int moves = 0;
    for (const double length : trial_lengths)
      while (moves < max_moves_of_a_group && move_once(directions, length * best_.mesh().mean_edge_length())) ++moves;
    return moves > 0;
  }
  /// Puts the points of the group into a state of the whole network.
  void place_in(NetworkState& state) const {
    for (std::size_t i = 0; i < group_.size(); ++i) state.place(static_cast<std::size_t>(group_[i]), best_.points()[i]);
  }

 private:
  bool move_once(const std::vector<Eigen::VectorXd>& directions, double length) {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(best_.dimension());
    for (const Eigen::VectorXd& direction : directions) {
      step.head(direction.size()) = length * direction;
      NetworkState beside = best_;
      beside.move(step);
      const double energy = energy_of(beside);
      if (!(energy < lowest_ - min_decrease_)) continue;
      lowest_ = energy;
      best_ = std::move(beside);
      return true;
    }
    return false;
  }

  double energy_of(NetworkState& state) {
    execution_.cancellation.throw_if_requested();
    numerics::EnergySum sum;
    energy_.prepare(state, 0, {execution_.cancellation, nullptr, nullptr});
    energy_.add(state, 0, sum);
    return sum.value;
  }

  const Group& group_;
  const Execution& execution_;
  Network own_;
  NetworkEnergy energy_;
  NetworkState best_;
  double lowest_;
  double min_decrease_;
};

bool move_jammed(const RelaxationContext& context, Equilibrium& at, const std::vector<bool>& jammed) {
  const std::vector<Group> groups = groups_of(context.network, jammed);
  bool has_moved = false;
  for (std::size_t k = 0; k < std::min(groups.size(), max_groups); ++k) {
    MovedGroup group(context, at, groups[k]);
    if (!group.lower(k)) continue;
    group.place_in(at.state);
    has_moved = true;
  }
  return has_moved;
}

}  // namespace

// The ends of paths under compression at their cut loci can jam all other points: a step that lowers the energy of the
// others raises that of these paths. So first these ends are fixed while the others come to rest, then the others are
// fixed while these ends come to rest, and then all are free again. This is repeated while it lowers the energy and
// iterations are left. Where it does not lower the energy, the ends are moved by themselves. On a deformable host it is
// done once: the deformation of the host brings paths to their cut loci as well, which fixing points does not prevent.
Equilibrium leave_jam(const RelaxationContext& context, Equilibrium from, const SearchSettings& settings,
                      RelaxationHistory& history, const Execution& execution) {
  from.termination = Termination::step_too_small;
  if (!from.state.found()) return from;
  bool continues = true;
  while (continues && from.termination == Termination::step_too_small) {
    const std::vector<bool> jammed = context.elements->compressed_at_cut_loci(*from.state.found());
    if (std::ranges::none_of(jammed, std::identity())) break;
    const double before = from.energy;
    const auto has_gained = [&] { return from.energy < before - min_gain * std::abs(before); };
    std::vector<bool> jammed_are_fixed = context.points.fixed;
    std::vector<bool> others_are_fixed = context.points.fixed;
    for (std::size_t i = 0; i < jammed.size(); ++i) (jammed[i] ? jammed_are_fixed : others_are_fixed)[i] = true;
    for (const auto* fixed_points : {&jammed_are_fixed, &others_are_fixed}) {
      const int limit = std::min(settings.max_iterations, from.iterations + max_iterations_with_fixed_points);
      if (from.iterations >= limit) continue;
      from = find_equilibrium(
          context, from, {.is_mollified = settings.is_mollified, .max_iterations = limit, .fixed_points = fixed_points},
          history, execution);
    }
    if (from.iterations >= settings.max_iterations) {
      from.termination = Termination::iteration_limit;
      return from;
    }
    // The groups' energies are exact ones, which a mollified energy cannot be compared with.
    const bool has_moved = !settings.is_mollified && !has_gained() && move_jammed(context, from, jammed);
    from = find_equilibrium(context, from, settings, history, execution);
    continues = !context.host.is_deformable() && (has_moved || has_gained());
  }
  return from;
}

}  // namespace supple::embedded
