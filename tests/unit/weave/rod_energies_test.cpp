#include "rod_energies.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "layouts.h"
#include "supple/base/random.h"
#include "supple/numerics/derivative_check.h"
#include "weave_system.h"

namespace supple::weave {
namespace {

using std::numbers::pi;

std::vector<bool> nothing_held(const RodModel& model) {
  return std::vector<bool>(static_cast<std::size_t>(model.size()), false);
}

WeaveSystem objective_of(const RodModel& model, const Eigen::VectorXd& q) {
  return {model, q, model.spatial() ? flat_chart(model, model.rest_state()) : Chart{}, nothing_held(model), {}};
}

double energy(const RodModel& model, const Eigen::VectorXd& q, const Chart& chart) {
  WeaveSystem objective(model, q, chart, nothing_held(model), {.sliding_regularization = 0});
  return objective.evaluate(0).value;
}

/// A state that is far from rest: nodes are displaced by up to `amount` mm, also out of the plane, and sliders stay
/// within their limits.
Eigen::VectorXd disturbed(const RodModel& model, double amount, std::uint64_t seed) {
  RandomStream random("disturbed", seed);
  Eigen::VectorXd q = model.rest_state();
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const bool slider = i >= model.slider(0) && i < model.slider(static_cast<int>(model.sliders().size()));
    q[i] += (slider ? std::min(amount, 0.6) : amount) * random.uniform(-1, 1);
  }
  return q;
}

TEST(RodEnergies, HaveExactDerivativesInThePlaneAtRandomAndExtremeStates) {
  const Weave weave = wavy();
  const RodModel model(weave, {}, {.spatial = false, .segments = 2});
  for (const double amount : {0.01, 0.3, 1.0}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      WeaveSystem objective = objective_of(model, disturbed(model, amount, seed));
      const auto check = numerics::check_derivatives(objective, {.step = 1e-3});
      EXPECT_LT(check.gradient.error, 1e-7) << amount << ' ' << seed << ' ' << check.summary();
      EXPECT_LT(check.hessian.error, 1e-6) << amount << ' ' << seed << ' ' << check.summary();
    }
  }
}

TEST(RodEnergies, HaveExactDerivativesInSpaceAtRandomAndExtremeStates) {
  const Weave weave = wavy();
  const RodModel model(weave, {{.strand = 2, .coordinate = 0, .clamped = true}}, {.spatial = true, .segments = 1});
  for (const double amount : {0.01, 1.0}) {
    WeaveSystem objective = objective_of(model, disturbed(model, amount, 1));
    const auto check = numerics::check_derivatives(objective, {.step = 1e-3, .frames_turn = true});
    EXPECT_LT(check.gradient.error, 1e-7) << amount << ' ' << check.summary();
    EXPECT_LT(check.hessian.error, 1e-6) << amount << ' ' << check.summary();
  }
}

TEST(RodEnergies, HaveExactDerivativesByTheDeformationGradientOfACell) {
  Weave weave;
  weave.lattice = Eigen::Matrix2d{{8, 1}, {0, 9}};
  weave.strands.push_back({StrandCurve({{0, 1}, {3, 2}}, Ends::periodic, {8, 0})});
  weave.strands.push_back({StrandCurve({{2, 0}, {2.5, 4}}, Ends::periodic, {1, 9})});
  weave.crossings = find_crossings(weave.strands, weave.lattice);
  ASSERT_EQ(weave.crossings.size(), 1U);
  for (const bool slides : {false, true}) {
    weave.crossings[0].members[1].slides = slides;
    for (const bool spatial : {false, true}) {
      const RodModel model(weave, {}, {.spatial = spatial, .segments = 3, .direction = 0.4});
      WeaveSystem objective = objective_of(model, disturbed(model, 0.1, 5));
      const auto check = numerics::check_derivatives(objective, {.step = 1e-3, .frames_turn = spatial});
      EXPECT_LT(check.gradient.error, 1e-7) << slides << spatial << check.summary();
      EXPECT_LT(check.hessian.error, 1e-6) << slides << spatial << check.summary();
    }
  }
}

TEST(RodEnergies, CostNothingUnderRigidMotionsOfCurvedStrands) {
  const Weave weave = wavy();
  const RodModel model(weave, {}, {.spatial = true, .segments = 3});
  RandomStream random("rigid_motions", 1);
  for (int trial = 0; trial < 10; ++trial) {
    const Eigen::Vector3d axis = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const Eigen::Matrix3d rotation = Eigen::AngleAxisd(random.uniform(-2.5, 2.5), axis).toRotationMatrix();
    Eigen::VectorXd q = model.rest_state();
    Chart chart = flat_chart(model, q);
    for (int i = 0; i < static_cast<int>(model.nodes().size()); ++i)
      q.segment<3>(model.position(i)) = rotation * q.segment<3>(model.position(i)) + Eigen::Vector3d(3, -20, 7);
    for (auto& t : chart.tangent) t = rotation * t;
    for (auto& d : chart.director) d = rotation * d;
    for (auto& r : chart.joint) r = rotation * r;
    EXPECT_LT(energy(model, q, chart), 1e-12);
  }
}

