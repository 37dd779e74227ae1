#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "layouts.h"
#include "weave_path.h"

namespace supple::weave {
namespace {

using std::numbers::pi;

/// A rod along x that is clamped at the origin. It is so slender that its stretch, which the elastica neglects, is
/// below the errors that are measured.
struct Cantilever {
  Weave weave;
  RodModel model;
  std::vector<bool> held;

  Cantilever(double length, int segments, bool spatial)
      : weave{.strands = {line({0, 0}, {length, 0}, 0.03)}},
        model(weave, {{.strand = 0, .coordinate = 0, .clamped = true}}, {.spatial = spatial, .segments = segments}),
        held(static_cast<std::size_t>(model.size()), false) {
    for (int c = 0; c < model.dimension(); ++c) hold(model.position(model.anchor_node(0)) + c);
    for (int c = 0; c < (spatial ? 3 : 1); ++c) hold(model.joint(0) + c);
  }
  void hold(int dof) { held[static_cast<std::size_t>(dof)] = true; }
  int tip() const { return model.edges().back().head; }
  Chart chart() const { return model.spatial() ? flat_chart(model, model.rest_state()) : Chart{}; }
};

/// Position of the tip of the inextensible cantilever, over L, under a transverse dead load P L^2 / EI = `load`:
/// theta'' = -load cos(theta), theta(0) = 0, theta'(1) = 0, by shooting with a Runge-Kutta method.
Eigen::Vector2d elastica_tip(double load) {
  const auto shoot = [load](double curvature, Eigen::Vector2d& tip) {
    constexpr int steps = 4000;
    Eigen::Vector4d y(0, curvature, 0, 0);
    const auto rate = [load](const Eigen::Vector4d& v) {
      return Eigen::Vector4d(v[1], -load * std::cos(v[0]), std::cos(v[0]), std::sin(v[0]));
    };
    const double h = 1.0 / steps;
    for (int i = 0; i < steps; ++i) {
      const Eigen::Vector4d a = rate(y);
      const Eigen::Vector4d b = rate(y + h / 2 * a);
      const Eigen::Vector4d c = rate(y + h / 2 * b);
      y += h / 6 * (a + 2 * b + 2 * c + rate(y + h * c));
    }
    tip = y.tail<2>();
    return y[1];
  };
  double low = 0;
  double high = load;
  Eigen::Vector2d tip;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (shoot(middle, tip) < 0 ? low : high) = middle;
  }
  return tip;
}

TEST(Elastica, OfACantileverIsApproachedWithTheSquareOfTheSegmentsLength) {
  const double length = 20;
  const double load = 5;  // P L^2 / EI, by which the tip turns by more than 60 degrees
  const Eigen::Vector2d exact = elastica_tip(load) * length;
  for (const bool spatial : {false, true}) {
    double last = 0;
    for (const int segments : {16, 32, 64}) {
      Cantilever rod(length, segments, spatial);
      const double force = load * rod.model.stiffness(0).bend / (length * length);
      WeaveSystem objective(rod.model, rod.model.rest_state(), rod.chart(), rod.held, {},
                            {{rod.model.position(rod.tip()) + 1, force}});
      const EquilibriumOptions options{.segments = segments, .tolerance = 1e-8};
      WeavePath path(objective, options, {});
      ASSERT_TRUE(path.advance({Eigen::VectorXd::Zero(rod.model.size()), 1}));
      EXPECT_LE(path.residual(), path.tolerance());
      const Eigen::Vector2d tip = objective.q().segment<2>(rod.model.position(rod.tip()));
      const double error = (tip - exact).norm() / length;
      if (last > 0) {
        EXPECT_NEAR(std::log2(last / error), 2, 0.25) << segments << (spatial ? " in space" : " in the plane");
      }
      last = error;
    }
    EXPECT_LT(last, 1e-3);
  }
}

TEST(Elastica, OfAnotherLoadIsFoundWithQuadraticConvergence) {
  for (const bool spatial : {false, true}) {
    Cantilever rod(20, 16, spatial);
    const double force = 3 * rod.model.stiffness(0).bend / 400;
    const EquilibriumOptions options{.segments = 16, .tolerance = 1e-10};
    const auto bent = [&](double load, Eigen::VectorXd q, Chart chart) {
      return WeaveSystem(rod.model, std::move(q), std::move(chart), rod.held, {},
                         {{rod.model.position(rod.tip()) + 1, load}});
    };
    // The first Newton step from the equilibrium of a load that differs by the fraction `change` leaves a residual that
    // is proportional to the square of the change.
    const auto residual_after_one_step = [&](double change) {
      WeaveSystem start = bent((1 + change) * force, rod.model.rest_state(), rod.chart());
      WeavePath to_start(start, options, {});
      EXPECT_TRUE(to_start.advance({Eigen::VectorXd::Zero(rod.model.size()), 1}));
      WeaveSystem objective = bent(force, start.q(), start.chart());
      WeavePath path(objective, options, {});
      path.resume_at(1);
      EXPECT_TRUE(path.find_equilibrium());
      return path.history().at(1).gradient_norm;
    };
    const double order = std::log2(residual_after_one_step(2e-3) / residual_after_one_step(1e-3));
    EXPECT_NEAR(order, 2, 0.1) << (spatial ? "in space" : "in the plane");
  }
}

/// Whether a straight rod on two hinges is stable at a compression (mm): 1 if its Hessian is positive definite, and -1
/// otherwise.
double hinged_curvature(int segments, double compression, double length) {
  Weave weave{.strands = {line({0, 0}, {length, 0})}};
  const RodModel model(weave, {{.strand = 0, .coordinate = 0}, {.strand = 0, .coordinate = length}},
                       {.segments = segments});
  std::vector<bool> held(static_cast<std::size_t>(model.size()), false);
  Eigen::VectorXd q = model.rest_state();
  for (std::size_t a = 0; a < 2; ++a)
    for (int c = 0; c < 2; ++c) held[static_cast<std::size_t>(model.position(model.anchor_node(a)) + c)] = true;
  for (int i = 0; i < static_cast<int>(model.nodes().size()); ++i) q[model.position(i)] *= 1 - compression / length;
  WeaveSystem objective(model, q, {}, held, {});
  numerics::ShiftedCholesky cholesky;
  return cholesky.factorize(objective.evaluate(2).hessian, 0) ? 1 : -1;
}

TEST(Euler, BucklingLoadIsApproachedWithTheSquareOfTheSegmentsLength) {
  const double length = 30;
  const Stiffness stiffness = circular(0.25, {});
  const double exact = pi * pi * stiffness.bend / (length * length);
  double last = 0;
  for (const int segments : {6, 12, 24}) {
    // The load is P = EA compression / length. Bisection finds the compression at which the straight rod becomes
    // unstable.
    double low = 0;
    double high = 3 * exact * length / stiffness.stretch;
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (low + high);
      (hinged_curvature(segments, middle, length) > 0 ? low : high) = middle;
    }
    const double strain = low / length;
    // A compressible rod buckles at the load P for which P (1 - P / EA) is Euler's load.
    const double load = stiffness.stretch * strain * (1 - strain);
    const double error = std::abs(load / exact - 1);
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / error), 2, 0.2) << segments;
    }
    last = error;
  }
  EXPECT_LT(last, 2e-3);
}

