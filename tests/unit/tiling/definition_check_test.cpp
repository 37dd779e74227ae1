#include "supple/tiling/definition_check.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "polygon.h"
#include "supple/tiling/isohedral_types.h"

namespace supple::tiling {
namespace {

using Flaw = DefinitionFlaw;

// Rectangles of width 2 and height 1 whose upper side is bent by the parameter.
FamilyDefinition bricks() {
  FamilyDefinition definition;
  definition.id = "bricks";
  definition.description = "Rectangles";
  definition.beam_width = 0.1;
  definition.parameters = {{"bend", {-0.2, 0.2, 0.1}}};
  definition.tile = {.vertices = {{0, 0}, {2, 0}, {2, 1}, {0, 1}},
                     .edges = {{0, false, false}, {1, false, false}, {0, true, false}, {1, true, false}},
                     .translations = {{{2, 0}, {0, 1}}},
                     .placements = {{{{1, 0, 0, 1}}, {0, 0}}}};
  definition.shapes = {{EdgeSymmetry::any, SineEdge{{{0, 1}}}}, {EdgeSymmetry::any, StraightEdge{}}};
  return definition;
}

// The only fault of a definition.
DefinitionFinding only_fault(const FamilyDefinition& definition) {
  const DefinitionReport report = check_definition(definition);
  EXPECT_EQ(report.faults.size(), 1u);
  EXPECT_TRUE(report.warnings.empty()) << "warnings are of definitions without faults";
  return report.faults.empty() ? DefinitionFinding{} : report.faults[0];
}

void expect_fault(const FamilyDefinition& definition, Flaw flaw, const std::string& where) {
  const DefinitionFinding fault = only_fault(definition);
  EXPECT_EQ(fault.flaw, flaw) << fault.message;
  EXPECT_EQ(fault.where, where) << fault.message;
}

const DefinitionFinding* find_in(const std::vector<DefinitionFinding>& findings, Flaw flaw,
                                 const std::string& words = "") {
  const auto found = std::find_if(findings.begin(), findings.end(), [&](const DefinitionFinding& finding) {
    return finding.flaw == flaw && finding.message.find(words) != std::string::npos;
  });
  return found == findings.end() ? nullptr : &*found;
}

TEST(DefinitionCheck, FindsNoFaultInTheShippedFamilies) {
  for (const FamilyDefinition& definition : shipped_definitions()) {
    const DefinitionReport report = check_definition(definition);
    EXPECT_TRUE(report.good()) << definition.id << ": " << report.faults[0].where << " " << report.faults[0].message;
  }
  EXPECT_TRUE(check_definition(bricks()).good());
}

TEST(DefinitionCheck, FindsNoFaultInAnyTypeWithEdgesOfItsClasses) {
  for (const IsohedralType& type : isohedral_types()) {
    FamilyDefinition definition = definition_of(type, 0.01, 0.02);
    definition.parameters.push_back({"bend", {-0.01, 0.01, 0.005}});
    AffineExpression bend;
    bend.slopes.assign(definition.parameters.size(), 0);
    bend.slopes.back() = 1;
    bool bends = false;
    for (EdgeShape& shape : definition.shapes) {
      if (shape.symmetry == EdgeSymmetry::straight) continue;
      bends = true;
      if (shape.symmetry == EdgeSymmetry::any) shape.line = SineEdge{{bend, bend}, 5};
      if (shape.symmetry == EdgeSymmetry::mirror_symmetric) shape.line = SineEdge{{bend}, 5};
      if (shape.symmetry == EdgeSymmetry::point_symmetric) shape.line = PolylineEdge{{{0.3, bend}}};
    }
    if (!bends) definition.parameters.pop_back();
    const DefinitionReport report = check_definition(definition);
    EXPECT_TRUE(report.good()) << definition.id << ": " << report.faults[0].where << " " << report.faults[0].message;
  }
}

TEST(DefinitionCheck, FindsThatEdgesOfAnIsohedralTypeAreNotOfTheirClass) {
  FamilyDefinition definition = definition_of(*find_isohedral_type(29), 0.01, 0.02);
  definition.shapes[0] = {EdgeSymmetry::any, SineEdge{{0.1}}};
  expect_fault(definition, Flaw::field, "shapes/0/class");
  definition.isohedral_type = 0;  // now it is a tile of one's own, and drawing it shows the fault
  const DefinitionFinding fault = only_fault(definition);
  EXPECT_TRUE(fault.flaw == Flaw::gap || fault.flaw == Flaw::overlap) << fault.message;
  EXPECT_EQ(fault.where, "tile/edges/0");
}

TEST(DefinitionCheck, LocatesGaps) {
  FamilyDefinition definition = bricks();
  definition.tile.translations[0].x = 2.4;
  const DefinitionFinding fault = only_fault(definition);
  EXPECT_EQ(fault.flaw, Flaw::gap);
  EXPECT_EQ(fault.parameters, std::vector<double>{0.1});
  ASSERT_TRUE(fault.point);
  const double x = fault.point->x() - 2.4 * std::floor(fault.point->x() / 2.4);
  EXPECT_NEAR(x, 2.2, 0.05) << "the middle of the gap";
  EXPECT_NE(fault.message.find("no tile covers this place"), std::string::npos) << fault.message;
}

TEST(DefinitionCheck, LocatesOverlaps) {
  FamilyDefinition definition = bricks();
  definition.tile.translations[0].x = 1.6;
  const DefinitionFinding fault = only_fault(definition);
  EXPECT_EQ(fault.flaw, Flaw::overlap);
  ASSERT_TRUE(fault.point);
  const double x = fault.point->x() - 1.6 * std::floor(fault.point->x() / 1.6);
  EXPECT_NEAR(x, 0.2, 0.05) << "the middle of the overlap";
}

TEST(DefinitionCheck, FindsTilesThatCoverThePlaneTwice) {
  FamilyDefinition definition = bricks();
  definition.tile.placements.push_back(definition.tile.placements[0]);
  expect_fault(definition, Flaw::overlap, "tile/edges/0");
}

TEST(DefinitionCheck, NeedsNoPlaceWhereTilesOverlapMillionsOfTimes) {
  FamilyDefinition definition = bricks();
  definition.tile.translations = {{{1e-6, 0}, {0, 1e-6}}};
  const DefinitionFinding fault = only_fault(definition);
  EXPECT_EQ(fault.flaw, Flaw::overlap);
  EXPECT_FALSE(fault.point);
  EXPECT_NE(fault.message.find("2e+12 times the cell's area"), std::string::npos) << fault.message;
}

TEST(DefinitionCheck, FindsVerticesThatLieOnSidesOfOtherTiles) {
  FamilyDefinition definition = bricks();
  definition.tile.translations[1].x = 1;  // a running bond
  definition.parameters.clear();
  definition.shapes = {};
  definition.tile.edges = {};
  expect_fault(definition, Flaw::unmatched, "tile/vertices/0");
  // With vertices in the middle of the long sides, tiles meet edge to edge.
  definition.tile.vertices = {{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {0, 1}};
  EXPECT_TRUE(check_definition(definition).good());
}

TEST(DefinitionCheck, FindsGapsThatOnlyTheRestOfTheBoxHas) {
  FamilyDefinition definition = bricks();
  definition.parameters.push_back({"width", {2, 2.5, 2}});
  definition.tile.translations[0].x = {0, 0, 1};
  const DefinitionFinding fault = only_fault(definition);
  EXPECT_EQ(fault.flaw, Flaw::gap);
  ASSERT_EQ(fault.parameters.size(), 2u);
  EXPECT_GT(fault.parameters[1], 2);
}

TEST(DefinitionCheck, NamesWhatNothingDependsOn) {
  FamilyDefinition definition = bricks();
  definition.parameters.push_back({"nothing", {0, 1, 0.5}});
  expect_fault(definition, Flaw::unused, "parameters/1");
  definition = bricks();
  definition.shapes.push_back({EdgeSymmetry::straight, StraightEdge{}});
  expect_fault(definition, Flaw::unused, "shapes/2");
}

TEST(DefinitionCheck, NamesExpressionsThatLeaveTheirRangeWithinTheBox) {
  FamilyDefinition definition = bricks();
  definition.tile.vertices[2].y = {1, 1e5};
  DefinitionFinding fault = only_fault(definition);
  EXPECT_EQ(fault.flaw, Flaw::too_large);
  EXPECT_EQ(fault.where, "tile/vertices/2/1");
  EXPECT_NE(fault.message.find("becomes 20001"), std::string::npos) << fault.message;

  definition = bricks();
  definition.tile.vertices[2].y = {1, std::numeric_limits<double>::infinity()};
  expect_fault(definition, Flaw::field, "tile/vertices/2/1");
  definition = bricks();
  definition.parameters[0].range.upper = std::numeric_limits<double>::infinity();
  expect_fault(definition, Flaw::field, "parameters/0");
  definition = bricks();
  definition.beam_width = {0.1, 1};
  expect_fault(definition, Flaw::field, "beam_width");
}

TEST(DefinitionCheck, NamesFieldsThatDoNotGoTogether) {
  FamilyDefinition definition = bricks();
  definition.tile.edges[3].shape = 2;
  expect_fault(definition, Flaw::field, "tile/edges/3/shape");
  definition = bricks();
  definition.tile.edges.pop_back();
  expect_fault(definition, Flaw::field, "tile/edges");
  definition = bricks();
  definition.tile.placements[0].linear = {1, 0.1, 0, 1};
  expect_fault(definition, Flaw::field, "tile/placements/0/linear");
  definition = bricks();
  definition.shapes[0].symmetry = EdgeSymmetry::straight;
  expect_fault(definition, Flaw::field, "shapes/0");
  definition = bricks();
  definition.shapes[0].symmetry = EdgeSymmetry::point_symmetric;
  expect_fault(definition, Flaw::field, "shapes/0/sines/0");
  definition = bricks();
  std::get<SineEdge>(definition.shapes[0].line).pieces = 200;
  expect_fault(definition, Flaw::field, "shapes/0/pieces");
  definition = bricks();
  definition.shapes[1] = {EdgeSymmetry::any, SineEdge{{0.05}, 64}};
  std::get<SineEdge>(definition.shapes[0].line).pieces = 64;
  EXPECT_TRUE(check_definition(definition).good()) << "256 points";
  definition.shapes[0] = {EdgeSymmetry::point_symmetric,
                          PolylineEdge{std::vector<ExpressionPoint>(32, {0.25, {0, 1}})}};
  expect_fault(definition, Flaw::field, "tile");
  definition = bricks();
  definition.id = "two words";
  expect_fault(definition, Flaw::field, "id");
  definition = bricks();
  definition.parameters[0].range.preset = 0.3;
  expect_fault(definition, Flaw::field, "parameters/0");
  definition = bricks();
  std::reverse(definition.tile.vertices.begin(), definition.tile.vertices.end());
  expect_fault(definition, Flaw::field, "tile/vertices");
  definition = bricks();
  definition.tile.translations[1] = {4, 0};
  expect_fault(definition, Flaw::field, "tile");
}

TEST(DefinitionCheck, ATileThatCrossesItselfAtTheDefaultIsAFault) {
  for (FamilyDefinition definition : shipped_definitions()) {
    if (definition.id != "IH67") continue;
    definition.parameters[1].range.preset = 1.09;
    const DefinitionFinding fault = only_fault(definition);
    EXPECT_EQ(fault.flaw, Flaw::crossing);
    EXPECT_NE(fault.message.find("edges 0 and 2 meet"), std::string::npos) << fault.message;
    ASSERT_TRUE(fault.point);
    EXPECT_NEAR(fault.point->x(), 0.5, 1e-12) << "the trapezoid's axis";
  }
}

TEST(DefinitionCheck, LocatesWhereCrossingsBeginWithinTheBox) {
  for (const FamilyDefinition& definition : shipped_definitions()) {
    if (definition.id != "IH67") continue;
    const DefinitionReport report = check_definition(definition);
    const DefinitionFinding* crossing = find_in(report.warnings, Flaw::crossing);
    ASSERT_TRUE(crossing);
    ASSERT_EQ(crossing->parameters.size(), 2u);
    // The upper side of the trapezoid has the length 7 - 6.9 p2.
    EXPECT_NEAR(crossing->parameters[1], 7 / 6.9, 1e-5);
    EXPECT_NE(crossing->message.find("% of the box"), std::string::npos) << crossing->message;
    EXPECT_TRUE(find_in(report.warnings, Flaw::sliver, "begins a side of"));
  }
}

TEST(DefinitionCheck, WarnsOfSliversWithTheirPlaces) {
  FamilyDefinition definition = bricks();
  definition.parameters.push_back({"height", {0.12, 1, 1}});
  definition.tile.vertices[2].y = definition.tile.vertices[3].y = definition.tile.translations[1].y = {0, 0, 1};
  const DefinitionReport report = check_definition(definition);
  ASSERT_TRUE(report.good());
  const DefinitionFinding* side = find_in(report.warnings, Flaw::sliver, "begins a side of 1.2 beam widths");
  ASSERT_TRUE(side);
  EXPECT_EQ(side->parameters[1], 0.12);
  const DefinitionFinding* strait = find_in(report.warnings, Flaw::sliver, "from another one");
  ASSERT_TRUE(strait);
  EXPECT_EQ(strait->parameters[1], 0.12);
  ASSERT_TRUE(strait->point);
  definition.parameters[1].range.lower = 0.5;
  EXPECT_FALSE(find_in(check_definition(definition).warnings, Flaw::sliver, "begins a side"));
}

TEST(DefinitionCheck, SaysTheSameEachTime) {
  for (const FamilyDefinition& definition : shipped_definitions()) {
    const DefinitionReport first = check_definition(definition), second = check_definition(definition);
    ASSERT_EQ(first.warnings.size(), second.warnings.size());
    for (std::size_t k = 0; k < first.warnings.size(); ++k)
      EXPECT_EQ(first.warnings[k].message, second.warnings[k].message);
  }
}

}  // namespace
}  // namespace supple::tiling
