#include "supple/design/beam_width_sensitivity.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "supple/design/material_bound.h"
#include "supple/design/verification.h"
#include "supple/design/verified_designs.h"
#include "supple/microscale/simulation.h"
#include "supple/tiling/family_definition.h"
#include "supple/tiling/tiling_error.h"
#include "test_space.h"

namespace supple::design {
namespace {

using std::numbers::pi;

/// A tangent that is stiffer along x.
Eigen::Matrix3d tangent() {
  Eigen::Matrix3d tangent;
  tangent << 4, 0.5, 0, 0.5, 1, 0, 0, 0, 0.6;
  return tangent;
}

DesignProfile profile_of(Task task, double direction = 0) {
  Target target;
  target.task = task;
  target.direction = direction;
  target.control_points = {{0, 1}, {1, 1}};
  DesignProfile profile;
  profile.target = sample_target(target);
  return profile;
}

Design design_with(std::vector<DesignProfile> profiles) {
  Design design;
  design.parameters = Eigen::Vector2d(0.1, 0.2);
  design.profiles = std::move(profiles);
  return design;
}

/// Beams that bend: their stiffness is proportional to the cube of their width.
Eigen::Matrix3d bending(const Eigen::VectorXd& /*parameters*/, double width_factor, const Execution& /*execution*/) {
  return std::pow(width_factor, 3) * tangent();
}

TEST(BeamWidthSensitivity, OfBeamsThatBendIsThatOfTheCubeOfTheirWidth) {
  const auto design =
      design_with({profile_of(Task::stiffness), profile_of(Task::poisson), profile_of(Task::stress_strain)});
  const auto sensitivities = beam_width_sensitivity(design, bending);
  ASSERT_EQ(sensitivities.size(), 3U);
  for (const std::size_t t : {0U, 2U}) {
    EXPECT_NEAR(sensitivities[t].wider.value(), std::pow(1.05, 3) - 1, 1e-9);
    EXPECT_NEAR(sensitivities[t].narrower.value(), 1 - std::pow(0.95, 3), 1e-9);
  }
  EXPECT_NEAR(sensitivities[1].wider.value(), 0, 1e-9) << "Poisson's ratio is the same";
}

TEST(BeamWidthSensitivity, OfStressIsThatOfTheModulusAlongTheLoadInTheTurnedTiling) {
  // Only the stiffness along the material's x axis changes.
  const RestTangent along_x = [](const auto&, double factor, const auto&) {
    Eigen::Matrix3d compliance = tangent().inverse();
    compliance(0, 0) /= factor;
    return Eigen::Matrix3d(compliance.inverse());
  };
  auto design = design_with({profile_of(Task::stress_strain, 0.4), profile_of(Task::stress_strain, 0.4 + pi / 2)});
  design.orientation = 0.4;
  const auto turned = beam_width_sensitivity(design, along_x);
  EXPECT_NEAR(turned[0].wider.value(), 0.05, 1e-9);
  EXPECT_NEAR(turned[1].wider.value(), 0, 1e-9);
}

TEST(BeamWidthSensitivity, IsUnknownWhereThereIsNoSuchStructure) {
  const RestTangent closing = [](const Eigen::VectorXd& parameters, double factor, const Execution& execution) {
    if (factor > 1) throw tiling::TilingError("tiling.hole_closed", "All holes close.");
    return bending(parameters, factor, execution);
  };
  const auto design = design_with({profile_of(Task::stiffness)});
  const auto sensitivities = beam_width_sensitivity(design, closing);
  EXPECT_FALSE(sensitivities[0].wider);
  EXPECT_TRUE(sensitivities[0].narrower);
  const RestTangent nothing = [](const auto&, double, const auto&) { return Eigen::Matrix3d(Eigen::Matrix3d::Zero()); };
  EXPECT_FALSE(beam_width_sensitivity(design, nothing)[0].narrower);
}

TEST(BeamWidthSensitivity, IsUnknownAfterTheDeadlineAndCancelledByAClient) {
  const auto design = design_with({profile_of(Task::stiffness)});
  const CancellationToken late;
  late.request(StopReason::deadline);
  EXPECT_FALSE(beam_width_sensitivity(design, bending, {.cancellation = late})[0].wider);
  const CancellationToken cancelled;
  cancelled.request(StopReason::cancelled);
  EXPECT_THROW(beam_width_sensitivity(design, bending, {.cancellation = cancelled}), Cancelled);
}

TEST(BeamWidthSensitivity, IsThatOfARealStructure) {
  const auto& family = tiling::family("IH21");
  const RestTangent rest_tangent = rest_tangent_of(family, {});
  const std::vector<double> presets = tiling::presets(family);
  const Eigen::VectorXd parameters =
      Eigen::Map<const Eigen::VectorXd>(presets.data(), static_cast<Eigen::Index>(presets.size()));
  const Eigen::Matrix3d nominal = rest_tangent(parameters, 1, {});
  const auto structure = tiling::make_structure(family, presets);
  microscale::GreenStrainLoad small;
  small.strains.emplace_back(1e-6, 0, 0);
  const auto state = microscale::simulate(structure, small).states.at(0);
  EXPECT_NEAR(state.stress[0], 1e-6 * nominal(0, 0), 1e-9 * nominal(0, 0)) << "the stiffness of the same structure";
  auto design = design_with({profile_of(Task::stiffness)});
  design.parameters = parameters;
  const auto sensitivity = beam_width_sensitivity(design, rest_tangent)[0];
  // Between beams that stretch and beams that bend.
  EXPECT_GT(sensitivity.wider.value(), 0.04);
  EXPECT_LT(sensitivity.wider.value(), 0.25);
  EXPECT_NEAR(*sensitivity.wider, *sensitivity.narrower, 0.25 * *sensitivity.wider);
}

TEST(BeamWidthSensitivity, IsTheSameWhetherTheWidthIsAParameterOrNot) {
  auto definition = *tiling::family("IH21").definition;
  const auto fixed = rest_tangent_of(tiling::make_family(definition), {});
  const double width = definition.beam_width.constant;
  definition.parameters.push_back({"Width of the beams", {0.5 * width, 1.5 * width, width}});
  definition.beam_width = {0, 0, 0, 1};
  const auto varying = rest_tangent_of(tiling::make_family(definition), {});
  for (const double factor : {0.95, 1.0, 1.05}) {
    const Eigen::Matrix3d expected = fixed(Eigen::Vector2d(0.105, 0.65), factor, {});
    const Eigen::Matrix3d found = varying(Eigen::Vector3d(0.105, 0.65, width), factor, {});
    EXPECT_NEAR((found - expected).norm() / expected.norm(), 0, 1e-9) << factor;
  }
}

TEST(SearchDesigns, SayHowSensitiveTheyAreWhereTheRequestAsksForIt) {
  const TestSpace test(2, 1);
  const std::vector<DesignSpace> spaces{test.space()};
  DesignSearch search;
  Target target;
  target.control_points = {{0, 0}, {0.05, 0.1}};
  search.problem.targets = {target};
  FamilySimulation simulation;
  simulation.rest_tangent = bending;
  const auto ran = [&](Switch wanted) {
    search.beam_width_sensitivity = wanted;
    CostLedger bill;
    const auto found = search_designs(spaces, std::vector{simulation}, search, {.cost = &bill});
    const auto effect = bill.effects().back();
    EXPECT_EQ(effect.name, "beam_width_sensitivity");
    EXPECT_EQ(effect.ran, !found.beam_width_sensitivity.empty());
    return std::pair(effect.ran, effect.why);
  };
  EXPECT_EQ(ran(Switch::automatic), std::pair(false, std::string("the design was not simulated")));
  EXPECT_EQ(ran(Switch::off), std::pair(false, std::string("the request turns it off")));
}

}  // namespace
}  // namespace supple::design
