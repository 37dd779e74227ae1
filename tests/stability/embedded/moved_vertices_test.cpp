// Supports of hosts that move so far that elements invert, equilibria become unstable or the host meets itself.
#include "host_case.h"

#include <numbers>

namespace supple::embedded {
namespace {

using Eigen::Vector3d;

surface::TriangleMesh bar_along_x(int n, double length) {
  surface::TriangleMesh mesh = testing::cube(n);
  std::vector<Vector3d> positions = mesh.positions();
  for (Vector3d& p : positions) p = Vector3d(length * p.x(), p.y() - 0.5, p.z() - 0.5);
  return mesh.with_positions(std::move(positions));
}

/// A bar in a net of springs. Its left end is fixed; the right end moves to `stops` positions one after the other,
/// which `place` gives for a fraction of the motion.
struct MovedBar : HostCase {
  template <class H, class Place>
  MovedBar(H host, int stops, const Place& place) : HostCase(bar_along_x(4, 3), RigidHost{}) {
    cover(0.6, 0.2, 0.01);
    network.fixed_points = {};
    host.fixed_vertices = vertices_where([](const Vector3d& p) { return p.x() < 1e-9; });
    for (const std::int32_t i : vertices_where([](const Vector3d& p) { return p.x() > 3 - 1e-9; })) {
      MovedVertex& one = host.moved_vertices.emplace_back(MovedVertex{i});
      for (int k = 1; k <= stops; ++k)
        one.positions.push_back(place(mesh->positions()[static_cast<std::size_t>(i)], static_cast<double>(k) / stops));
    }
    options.host = host;
  }

