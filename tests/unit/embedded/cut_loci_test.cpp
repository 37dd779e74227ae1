#include "cut_loci.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "network_search.h"
#include "supple/embedded/network_builders.h"
#include "supple/embedded/relaxation.h"
#include "supple/numerics/system.h"
#include "support/nearest_point.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::embedded {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4d;
using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;

/// An open tube along z with four flat sides of width `side`, from -2 to 2 widths. It unrolls into a strip of the
/// plane, and the cut locus of a point is the line opposite to it.
struct SquareTube {
  explicit SquareTube(double width = 1) : side(width), mesh(make(width)), solver(testing::share(mesh)) {}

  static TriangleMesh make(double width) {
    std::vector<Vector3d> positions;
    std::vector<surface::Triangle> faces;
    for (int level = -2; level <= 2; ++level)
      for (const auto& [x, y] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)})
        positions.push_back(width * Vector3d(x, y, level));
    for (int level = 0; level < 4; ++level)
      for (int k = 0; k < 4; ++k) {
        const int a = 4 * level + k, b = 4 * level + (k + 1) % 4;
        faces.push_back({a, b, b + 4});
        faces.push_back({a, b + 4, a + 4});
      }
    return TriangleMesh::build(std::move(positions), std::move(faces));
  }

  /// The point at the height `height`, at a distance of `around` sides along the circumference.
  SurfacePoint at(double around, double height) const {
    const double t = around - std::floor(around);
    const Vector3d corners[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    const auto k = static_cast<std::size_t>(std::floor(around)) % 4;
    return testing::nearest_point(mesh,
                                  side * ((1 - t) * corners[k] + t * corners[(k + 1) % 4]) + Vector3d(0, 0, height));
  }

  double side;
  TriangleMesh mesh;
  GeodesicSolver solver;
};

/// A free point between two springs. One of rest length `rest` pushes it away from a fixed point; the other, of weight
/// `hold` and rest length 0, pulls it to a fixed point at the height of 0.3 sides that deviates by `off` from opposite.
struct PushedPoint {
  double rest = 4, hold = 3, off = 0;

  Network network(const SquareTube& tube) const {
    Network network;
    network.points = {tube.at(0.5, 0), tube.at(2.2, 0.5 * tube.side), tube.at(2.5 + off, 0.3 * tube.side)};
    network.springs = {{0, 1, rest * tube.side, 1}, {1, 2, 0, hold}};
    network.fixed_points = {0, 2};
    return network;
  }
  /// The energy and its first and second derivative along the line opposite to the fixed point, in units of sides.
  std::array<double, 3> on_line(double z) const {
    const double length = std::hypot(2, z);
    return {(length - rest) * (length - rest) + hold * ((z - 0.3) * (z - 0.3) + off * off),
            2 * (z - rest * z / length) + 2 * hold * (z - 0.3), 2 * (1 - 4 * rest / std::pow(length, 3)) + 2 * hold};
  }
  double height_at_rest() const {
    double z = 0.3;
    for (int k = 0; k < 50; ++k) z -= on_line(z)[1] / on_line(z)[2];
    return z;
  }
};

TEST(CutLoci, APushedPointComesToRestOnTheLineWhereTwoPathsAreEquallyLong) {
  const SquareTube tube;
  for (const double off : {0.0, 0.2, -0.3}) {
    const PushedPoint scene{.off = off};
    const Relaxation relaxed = relax(tube.solver, scene.network(tube), {.tolerance = 1e-13, .paths = true});
    const double z = scene.height_at_rest();
    EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged) << off;
    EXPECT_LE(relaxed.iterations, 8) << off;
    EXPECT_LT((surface::position(tube.mesh, relaxed.points[1]) - Vector3d(0.5, 1, z)).norm(), 1e-12) << off;
    EXPECT_NEAR(relaxed.energy, scene.on_line(z)[0], 1e-12);
    EXPECT_TRUE(relaxed.springs[0].at_cut_locus && relaxed.springs[0].compressed);
    EXPECT_FALSE(relaxed.springs[1].at_cut_locus);
    ASSERT_EQ(relaxed.warnings.size(), 2U);
    EXPECT_NE(relaxed.warnings[1].find("two shortest paths"), std::string::npos);
    for (std::size_t i = 1; i < relaxed.history.size(); ++i)
      EXPECT_LE(relaxed.history[i].energy, relaxed.history[i - 1].energy * (1 + 1e-12));
  }
}

