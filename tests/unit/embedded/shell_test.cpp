#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include "host_model.h"
#include "shell_elements.h"
#include "supple/base/random.h"
#include "supple/numerics/minimizer.h"
#include "supple/numerics/system.h"
#include "support/expect_error.h"
#include "support/shapes.h"

namespace supple::embedded {
namespace {

using Eigen::Vector3d;
using surface::GeodesicSolver;
using surface::TriangleMesh;
using Terms = std::vector<std::shared_ptr<numerics::Term<NetworkState>>>;

/// A state without points, whose nodes are the mesh's vertices moved by `move`.
template <class Move>
NetworkState state_of(const TriangleMesh& mesh, const Move& move) {
  std::vector<Vector3d> positions = mesh.positions();
  Eigen::VectorXd nodes(3 * mesh.vertex_count());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    positions[i] = move(positions[i]);
    nodes.segment<3>(3 * static_cast<Eigen::Index>(i)) = positions[i];
  }
  auto solver = std::make_shared<GeodesicSolver>(testing::share(mesh.with_positions(positions)));
  return {std::move(solver), {}, nodes};
}

NetworkState shaken(const TriangleMesh& mesh, RandomStream& random, double size) {
  return state_of(mesh, [&](const Vector3d& p) -> Vector3d {
    return p + size * Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  });
}

Terms terms_of(const TriangleMesh& mesh, const ShellHost& shell) {
  Terms terms{std::make_shared<ShellMembrane>(mesh, shell), std::make_shared<ShellHinges>(mesh, shell)};
  if (shell.volume_weight > 0) terms.push_back(std::make_shared<ShellVolume>(mesh, shell));
  return terms;
}

numerics::EnergySum sum_of(const numerics::Term<NetworkState>& term, const NetworkState& state, int order) {
  numerics::EnergySum sum;
  sum.clear(state.dimension(), order);
  term.add(state, order, sum);
  return sum;
}

TEST(HingeAngle, HasTheDerivativesOfTheAngleBetweenTheNormals) {
  RandomStream random("hinge", 1);
  for (int trial = 0; trial < 30; ++trial) {
    Eigen::VectorXd at(12);
    // Flat, slightly folded, folded almost shut to either side, and random.
    const double fold = std::array{0.0, 0.3, -3.0, 3.0, random.uniform(-3, 3)}[static_cast<std::size_t>(trial % 5)];
    at << 0, 0, 0, 0, 1, 0, -0.7, random.uniform(-0.5, 1.5), 0, 0.8 * std::cos(fold), random.uniform(-0.5, 1.5),
        -0.8 * std::sin(fold);
    const auto corners = [&](const Eigen::VectorXd& x) {
      return std::array<Vector3d, 4>{x.segment<3>(0), x.segment<3>(3), x.segment<3>(6), x.segment<3>(9)};
    };
    EXPECT_NEAR(hinge_angle(corners(at), 0).angle, fold, 1e-14) << "a ridge where the right face falls";
    const auto check = numerics::check_derivatives(
        [&](const Eigen::VectorXd& step, int order) {
          const HingeAngle angle = hinge_angle(corners(at + step), order);
          numerics::Evaluation evaluation{angle.angle, angle.gradient, {}};
          if (order >= 2) evaluation.hessian = Eigen::MatrixXd(angle.hessian);
          return evaluation;
        },
        12, {.step = 1e-3});
    EXPECT_LT(check.gradient.error, 1e-9) << fold << " " << check.summary();
    EXPECT_LT(check.hessian.error, 1e-8) << fold << " " << check.summary();
  }
}

TEST(Shell, HasTheDerivativesOfItsEnergy) {
  RandomStream random("shell", 1);
  const ShellHost shell{
      .thickness = 0.3, .youngs_modulus = 7, .poisson_ratio = 0.48, .volume_weight = 5, .volume_scale = 1.3};
  for (const TriangleMesh& mesh : {testing::icosphere(1), testing::torus(6, 4), testing::cube(2)}) {
    const NetworkState state = shaken(mesh, random, 0.03);
    for (const auto& term : terms_of(mesh, shell)) {
      const auto check = numerics::check_derivatives<NetworkState>(*term, state, {.step = 1e-3});
      EXPECT_LT(check.gradient.error, 1e-8) << term->name() << check.summary();
      EXPECT_LT(check.hessian.error, 1e-7) << term->name() << check.summary();
    }
  }
}

TEST(Shell, HasAConvexMatrixNearItsHessian) {
  RandomStream random("shell_convex", 1);
  const ShellHost shell{.thickness = 0.3, .youngs_modulus = 7, .volume_weight = 5, .volume_scale = 0.5};
  const TriangleMesh mesh = testing::icosphere(1);
  const NetworkState state = shaken(mesh, random, 0.1);
  for (const auto& term : terms_of(mesh, shell)) {
    Eigen::MatrixXd matrices[2];
    for (const bool convex : {false, true}) {
      numerics::EnergySum sum;
      sum.clear(state.dimension(), 2);
      sum.convex = convex;
      term->add(state, 2, sum);
      matrices[convex ? 1 : 0] = sum.hessian.matrix(state.dimension());
      for (const auto& column : sum.rank_one) matrices[convex ? 1 : 0] += column * column.transpose();
    }
    const auto least = [](const Eigen::MatrixXd& matrix) {
      return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix).eigenvalues()[0] / matrix.norm();
    };
    EXPECT_LT(least(matrices[0]), -1e-4) << term->name();
    EXPECT_GT(least(matrices[1]), -1e-12) << term->name();
    EXPECT_LT((matrices[1] - matrices[0]).norm(), matrices[0].norm()) << term->name();
  }
}