  /// Relaxes, and checks what must be true however far the bar can go.
  Relaxation follow() const {
    const Relaxation found = relax(solver, network, options);
    EXPECT_TRUE(std::isfinite(found.energy));
    double energy = found.network_energy;
    for (const auto& term : found.host.terms) energy += term.energy;
    EXPECT_NEAR(found.energy, energy, 1e-10 * std::abs(energy));
    EXPECT_FALSE(found.stops.empty());
    const auto at = [&](std::int32_t node) -> const Vector3d& {
      const auto n = static_cast<std::size_t>(node);
      return n < found.host.vertices.size() ? found.host.vertices[n]
                                            : found.host.inside[n - found.host.vertices.size()];
    };
    double least = 1;
    for (const auto& [a, b, c, d] : found.host.tetrahedra)
      least = std::min(least, (at(b) - at(a)).dot((at(c) - at(a)).cross(at(d) - at(a))));
    EXPECT_GT(least, 0) << "a tetrahedron is inside out";
    return found;
  }
  /// Also checks that all positions are reached, in equilibrium.
  Relaxation arrive() const {
    const Relaxation found = follow();
    EXPECT_EQ(found.stopped, RelaxationTermination::converged);
    EXPECT_LE(found.gradient_norm, found.gradient_tolerance);
    for (const LoadIncrement& stop : found.stops) {
      EXPECT_EQ(stop.reached, 1);
      EXPECT_EQ(stop.stopped, RelaxationTermination::converged);
    }
    std::visit(
        [&](const auto& host) {
          if constexpr (requires { host.moved_vertices; }) {
            for (const MovedVertex& one : host.moved_vertices) {
              const Vector3d& there = found.host.vertices[static_cast<std::size_t>(one.vertex)];
              EXPECT_LT((there - one.positions.back()).norm(), 1e-13);
            }
          }
        },
        options.host);
    check_equilibrium(found);
    return found;
  }
};

SolidHost rubber_bar() { return {.youngs_modulus = 20, .poisson_ratio = 0.4, .element_size = 0.4}; }
ShellHost hollow_bar() { return {.thickness = 0.05, .youngs_modulus = 200, .poisson_ratio = 0.3}; }

Vector3d twisted(const Vector3d& p, double angle) { return Eigen::AngleAxisd(angle, Vector3d::UnitX()) * p; }

// Hard: tetrahedra are sheared far from their rest shape, and supports that move on straight lines from one position to
// the next shorten what should only rotate.
TEST(HardMoves, HalfATurnOfOneEndOfABar) {
  double last = 0;
  for (const int stops : {4, 12}) {
    const Relaxation found = MovedBar(rubber_bar(), stops, [](const Vector3d& p, double share) -> Vector3d {
                               return twisted(p, share * std::numbers::pi);
                             }).arrive();
    EXPECT_EQ(static_cast<int>(found.stops.size()), stops);
    EXPECT_NEAR(found.host.volume_ratio, 1, 0.1);
    // The energy increases with the angle.
    for (std::size_t k = 1; k < found.stops.size(); ++k) EXPECT_GT(found.stops[k].energy, found.stops[k - 1].energy);
    // The net has several equilibria, which hardly change the energy of the bar.
    const double solid = found.host.terms.at(0).energy;
    if (last > 0) {
      EXPECT_NEAR(solid, last, 1e-2 * last);
    }
    last = solid;
  }
}

// Hard: on straight lines to the position after half a turn, the end of the bar collapses to a line halfway, where
// tetrahedra have no volume. The search must come close, say how far it is, and leave all tetrahedra intact.
TEST(HardMoves, HalfATurnOnTheStraightWay) {
  const Relaxation found = MovedBar(rubber_bar(), 1, [](const Vector3d& p, double) -> Vector3d {
                             return twisted(p, std::numbers::pi);
                           }).follow();
  ASSERT_EQ(found.stops.size(), 1U);
  EXPECT_GT(found.stops[0].reached, 0.4);
  EXPECT_LT(found.stops[0].reached, 0.5);
  EXPECT_NE(found.stopped, RelaxationTermination::converged);
}

// Hard: one end should become its mirror image, which no body can do. The search goes on until the end is flat.
TEST(HardMoves, SoFarThatTetrahedraWouldBeTurnedInsideOut) {
  const Relaxation found = MovedBar(rubber_bar(), 1, [](const Vector3d& p, double) -> Vector3d {
                             return {p.x(), -2 * p.y(), p.z()};
                           }).follow();
  ASSERT_EQ(found.stops.size(), 1U);
  EXPECT_GT(found.stops[0].reached, 0.3);
  EXPECT_LT(found.stops[0].reached, 1.0 / 3);
  EXPECT_NE(found.stopped, RelaxationTermination::converged);
}

// Hard: an end is pushed through the other one and out at its back. Contact is neglected, so all tetrahedra can keep
// their volume if they rotate on the way.
TEST(HardMoves, OutAtTheBackOfTheOtherEnd) {
  const MovedBar bar(rubber_bar(), 1, [](const Vector3d& p, double) -> Vector3d { return p - Vector3d(9, 0, 0); });
  const Relaxation found = bar.follow();
  ASSERT_EQ(found.stops.size(), 1U);
  EXPECT_EQ(found.stops[0].reached, 1);
  EXPECT_GT(found.host.volume_ratio, 0);
}

// Hard: a compressed column stays straight by symmetry, which is unstable beyond the buckling load.
TEST(HardMoves, ColumnsBuckle) {
  const auto shorter = [](const Vector3d& p, double share) -> Vector3d { return p - share * Vector3d(0.9, 0, 0); };
  for (const Host& host : {Host(rubber_bar()), Host(hollow_bar())})
    std::visit(
        [&](const auto& kind) {
          if constexpr (requires { kind.moved_vertices; }) {
            const MovedBar bar(kind, 3, shorter);
            const Relaxation found = bar.arrive();
            double bent = 0;
            for (const Vector3d& p : found.host.vertices) bent = std::max(bent, std::hypot(p.y(), p.z()));
            EXPECT_GT(bent, 0.75);
          }
        },
        host);
}

// Hard: one end moves ten lengths away in one load increment, and back again.
TEST(HardMoves, FarAndBack) {
  const MovedBar bar(rubber_bar(), 2, [](const Vector3d& p, double share) -> Vector3d {
    return share < 1 ? p + Vector3d(20, 10, 0) : p;
  });
  const Relaxation found = bar.arrive();
  EXPECT_GT(found.stops[0].energy, 100 * found.stops[1].energy);
  EXPECT_LT(found.host.largest_displacement, 0.1);
}

}  // namespace
}  // namespace supple::embedded