TEST(Euler, BucklingIsFoundDeliberatelyAndCarriesItsLoad) {
  const double length = 30;
  Weave weave{.strands = {line({0, 0}, {length, 0})}};
  const RodModel model(weave, {{.strand = 0, .coordinate = 0}, {.strand = 0, .coordinate = length}}, {.segments = 24});
  std::vector<bool> held(static_cast<std::size_t>(model.size()), false);
  for (std::size_t a = 0; a < 2; ++a)
    for (int c = 0; c < 2; ++c) held[static_cast<std::size_t>(model.position(model.anchor_node(a)) + c)] = true;
  for (const Switch buckling : {Switch::automatic, Switch::off}) {
    WeaveSystem objective(model, model.rest_state(), {}, held, {});
    const EquilibriumOptions options{.segments = 24, .buckling = buckling};
    WeavePath path(objective, options, {});
    LoadStep step{Eigen::VectorXd::Zero(model.size()), 1};
    const int pushed = model.position(model.anchor_node(1));
    step.change[pushed] = -0.6;  // a compression of 2 %
    ASSERT_TRUE(path.advance(step));
    const double reaction = -objective.full_gradient()[pushed];
    const double euler = pi * pi * model.stiffness(0).bend / (length * length);
    EXPECT_EQ(path.stable(), buckling != Switch::off);
    if (buckling == Switch::off) {
      EXPECT_NEAR(reaction, model.stiffness(0).stretch * 0.02, 1e-6 * reaction) << "the straight rod is kept";
    } else {
      // Just beyond buckling, the load exceeds Euler's load by half of the end's relative approach [Timoshenko1961].
      EXPECT_NEAR(reaction / euler, 1 + 0.02 / 2, 6e-3);
      EXPECT_GE(path.branches_left(), 1);
    }
  }
}

