#include "supple/design/family_atlas.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "supple/base/error.h"
#include "supple/tiling/family_definition.h"

namespace supple::design {
namespace {

using std::numbers::pi;
using tiling::AffineExpression;
using tiling::FamilyDefinition;
using Place = AtlasPlace;

/// The modulus of beams in plane strain, which a solid of this law has.
double beam_modulus(const microscale::Material& material) {
  return material.youngs_modulus / (1 - material.poisson_ratio * material.poisson_ratio);
}

/// Copies of one polygon under translations, turned by an angle about the origin.
FamilyDefinition lattice(const tiling::Polygon& tile, const Eigen::Matrix2d& translations, double width,
                         double angle = 0) {
  const Eigen::Matrix2d turn{{std::cos(angle), -std::sin(angle)}, {std::sin(angle), std::cos(angle)}};
  const auto point = [&](const Eigen::Vector2d& p) {
    const Eigen::Vector2d q = turn * p;
    return tiling::ExpressionPoint{q.x(), q.y()};
  };
  FamilyDefinition definition;
  definition.id = "lattice";
  definition.beam_width = width;
  for (const auto& vertex : tile) definition.tile.vertices.push_back(point(vertex));
  definition.tile.translations = {point(translations.col(0)), point(translations.col(1))};
  definition.tile.placements = {{}};
  return definition;
}

FamilyDefinition hexagons(double width) {
  tiling::Polygon tile;
  for (int k = 0; k < 6; ++k) tile.emplace_back(std::cos(k * pi / 3), std::sin(k * pi / 3));
  const double h = std::sqrt(3);
  return lattice(tile, Eigen::Matrix2d{{1.5, 1.5}, {h / 2, -h / 2}}, width);
}

FamilyDefinition triangles(double width) {
  const double h = std::sqrt(3) / 2;
  auto definition = lattice({{0, 0}, {1, 0}, {0.5, h}}, Eigen::Matrix2d{{1, 0.5}, {0, h}}, width);
  tiling::DefinedPlacement other;
  other.linear = {-1, 0, 0, -1};
  other.offset = {1.5, h};
  definition.tile.placements.push_back(other);
  return definition;
}

/// Rectangles of width 1 and height 0.6, with beams of a width that is a parameter.
FamilyDefinition rectangles(double lower, double upper, double angle = 0) {
  auto definition = lattice({{0, 0}, {1, 0}, {1, 0.6}, {0, 0.6}}, Eigen::Matrix2d{{1, 0}, {0, 0.6}}, 0, angle);
  definition.beam_width.slopes = {1};
  definition.parameters = {{"width", {lower, upper, lower}}};
  return definition;
}

AtlasOptions options_with(int samples, int error_samples = 0) {
  AtlasOptions options;
  options.samples = samples;
  options.error_samples = error_samples;
  return options;
}

FamilyAtlas atlas_of(const FamilyDefinition& definition, const AtlasOptions& options = options_with(1)) {
  return make_atlas(tiling::make_family(definition), options);
}

double youngs_modulus(const Compliance& compliance) { return 1 / compliance(0, 0); }
double poisson_ratio(const Compliance& compliance) { return -compliance(0, 1) / compliance(0, 0); }

/// The value in the limit of slender beams of what is linear in their width, from those at `width` and twice that.
template <class Value>
double slender_limit(double width, const Value& value) {
  return 2 * value(width) - value(2 * width);
}

AtlasOptions fine_options() {
  auto options = options_with(1);
  options.mesh_size = 0.5;
  return options;
}

TEST(FamilyAtlas, HasTheStiffnessOfAHoneycombInClosedForm) {
  // Beams that bend: E = 4 / sqrt(3) E_s (t/l)^3, and Poisson's ratio 1. Nodes shorten the beams by some of t/l.
  const auto beam_length = [](double width) {
    const auto atlas = atlas_of(hexagons(width), fine_options());
    const double slender = 4 / std::sqrt(3) * beam_modulus({}) * std::pow(width, 3);
    return std::cbrt(slender / youngs_modulus(atlas.samples.at(0).compliance.value()));
  };
  EXPECT_NEAR(slender_limit(0.04, beam_length), 1, 0.01);
  const auto atlas = atlas_of(hexagons(0.05), fine_options());
  EXPECT_NEAR(poisson_ratio(atlas.samples.at(0).compliance.value()), 1 - 4 * 0.05 * 0.05, 0.01);
}

TEST(FamilyAtlas, HasTheStiffnessOfATriangularLatticeInClosedForm) {
  // Beams that stretch: E = 2 / sqrt(3) E_s t/l, and Poisson's ratio 1/3. Nodes stiffen the lattice by some of t/l.
  const auto compliance = [](double width) {
    return atlas_of(triangles(width), fine_options()).samples.at(0).compliance.value();
  };
  const auto relative_modulus = [&](double width) {
    return youngs_modulus(compliance(width)) / (2 / std::sqrt(3) * beam_modulus({}) * width);
  };
  EXPECT_NEAR(slender_limit(0.03, relative_modulus), 1, 0.02);
  EXPECT_NEAR(slender_limit(0.03, [&](double width) { return poisson_ratio(compliance(width)); }), 1.0 / 3, 0.01);
}

TEST(FamilyAtlas, OfATilingWithSixfoldSymmetryIsIsotropic) {
  for (const auto& sample : make_atlas(tiling::family("IH21"), options_with(2)).samples) {
    const auto range = range_over_directions(sample.compliance.value(), Task::stiffness);
    EXPECT_NEAR(range.lowest / range.highest, 1, 5e-3);
  }
}

TEST(FamilyAtlas, TurnsItsStiffnessWithTheTile) {
  const auto straight = atlas_of(rectangles(0.1, 0.2), options_with(3));
  const auto turned = atlas_of(rectangles(0.1, 0.2, 0.3), options_with(3));
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& a = straight.samples[i].compliance.value();
    const auto& b = turned.samples[i].compliance.value();
    const auto stiffness = rest_profile(a, Task::stiffness, {0, 0.5, 1.2});
    EXPECT_LT((rest_profile(b, Task::stiffness, {0.3, 0.8, 1.5}) - stiffness).norm() / stiffness.norm(), 0.02);
    EXPECT_LT(RestShape(a).distance(RestShape(b)), 0.02);
  }
}

TEST(FamilyAtlas, MeasuresTheErrorOfItsMeshWhereItIsAsked) {
  auto options = options_with(3, 2);
  const auto coarse = atlas_of(rectangles(0.1, 0.2), options);
  options.mesh_size = 0.25;
  const auto fine = atlas_of(rectangles(0.1, 0.2), options);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_GT(coarse.samples[i].error.value(), 0);
    EXPECT_LT(coarse.samples[i].error.value(), 0.1);
    EXPECT_LT(fine.samples[i].error.value(), coarse.samples[i].error.value());
  }
  EXPECT_FALSE(coarse.samples[2].error);
}