// The eigenvalues of a single face's Hessian give the nearest positive semidefinite matrix.
TEST(Shell, TakesNoMoreThanTheNegativeCurvatureOutOfAFace) {
  RandomStream random("shell_convex", 2);
  const TriangleMesh mesh = TriangleMesh::build({{0, 0, 0}, {1, 0, 0.1}, {0.2, 0.8, 0}}, {{0, 1, 2}});
  const ShellMembrane membrane(mesh, {.thickness = 0.1, .youngs_modulus = 100, .poisson_ratio = 0.4});
  int bent_downwards = 0;
  for (int round = 0; round < 60; ++round) {
    // Stretched, almost undeformed, compressed.
    const double scale = std::array{1.4, 1.0, 0.7}[static_cast<std::size_t>(round % 3)];
    const NetworkState state = state_of(mesh, [&](const Vector3d& p) -> Vector3d {
      return scale * p + 0.1 * Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    });
    numerics::EnergySum exact = sum_of(membrane, state, 2);
    const Eigen::MatrixXd hessian = exact.hessian.matrix(9);
    numerics::EnergySum convex;
    convex.convex = true;
    convex.clear(9, 2);
    membrane.add(state, 2, convex);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(hessian);
    const Eigen::MatrixXd nearest =
        modes.eigenvectors() * modes.eigenvalues().cwiseMax(0).asDiagonal() * modes.eigenvectors().transpose();
    EXPECT_LT((Eigen::MatrixXd(convex.hessian.matrix(9)) - nearest).norm(), 1e-12 * hessian.norm()) << round;
    bent_downwards += modes.eigenvalues()[0] < -1e-3 * hessian.norm() ? 1 : 0;
  }
  EXPECT_GT(bent_downwards, 20);
  EXPECT_LT(bent_downwards, 50);
}

TEST(Shell, FeelsNoRigidMotionAndItsForcesAndMomentsSumToZero) {
  RandomStream random("shell_rigid", 1);
  const TriangleMesh mesh = testing::icosphere(2);
  const ShellHost shell{.thickness = 0.1, .volume_weight = 50, .volume_scale = 1.2};
  const NetworkState state = shaken(mesh, random, 0.02);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  const NetworkState turned = state_of(mesh.with_positions(state.mesh().positions()),
                                       [&](const Vector3d& p) -> Vector3d { return turn * p + Vector3d(3, -5, 8); });
  for (const auto& term : terms_of(mesh, shell)) {
    const numerics::EnergySum here = sum_of(*term, state, 1);
    EXPECT_NEAR(sum_of(*term, turned, 0).value, here.value, 1e-11 * here.value) << term->name();
    Vector3d force = Vector3d::Zero();
    Vector3d moment = Vector3d::Zero();
    double all = 0;
    for (std::int32_t i = 0; i < mesh.vertex_count(); ++i) {
      const Vector3d own = here.gradient.segment<3>(state.node_row(i));
      force += own;
      moment += state.node(i).cross(own);
      all += own.norm();
    }
    EXPECT_LT(force.norm(), 1e-12 * all) << term->name();
    EXPECT_LT(moment.norm(), 1e-12 * all) << term->name();
  }
}