TEST(PureBending, OfACurvedStrandUnrollsItByTheMomentOverItsStiffness) {
  // A moment M at the end of a clamped arc changes its curvature by M / EI everywhere.
  const double radius = 8;
  const double sweep = 2.0;
  const double moment = 0.8;
  const Stiffness stiffness = circular(0.25, {});
  const double length = radius * sweep;
  const double curvature = 1 / radius - moment / stiffness.bend;
  // At the clamped end (radius, 0) the tangent points up and the centre lies to the left.
  const Eigen::Vector2d exact(radius - (1 - std::cos(curvature * length)) / curvature,
                              std::sin(curvature * length) / curvature);
  double last = 0;
  for (const int segments : {8, 16, 32}) {
    Weave weave{.strands = {arc(radius, sweep, 40)}};
    const double end = weave.strands[0].curve.length();
    const RodModel model(
        weave, {{.strand = 0, .coordinate = 0, .clamped = true}, {.strand = 0, .coordinate = end, .clamped = true}},
        {.segments = segments});
    std::vector<bool> held(static_cast<std::size_t>(model.size()), false);
    for (int c = 0; c < 2; ++c) held[static_cast<std::size_t>(model.position(model.anchor_node(0)) + c)] = true;
    held[static_cast<std::size_t>(model.joint(model.anchor_joint(0)))] = true;
    WeaveSystem objective(model, model.rest_state(), {}, held, {}, {{model.joint(model.anchor_joint(1)), -moment}});
    const EquilibriumOptions options{.segments = segments, .tolerance = 1e-9};
    WeavePath path(objective, options, {});
    ASSERT_TRUE(path.advance({Eigen::VectorXd::Zero(model.size()), 1}));
    const Eigen::Vector2d tip = objective.q().segment<2>(model.position(model.anchor_node(1)));
    const double error = (tip - exact).norm() / length;
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / error), 2, 0.3) << segments;
    }
    last = error;
  }
  EXPECT_LT(last, 6e-4);
}

/// Whether a naturally straight rod is stable that is bent to a ring and twisted by the total angle `twist` (rad).
bool ring_is_stable(int segments, double twist) {
  const double radius = 10;
  Weave weave{.strands = {circle(radius, {0, 0}, 64)}};
  RodModel model(weave, {{.strand = 0, .coordinate = 0}}, {.spatial = true, .segments = segments});
  Eigen::VectorXd q = model.rest_state();
  Chart chart = flat_chart(model, q);
  const auto n = static_cast<double>(model.turns().size());
  for (Turn& turn : model.turns()) {
    turn.rest_twist = -twist / n;
    turn.naturally_straight = true;
  }
  std::vector<bool> held(static_cast<std::size_t>(model.size()), false);
  WeaveSystem objective(model, q, chart, held, {});
  // Six rigid motions and the spin of the whole section have no stiffness: only curvatures clearly below 0 are
  // unstable.
  const auto evaluation = objective.evaluate(2);
  numerics::ShiftedCholesky cholesky;
  return cholesky.factorize(evaluation.hessian, 1e-6);
}

TEST(Michell, RingsUnderTwistBuckleAtTheKnownTwistWithSecondOrder) {
  // The critical twist of a naturally straight rod of circular section is 2 pi sqrt(3) EI / GJ [Michell1889],
  // [Zajac1962].
  const Stiffness stiffness = circular(0.25, {});
  const double exact = 2 * pi * std::sqrt(3.0) * stiffness.bend / stiffness.twist;
  double last = 0;
  for (const int segments : {16, 32, 64}) {
    double low = 0.5 * exact;
    double high = 1.5 * exact;
    for (int i = 0; i < 24; ++i) {
      const double middle = 0.5 * (low + high);
      (ring_is_stable(segments, middle) ? low : high) = middle;
    }
    const double error = std::abs(low / exact - 1);
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / error), 2, 0.35) << segments << ' ' << low / exact;
    }
    last = error;
  }
  EXPECT_LT(last, 1e-2);
}

}  // namespace
}  // namespace supple::weave