TEST(RodEnergies, CostNothingUnderARigidMotionThatIsFollowedInSteps) {
  // The objective transports the frames step by step through half a turn about an oblique axis.
  const Weave weave = wavy();
  const RodModel model(weave, {}, {.spatial = true, .segments = 2});
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, 0.5).normalized();
  constexpr int steps = 60;
  WeaveSystem objective = objective_of(model, model.rest_state());
  const Eigen::Matrix3d step = Eigen::AngleAxisd(pi / steps, axis).toRotationMatrix();
  for (int k = 0; k < steps; ++k) {
    Eigen::VectorXd q = objective.q();
    for (int i = 0; i < static_cast<int>(model.nodes().size()); ++i)
      q.segment<3>(model.position(i)) = step * q.segment<3>(model.position(i));
    for (int j = 0; j < model.joints(); ++j) q.segment<3>(model.joint(j)) = 2 * std::tan(pi / steps / 2) * axis;
    // A rotation of a frame is its parallel transport followed by a rotation about its tangent.
    for (std::size_t e = 0; e < model.edges().size(); ++e) {
      const Eigen::Vector3d t = objective.chart().tangent[e];
      const Eigen::Vector3d turned = step * t;
      const Eigen::Vector3d carried = transport(objective.chart().director[e], t, turned);
      const Eigen::Vector3d meant = step * objective.chart().director[e];
      q[model.angle(static_cast<int>(e))] += std::atan2(carried.cross(meant).dot(turned), carried.dot(meant));
    }
    objective.set_q(std::move(q));
    // Setting the state transported the reference directors, and the angles rotate them to where they were meant to be.
    ASSERT_LT(objective.evaluate(0).value, 1e-12) << k;
  }
}

TEST(RodEnergies, CostNothingWhereACurvedStrandSlidesAlongItself) {
  // Each crossing moves its own short straight strand to the place of the wave's material there.
  Weave weave;
  weave.strands.push_back({StrandCurve({{-1, 0}, {3, 1}, {7, -1}, {11, 1}, {15, 0}}, Ends::open)});
  for (const double x : {2.0, 7.0, 12.0}) weave.strands.push_back(line({x, -2}, {x + 0.5, 2}));
  weave.crossings = find_crossings(weave.strands);
  ASSERT_EQ(weave.crossings.size(), 3U);
  for (Crossing& crossing : weave.crossings) crossing.members[0].slides = true;
  RandomStream random("slides", 1);
  for (const bool spatial : {false, true}) {
    const RodModel model(weave, {}, {.spatial = spatial, .segments = 3});
    Eigen::VectorXd q = model.rest_state();
    for (int i = 0; i < 3; ++i) q[model.slider(i)] = random.uniform(-0.8, 0.8);
    for (const Edge& edge : model.edges()) {
      for (const auto& [node, s] : {std::pair(edge.tail, edge.from), std::pair(edge.head, edge.to)}) {
        const Slider& slider = model.sliders()[static_cast<std::size_t>(std::max(0, edge.strand - 1))];
        const Eigen::Vector2d moved = model.curve(0).at(slider.start + q[model.slider(slider.crossing)]).position -
                                      model.curve(0).at(slider.start).position;
        q.segment<2>(model.position(node)) =
            edge.strand == 0 ? model.curve(0).at(model.coordinate(s, q)).position
                             : Eigen::Vector2d(model.nodes()[static_cast<std::size_t>(node)] + moved);
      }
    }
    EXPECT_LT(energy(model, q, spatial ? flat_chart(model, q) : Chart{}), 1e-12);
    q[model.slider(1)] += 1e-3;
    EXPECT_GT(energy(model, q, spatial ? flat_chart(model, q) : Chart{}), 1e-6) << "sliding in place stretches";
  }
}

TEST(RodEnergies, OfPlaneAndSpaceAgreeInThePlane) {
  const Weave weave = wavy();
  const RodModel flat(weave, {}, {.spatial = false, .segments = 2});
  const RodModel spatial(weave, {}, {.spatial = true, .segments = 2});
  const Eigen::VectorXd q = disturbed(flat, 0.2, 9);
  Eigen::VectorXd p = spatial.rest_state();
  for (int i = 0; i < static_cast<int>(flat.nodes().size()); ++i)
    p.segment<2>(spatial.position(i)) = q.segment<2>(flat.position(i));
  for (int i = 0; i < static_cast<int>(flat.sliders().size()); ++i) p[spatial.slider(i)] = q[flat.slider(i)];
  std::vector<double> angles;
  angles.reserve(static_cast<std::size_t>(flat.joints()));
  for (int j = 0; j < flat.joints(); ++j) angles.push_back(q[flat.joint(j)]);
  const double in_plane = energy(flat, q, {});
  EXPECT_NEAR(energy(spatial, p, flat_chart(spatial, p, angles)), in_plane, 1e-11 * in_plane);
}