TEST(Shell, HasNoEnergyAtRestWhateverItsShape) {
  const TriangleMesh mesh = testing::genus3(2);
  const NetworkState rest = state_of(mesh, [](const Vector3d& p) { return p; });
  for (const auto& term : terms_of(mesh, {.volume_weight = 3})) {
    const numerics::EnergySum sum = sum_of(*term, rest, 1);
    EXPECT_NEAR(sum.value, 0, 1e-25) << term->name();
    EXPECT_LT(sum.gradient.norm(), 1e-9) << term->name();
  }
}

/// Equilateral triangles of side `a` over about [0, width] x [0, height].
TriangleMesh equilateral_sheet(double a, double width, double height) {
  const auto columns = static_cast<std::int32_t>(std::lround(width / a));
  const auto rows = static_cast<std::int32_t>(std::lround(height / (a * std::numbers::sqrt3 / 2)));
  std::vector<Vector3d> positions;
  std::vector<surface::Triangle> faces;
  for (std::int32_t j = 0; j <= rows; ++j)
    for (std::int32_t i = 0; i <= columns; ++i)
      positions.emplace_back(a * (i + 0.5 * (j % 2)), a * std::numbers::sqrt3 / 2 * j, 0);
  for (std::int32_t j = 0; j < rows; ++j) {
    for (std::int32_t i = 0; i < columns; ++i) {
      const std::int32_t p = j * (columns + 1) + i;
      const std::int32_t q = p + columns + 1;
      if (j % 2 == 0) {
        faces.push_back({p, p + 1, q});
        faces.push_back({p + 1, q + 1, q});
      } else {
        faces.push_back({p, p + 1, q + 1});
        faces.push_back({p, q + 1, q});
      }
    }
  }
  return TriangleMesh::build(positions, faces);
}

/// Bending energy per area of a sheet of equilateral triangles whose points `bend` moves.
double bending_of(double side, const std::function<Vector3d(const Vector3d&)>& bend, const ShellHost& shell) {
  const TriangleMesh sheet = equilateral_sheet(side, 1, 1);
  const NetworkState bent = state_of(sheet, bend);
  // Edges of the border have no hinges. The area is that of the inner edges, three for every two faces.
  double area = 0;
  for (std::int32_t h = 0; h < sheet.halfedge_count(); ++h)
    if (sheet.twin(h) > h) area += side * side / (2 * std::numbers::sqrt3);
  return sum_of(ShellHinges(sheet, shell), bent, 0).value / area;
}

TEST(Shell, BendsToACylinderLikeThePlate) {
  const ShellHost shell{.thickness = 0.02, .youngs_modulus = 100, .poisson_ratio = 0.3};
  const double stiffness = 100 * 0.02 * 0.02 * 0.02 / (12 * (1 - 0.09));
  for (const double radius : {0.5, 3.0}) {
    const double plate = stiffness / 2 / (radius * radius);
    for (const double direction : {0.0, 0.4, std::numbers::pi / 2}) {
      const Vector3d along(std::cos(direction), std::sin(direction), 0);
      const Vector3d across(-std::sin(direction), std::cos(direction), 0);
      double last = 1;
      for (const double side : {0.1, 0.05, 0.025}) {
        const double energy = bending_of(
            side,
            [&](const Vector3d& p) -> Vector3d {
              const double angle = p.dot(along) / radius;
              return radius * std::sin(angle) * along + p.dot(across) * across +
                     radius * std::cos(angle) * Vector3d::UnitZ();
            },
            shell);
        const double error = std::abs(energy / plate - 1);
        EXPECT_LT(error, 0.06) << radius << " " << direction << " " << side;
        EXPECT_LT(error, last);
        last = error;
      }
      EXPECT_LT(last, 0.01) << radius << " " << direction;
    }
  }
}

TEST(Shell, BendsBothWaysAsWithThePoissonRatioOfHinges) {
  const ShellHost shell{.thickness = 0.02, .youngs_modulus = 100, .poisson_ratio = 0.3};
  const double stiffness = 100 * 0.02 * 0.02 * 0.02 / (12 * (1 - 0.09));
  for (const double other : {1.0, -1.0, 0.5}) {
    const double first = 0.01;
    const double second = other * first;
    const double expected = stiffness / 2 * (first * first + second * second - 2.0 / 3 * first * second);
    const double energy = bending_of(
        0.02,
        [&](const Vector3d& p) -> Vector3d {
          return p + 0.5 * (first * p.x() * p.x() + second * p.y() * p.y()) * Vector3d::UnitZ();
        },
        shell);
    EXPECT_NEAR(energy, expected, 0.02 * expected) << other;
  }
}