TEST(FamilyAtlas, LocatesAHoleThatClosesInTheMiddleOfTheBox) {
  // The holes of the rectangles close where the beams are as wide as they are high, at 0.6.
  const auto atlas = atlas_of(rectangles(0.3, 0.9), options_with(16));
  EXPECT_GT(atlas.count(Place::closed), 4U);
  for (const auto& sample : atlas.samples) {
    EXPECT_EQ(sample.place == Place::closed, sample.parameters[0] >= 0.6) << sample.parameters[0];
    EXPECT_EQ(sample.compliance.has_value(), sample.parameters[0] < 0.6);
  }
}

/// Type 21 in a box so wide that its tile crosses itself in parts of it.
FamilyDefinition crossing() {
  const auto* type = tiling::find_isohedral_type(21);
  return tiling::definition_of(*type, 0.6, 0.1);
}

TEST(FamilyAtlas, LocatesCrossingsInTheBoxAndSolvesThemOnlyIfAsked) {
  auto options = options_with(10);
  CostLedger cost;
  const auto atlas = make_atlas(tiling::make_family(crossing()), options, {.cost = &cost});
  ASSERT_GT(atlas.count(Place::crossing), 0U);
  ASSERT_GT(atlas.count(Place::good) + atlas.count(Place::sliver), 0U);
  EXPECT_TRUE(std::any_of(atlas.warnings.begin(), atlas.warnings.end(), [](const auto& warning) {
    return warning.flaw == tiling::DefinitionFlaw::crossing && !warning.parameters.empty();
  }));
  for (const auto& sample : atlas.samples) EXPECT_FALSE(sample.place == Place::crossing && sample.compliance);
  ASSERT_FALSE(cost.effects().empty());
  options.crossings = true;
  const auto with_crossings = atlas_of(crossing(), options);
  EXPECT_EQ(with_crossings.count(Place::good), atlas.count(Place::good));
  EXPECT_TRUE(std::any_of(with_crossings.samples.begin(), with_crossings.samples.end(), [](const auto& sample) {
    return sample.place == Place::crossing && sample.compliance.has_value();
  }));
}