TEST(StretchEnergy, OfAUniformlyStretchedStrandIsThatOfTheContinuumHoweverItIsCut) {
  for (const int segments : {1, 3, 17}) {
    Weave weave;
    weave.strands.push_back(line({0, 0}, {10, 0}));
    const RodModel model(weave, {}, {.segments = segments});
    Eigen::VectorXd q = model.rest_state() * 1.03;
    const double exact = 0.5 * circular(0.25, {}).stretch * 0.03 * 0.03 * 10;
    EXPECT_NEAR(energy(model, q, {}), exact, 1e-12 * exact) << segments;
  }
}

TEST(BendEnergy, OfACircularArcBentFromAStraightStrandIsThatOfTheContinuum) {
  // With the nominal stiffness, the energy is EI / 2 * angle^2 / length. The polygon approaches it with the square of
  // the segments' length.
  double last = 0;
  for (const int segments : {8, 16, 32}) {
    Weave weave;
    weave.strands.push_back(line({0, 0}, {10, 0}));
    const RodModel model(weave, {}, {.segments = segments});
    const double angle = 2.0;
    // In this polygon all edges keep their length and turn by the same angle: there is no stretch.
    Eigen::VectorXd q = model.rest_state();
    Eigen::Vector2d at(0, 0);
    double heading = 0;
    const double h = 10.0 / segments;
    for (const Edge& edge : model.edges()) {
      q.segment<2>(model.position(edge.tail)) = at;
      at += h * Eigen::Vector2d(std::cos(heading), std::sin(heading));
      q.segment<2>(model.position(edge.head)) = at;
      heading += angle / segments;
    }
    // Free ends do not bend: segments - 1 turns lie on (segments - 1) h of strand.
    const double exact = 0.5 * circular(0.25, {}).bend * std::pow(angle / 10, 2) * 10 * (segments - 1) / segments;
    const double error = std::abs(energy(model, q, {}) / exact - 1);
    if (last > 0) {
      EXPECT_NEAR(last / error, 4, 0.2);
    }
    last = error;
  }
  EXPECT_LT(last, 1e-3);
}

TEST(TwistEnergy, OfATwistedStraightStrandIsThatOfTheContinuumBeyondAFullTurn) {
  Weave weave;
  weave.strands.push_back(line({0, 0}, {10, 0}));
  const RodModel model(weave, {{.strand = 0, .coordinate = 0, .clamped = true}}, {.spatial = true, .segments = 10});
  Eigen::VectorXd q = model.rest_state();
  const double turn = 3 * pi;
  for (int e = 0; e < 10; ++e) q[model.angle(e)] = turn * (e + 0.5) / 10;
  const double exact = 0.5 * circular(0.25, {}).twist * std::pow(turn / 10, 2) * 9.5;
  EXPECT_NEAR(energy(model, q, flat_chart(model, q)), exact, 1e-10 * exact);
}

TEST(BendEnergy, OfASectionThatBendsOutOfItsRestPlaneKeepsItsRestCurvatureInTheMaterial) {
  // A curved strand that is rotated as a whole about the x axis has no energy, because its frames rotate with it.
  Weave weave;
  weave.strands.push_back(arc(6, 1.5));
  const RodModel model(weave, {}, {.spatial = true, .segments = 8});
  Eigen::VectorXd q = model.rest_state();
  for (int i = 0; i < static_cast<int>(model.nodes().size()); ++i) {
    auto p = q.segment<3>(model.position(i));
    p = Eigen::Vector3d(p[0], 0.6 * p[1], 0.8 * p[1]);
  }
  // Frames that are transported from the flat state without that rotation give the strand an energy.
  const Chart from_rest = flat_chart(model, model.rest_state());
  EXPECT_GT(energy(model, q, from_rest), 1e-4);
  Chart tilted = from_rest;
  Eigen::Matrix3d tilt;
  tilt << 1, 0, 0, 0, 0.6, -0.8, 0, 0.8, 0.6;
  for (auto& t : tilted.tangent) t = tilt * t;
  for (auto& d : tilted.director) d = tilt * d;
  EXPECT_LT(energy(model, q, tilted), 1e-13);
}

}  // namespace
}  // namespace supple::weave
