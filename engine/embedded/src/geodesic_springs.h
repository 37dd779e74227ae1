#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "network_state.h"
#include "spring_energy.h"
#include "supple/base/effect_switch.h"
#include "supple/embedded/network.h"
#include "supple/numerics/system.h"
#include "supple/surface/geodesic_solver.h"
#include "supple/surface/vertex_cone.h"

namespace supple::embedded {

struct GeodesicSpringsOptions {
  bool kept_strips = true;
  /// Of thesis eq. 3.12, as a fraction of an edge; 0 leaves the mollifier out.
  double mollifier_length = 0;
};

/// E = sum weight (g - rest_length)^2 over geodesic springs (thesis eq. 3.13).
///
/// What E is like for springs under tension: each smooth piece of a squared distance is convex to second order (see
/// surface::SquaredDistances). Across an edge, and where a path begins to bend at a saddle vertex, E is continuously
/// differentiable. At a cut locus and at a vertex of less than 2 pi it is the least of several pieces, never at a
/// minimum. At a saddle or boundary vertex it is like the tip of a cone, where a point may come to rest whatever small
/// changes the others undergo: there the gradient is the least slope of all directions, zero at a minimum. Next to one
/// whose excess of angle is small, E bends as sharply within a narrow wedge behind the vertex, in which paths are held.
///
/// A line search cannot bring a point to a vertex by chance, and one point that steps over such a place shortens the
/// way of all. So where a step was shortened, the points whose springs surprised it are moved by themselves, one after
/// the other, to their own minima while all others go their whole way; a point that rests at a vertex near by is put
/// there
/// (`kinks`).
class GeodesicSprings : public numerics::Term<NetworkState> {
 public:
  /// The network is a checked one; `solver` outlives the term. Points that are held are not tried at vertices.
  GeodesicSprings(const surface::GeodesicSolver& solver, const Network& network, std::vector<bool> held,
                  GeodesicSpringsOptions options);

  std::string_view name() const override { return "geodesic_springs"; }
  void prepare(NetworkState& state, int order, const Execution& execution) override;
  void add(const NetworkState& state, int order, numerics::EnergySum& sum) const override;
  bool has_kinks() const override { return true; }
  std::vector<Kink> kinks(const NetworkState& current, const std::vector<NetworkState>& tried,
                          double reach) const override;
  void bill(CostLedger& cost, double seconds) const override;

 private:
  /// Paths that end at a point on a tip, with what they pull.
  using Arrivals = std::vector<surface::ArrivingPath>;

  std::shared_ptr<FoundPaths> unused_paths();
  void find_mollified(FoundPaths& found, const Execution& execution) const;
  double pull_of(const Spring& spring, double length) const {
    return 2 * spring.weight * (length - spring.rest_length);
  }
  void add_on_tip(const NetworkState& state, std::size_t point, int order, numerics::EnergySum& sum) const;
  /// A spring's share of the energy at a state whose paths are found, of the ends that are not on tips.
  SpringElement element_of(const FoundPaths& found, std::size_t spring, int order) const;
  /// The points whose springs make the energy at `whole` exceed most what the derivatives at `current` foretell of it,
  /// the worst first.
  std::vector<std::size_t> surprised(const NetworkState& current, const NetworkState& whole) const;
  /// Moves points one after the other, each from `starts`, to where its own springs pull it with the others held.
  void settle(NetworkState& state, const std::vector<std::size_t>& points, const NetworkState& starts) const;
  /// Of one free point: states that have it at a vertex near by where it rests.
  std::vector<Kink> kinks_of(std::size_t point, const NetworkState& current,
                             const std::vector<NetworkState>& tried) const;
  /// Whether a point would rest at the vertex with all others where they are.
  bool rests_at(const NetworkState& state, std::size_t point, std::int32_t vertex) const;

  const surface::GeodesicSolver& solver_;
  std::vector<Spring> springs_;
  std::vector<std::vector<std::int32_t>> springs_at_;  ///< of each point
  std::vector<bool> held_;
  std::vector<std::size_t> free_;  ///< points that are not held and have springs
  GeodesicSpringsOptions options_;
  std::vector<surface::PointPair> pairs_;   ///< the springs' ends at the state that was prepared last
  std::shared_ptr<const FoundPaths> last_;  ///< where strips are taken from
  std::vector<std::shared_ptr<FoundPaths>> kept_paths_;
};

}  // namespace supple::embedded