TEST(CutLoci, APointThatIsPulledOffTheLineLeavesIt) {
  const SquareTube tube;
  // The point starts before the line. Its equilibrium is behind it, since the pulling spring is the stronger one there.
  const PushedPoint scene{.hold = 60, .off = 0.4};
  const Relaxation relaxed = relax(tube.solver, scene.network(tube));
  EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged);
  EXPECT_FALSE(relaxed.springs[0].at_cut_locus);
  EXPECT_LT(surface::position(tube.mesh, relaxed.points[1]).x(), 0.49);
}

/// The unit tangent vector of the circumference at a point of the side opposite to the first, in tangent coordinates.
Eigen::Vector2d around(const TriangleMesh& mesh, const SurfacePoint& at) {
  return surface::tangent_frame(mesh, at.face).transpose() * Vector3d(-1, 0, 0);
}

CutLocus of_first_path(const TriangleMesh& mesh, const SurfacePoint& to) {
  Vector4d side = Vector4d::Zero();
  side.tail<2>() = around(mesh, to);
  return {.path = 0, .from = 0, .to = 1, .sides = {-side, side}};
}

/// A network whose free point is moved next to the cut locus of the first path, and which keeps that path there.
numerics::System<NetworkState> with_kept_path(const SquareTube& tube, Network& network) {
  network.points[1] = tube.at(2.43, 0.8);
  NetworkState state(tube.mesh, network.points);
  state.set_cut_loci({of_first_path(tube.mesh, network.points[1])});
  const std::vector<bool> held{true, false, true};
  return {std::move(state),
          {network_term(tube.solver, network, held).energy},
          numerics::Unknowns(std::vector<bool>{true, true, false, false, true, true})};
}

TEST(CutLoci, AreLetGoWhereTheirPathsPull) {
  const SquareTube tube;
  for (const double rest : {1.0, 4.0}) {
    Network network = PushedPoint{.rest = rest}.network(tube);
    auto system = with_kept_path(tube, network);
    const numerics::Evaluation here = system.evaluate(1);
    EXPECT_EQ(system.state().cut_loci().size(), rest > 2.5 ? 1U : 0U);
    // Off the ridge the gradient across it is that of one path.
    const double across = std::abs(here.gradient.dot(around(tube.mesh, system.state().points()[1])));
    if (rest > 2.5) {
      EXPECT_LT(across, 1e-9);
    } else {
      EXPECT_GT(across, 1);
    }
  }
}

TEST(CutLoci, KeepTheirPathsAndHaveTheDerivativesAlongThem) {
  const SquareTube tube;
  const PushedPoint scene{.off = 0.1};
  Network network = scene.network(tube);
  auto system = with_kept_path(tube, network);
  const numerics::Evaluation here = system.evaluate(2);
  const SurfacePoint& at = system.state().points()[1];
  // The point moved across to the nearest place on the line where both paths are equally long.
  const double z = surface::position(tube.mesh, at).z();
  EXPECT_LT((surface::position(tube.mesh, at) - Vector3d(0.5, 1, z)).norm(), 1e-12);
  EXPECT_NEAR(z, 0.8, 0.002);
  const auto [energy, slope, curvature] = scene.on_line(z);
  EXPECT_NEAR(here.value, energy, 1e-12);
  const Eigen::Vector2d across = around(tube.mesh, at);
  const Eigen::Vector2d along = surface::tangent_frame(tube.mesh, at.face).transpose() * Vector3d(0, 0, 1);
  EXPECT_NEAR(here.gradient.dot(along), slope, 1e-9);
  EXPECT_NEAR(here.gradient.dot(across), 0, 1e-9);
  const Eigen::Matrix2d hessian = Eigen::MatrixXd(system.core()).selfadjointView<Eigen::Lower>();
  EXPECT_NEAR(along.dot(hessian * along), curvature, 1e-9 * hessian.norm());
  EXPECT_GT(across.dot(hessian * across), 1e3 * std::abs(curvature));
  // The force across, 2 * 3 * 0.1 by the pulling spring, equals the difference between the forces along the two paths.
  const EqualPaths& equal = *system.state().found()->equal_to(0);
  const double length = std::hypot(2, z);
  EXPECT_NEAR(std::abs(equal.fractions[0] - equal.fractions[1]), 0.6 / (2 * (4 - length) * 2 / length), 1e-9);
}