TEST(Shell, StretchesLikeASheetUnderPlaneStress) {
  const TriangleMesh sheet = equilateral_sheet(0.25, 1, 1);
  const double nu = 0.4;
  const ShellHost shell{.thickness = 0.1, .youngs_modulus = 20, .poisson_ratio = nu};
  const ShellMembrane membrane(sheet, shell);
  double area = 0;
  for (const auto& [a, b, c] : sheet.faces()) {
    const auto& x = sheet.positions();
    area += (x[b] - x[a]).cross(x[c] - x[a]).norm() / 2;
  }
  const double strain = 1e-5;
  // The modulus is E if the sheet is free to contract across, and E / (1 - nu^2) if its width is fixed.
  for (const auto& [across, modulus] : {std::pair(-nu * strain, 20.0), std::pair(0.0, 20 / (1 - nu * nu))}) {
    const NetworkState stretched = state_of(sheet, [&, across = across](const Vector3d& p) -> Vector3d {
      return {(1 + strain) * p.x(), (1 + across) * p.y(), p.z()};
    });
    const double expected = 0.1 * area * modulus * strain * strain / 2;
    EXPECT_NEAR(sum_of(membrane, stretched, 0).value, expected, 1e-4 * expected);
  }
}

TEST(Shell, IsInflatedToWhereThePressureAndTheStretchAgree) {
  // A sphere with the radius R s under plane stress: its energy is 4 pi R^2 h psi(s^2) + w / 2 (s^3 - scale)^2 V0.
  const TriangleMesh mesh = testing::icosphere(3);
  const ShellHost shell{
      .thickness = 0.01, .youngs_modulus = 100, .poisson_ratio = 0.48, .volume_weight = 20, .volume_scale = 1.5};
  const HostModel host(mesh, shell, {});
  EXPECT_EQ(host.rigid_body_constraints(), 1);
  const NetworkState rest(std::make_shared<GeodesicSolver>(testing::share(mesh)), {}, host.nodes());
  numerics::System<NetworkState> system(rest, host.terms(), numerics::Unknowns(host.fixed()));
  const numerics::MinimizerResult found = numerics::minimize(system, {.gradient_tolerance = 1e-10});
  EXPECT_EQ(found.stop, numerics::MinimizerTermination::converged);
  EXPECT_LE(found.iterations, 8);
  const double nu = 0.48;
  const double mu = 100 / (2 * (1 + nu));
  const double lambda = 100 * nu / (1 - nu * nu);
  const auto slope = [&](double s) {
    const double stretch = 2 * mu * (s - 1 / s) + 4 * lambda * std::log(s) / s;  // d psi / d s, J = s^2
    return 3 * shell.thickness * stretch + shell.volume_weight * (s * s * s - shell.volume_scale) * 3 * s * s;
  };
  double low = 1;
  double high = 1.2;
  for (int i = 0; i < 60; ++i) (slope((low + high) / 2) < 0 ? low : high) = (low + high) / 2;
  // One vertex is fixed, so that the centre moves.
  Vector3d center = Vector3d::Zero();
  for (std::int32_t i = 0; i < mesh.vertex_count(); ++i) center += system.state().node(i) / mesh.vertex_count();
  double mean = 0;
  for (std::int32_t i = 0; i < mesh.vertex_count(); ++i)
    mean += (system.state().node(i) - center).norm() / mesh.vertex_count();
  EXPECT_NEAR(mean - 1, low - 1, 0.03 * (low - 1));
  EXPECT_GT(mean, 1.01);
}

TEST(Shell, RefusesToKeepTheVolumeOfAnOpenSurface) {
  testing::expect_error("host.open_surface", [] { ShellVolume(testing::open_hemisphere(), {.volume_weight = 1}); });
}

TEST(Shell, HasNoFiniteEnergyWhereAFaceHasLostItsArea) {
  const TriangleMesh mesh = testing::icosphere(1);
  NetworkState state = state_of(mesh, [](const Vector3d& p) { return p; });
  Eigen::VectorXd step = Eigen::VectorXd::Zero(state.dimension());
  const auto& [a, b, c] = mesh.faces().front();
  step.segment<3>(state.node_row(a)) = (state.node(b) + state.node(c)) / 2 - state.node(a);
  state.move(step);
  EXPECT_TRUE(state.collapsed());
  EXPECT_FALSE(std::isfinite(sum_of(ShellMembrane(mesh, {}), state, 2).value));
}

}  // namespace
}  // namespace supple::embedded