TEST(FamilyAtlas, OfAFamilyWithoutParametersHasOneSample) {
  const auto* type = tiling::find_isohedral_type(76);
  ASSERT_TRUE(type && type->defaults.empty());
  const auto atlas = atlas_of(tiling::definition_of(*type, 0, 0.1), options_with(20));
  ASSERT_EQ(atlas.samples.size(), 1U);
  EXPECT_TRUE(atlas.samples[0].compliance);
  EXPECT_EQ(atlas.profiles.size(), reference_profiles().size());
  // As the family that an atlas is of, it has its beam width as a parameter.
  EXPECT_EQ(atlas_definition(*type).parameters.size(), 1U);
}

TEST(FamilyAtlas, FindsAFamilyThatIsAnotherOneRenamed) {
  const auto own = atlas_of(rectangles(0.1, 0.2), options_with(6));
  auto renamed = rectangles(0.1, 0.2, 0.7);
  renamed.id = "renamed";
  const auto other = atlas_of(renamed, options_with(6));
  auto honeycomb = hexagons(0.1);
  honeycomb.id = "honeycomb";
  const auto different = atlas_of(honeycomb);
  const std::vector<const FamilyAtlas*> others{&own, &different, &other};
  const auto comparison = compare(own, others);
  ASSERT_TRUE(comparison);
  EXPECT_LT(comparison->largest_distance, 0.02);
  EXPECT_EQ(comparison->new_fraction, 0);
  const auto adds = compare(different, others);
  ASSERT_TRUE(adds);
  EXPECT_GT(adds->median_distance, new_distance);
  EXPECT_EQ(adds->new_fraction, 1);
  EXPECT_FALSE(adds->same_as);
  // The same numbers under another name.
  auto copy = own;
  copy.family = "copy";
  const std::vector<const FamilyAtlas*> originals{&different, &own};
  EXPECT_EQ(compare(copy, originals)->same_as, "lattice");
  EXPECT_FALSE(compare(own, std::vector<const FamilyAtlas*>{&own})) << "it is not compared with itself";
}

TEST(FamilyAtlas, NamesTheNearestSampleOfEachReferenceProfile) {
  const auto atlas = make_atlas(tiling::family("IH21"), options_with(5));
  ASSERT_EQ(atlas.profiles.size(), reference_profiles().size());
  for (std::size_t k = 0; k < atlas.profiles.size(); ++k) {
    const auto& profile = atlas.profiles[k];
    EXPECT_EQ(profile.name, reference_profiles()[k].name);
    for (const auto& sample : atlas.samples)
      EXPECT_LE(profile.distance.deviation, distance(sample.compliance.value(), reference_profiles()[k]).deviation);
  }
  EXPECT_TRUE(atlas.profiles[11].distance.is_met) << atlas.profiles[11].name << ": the family is isotropic";
}

TEST(FamilyAtlas, AnswersWithWhatItHasAtItsDeadlineAndEndsIfCancelled) {
  CancellationToken token;
  struct StopAfterSome : ProgressSink {
    CancellationToken* token;
    StopReason reason;
    void report(double fraction, std::string_view /*stage*/) override {
      if (fraction > 0.1) token->request(reason);
    }
  } stop;
  stop.token = &token;
  stop.reason = StopReason::deadline;
  const auto family = tiling::make_family(rectangles(0.1, 0.2));
  const auto atlas = make_atlas(family, options_with(64), {.cancellation = token, .progress = &stop});
  EXPECT_EQ(atlas.stopped, StopReason::deadline);
  EXPECT_GE(atlas.samples.size(), 1U);
  EXPECT_LT(atlas.samples.size(), 64U);
  EXPECT_FALSE(atlas.profiles.empty());
  CancellationToken cancelled;
  stop.token = &cancelled;
  stop.reason = StopReason::cancelled;
  EXPECT_THROW(make_atlas(family, options_with(64), {.cancellation = cancelled, .progress = &stop}), Cancelled);
}

TEST(FamilyAtlas, RefusesDefinitionsWithFaultsAndOptionsOutOfRange) {
  auto gap = rectangles(0.1, 0.2);
  gap.tile.translations[0].x = 1.5;
  try {
    atlas_of(gap);
    FAIL() << "it leaves gaps";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "atlas.faulty_definition");
    EXPECT_FALSE(error.details().empty());
  }
  EXPECT_THROW(atlas_of(hexagons(0.1), options_with(0)), Error);
  EXPECT_THROW(atlas_of(hexagons(0.1), options_with(2, 3)), Error);
}

}  // namespace
}  // namespace supple::design