TEST(CutLoci, HaveTheGradientOfTheirEnergyByBothEnds) {
  const SquareTube tube;
  Network network;
  network.points = {tube.at(0.4, -0.2), tube.at(2.42, 0.5), tube.at(1.9, 0.7)};
  network.springs = {{0, 1, 4, 1}, {1, 2, 0, 0.3}};
  NetworkState state(tube.mesh, network.points);
  state.set_cut_loci({of_first_path(tube.mesh, network.points[1])});
  const std::shared_ptr<NetworkEnergy> elements =
      network_term(tube.solver, network, std::vector<bool>(3, false)).energy;
  elements->prepare(state, 2, {});
  ASSERT_EQ(state.cut_loci().size(), 1U);
  const auto check = numerics::check_derivatives(*elements, state, {.step = 1e-5});
  EXPECT_LT(check.gradient.error, 1e-7) << check.summary();
}

TEST(CutLoci, ThreePathsHoldAPointThatASpringPushesAsFarAsItCanGo) {
  const TriangleMesh mesh = testing::icosphere(1);
  const GeodesicSolver solver(testing::share(mesh));
  Network network;
  network.points = {{FaceId{0}, {0.2, 0.3, 0.5}}, {FaceId{0}, {0.4, 0.3, 0.3}}};
  network.springs = {{0, 1, 4, 1}};
  network.fixed_points = {0};
  const Relaxation relaxed = relax(solver, network);
  EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged);
  EXPECT_LE(relaxed.iterations, 15);
  EXPECT_TRUE(relaxed.springs[0].at_cut_locus);
  // The distance decreases in every direction.
  for (int k = 0; k < 24; ++k) {
    const double angle = k * std::numbers::pi / 12;
    const SurfacePoint beside =
        surface::retract(mesh, relaxed.points[1], 1e-4 * Eigen::Vector2d(std::cos(angle), std::sin(angle)), {}).end;
    EXPECT_LT(solver.distance(relaxed.points[0], beside), relaxed.springs[0].length) << k;
  }
}

TEST(CutLoci, AreFollowedOnASurfaceThatMoves) {
  const SquareTube tube;
  const PushedPoint scene{.off = 0.1};
  MovingHost host;
  for (const double width : {1.1, 1.3}) host.positions.push_back(SquareTube::make(width).positions());
  // The rest lengths are unchanged while the tube becomes wider.
  const Relaxation relaxed = relax(tube.solver, scene.network(tube), {.host = host});
  PushedPoint wider = scene;
  wider.rest = 4 / 1.3;
  ASSERT_EQ(relaxed.stops.size(), 2U);
  for (const LoadIncrement& stop : relaxed.stops) {
    EXPECT_EQ(stop.stopped, RelaxationTermination::converged);
    EXPECT_LE(stop.iterations, 8);
    EXPECT_EQ(stop.load_steps, 1);
  }
  const Vector3d expected = 1.3 * Vector3d(0.5, 1, wider.height_at_rest());
  const SquareTube end(1.3);
  EXPECT_LT((surface::position(end.mesh, relaxed.points[1]) - expected).norm(), 1e-8);
  EXPECT_TRUE(relaxed.springs[0].at_cut_locus);
}

TEST(CutLoci, SidesThatPushAreKeptThereInAMembrane) {
  // The torus of [Thesis, fig. 3.6], of which one half is stretched. In the second step one side ends behind a vertex.
  const TriangleMesh rest = testing::torus(48, 24);
  const GeodesicSolver solver(testing::share(rest));
  Network network;
  network.points = poisson_disk_points(solver, 0.255, 16);
  network.triangles = membrane_at_rest(solver, network.points, triangulate(solver, network.points).triangles);
  network.material = {1, 0.3, 1};
  Relaxation relaxed;
  for (const double amount : {0.02, 0.04}) {
    std::vector<Vector3d> positions = rest.positions();
    for (Vector3d& position : positions) position[0] += amount * std::max(0.0, position[0]);
    const GeodesicSolver stretched(testing::share(rest.with_positions(positions)));
    relaxed = relax(stretched, network, {.tolerance = 1e-9 / stretched.mesh().diagonal(), .mollifier = Switch::off});
    network.points = relaxed.points;
    EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged);
  }
  EXPECT_LE(relaxed.iterations, 10);
  EXPECT_TRUE(std::ranges::any_of(relaxed.triangles, &TriangleState::at_cut_locus));
  EXPECT_NE(relaxed.warnings.back().find("side that pushes"), std::string::npos);
}

}  // namespace
}  // namespace supple::embedded
