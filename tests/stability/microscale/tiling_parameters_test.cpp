// Parameters at which a tiling's topology changes, holes open or close, or the box of parameters has a corner.
#include <optional>
#include <ostream>
#include <utility>

#include "simulation_case.h"
#include "supple/base/error.h"
#include "supple/base/random.h"

namespace supple::microscale {
namespace {

struct ParameterCase {
  std::string name;
  std::string family;
  std::vector<double> parameters;
};

void PrintTo(const ParameterCase& c, std::ostream* out) { *out << c.name; }

class NearSingularParameters : public ::testing::TestWithParam<ParameterCase> {};

// Hard: sides have nearly no length, holes have only just opened, and gmsh must not lose sharp angles.
TEST_P(NearSingularParameters, CompressionAndTensionConverge) {
  const ParameterCase& c = GetParam();
  for (const UniaxialLoad& load : {UniaxialLoad{0.3, {0.97, 0.9}}, UniaxialLoad{0.3, {1.03, 1.15}}})
    expect_resistance(follow(c.family, c.parameters, load, hard_case_options(0.8)), load);
}

INSTANTIATE_TEST_SUITE_P(Tilings, NearSingularParameters,
                         ::testing::Values(ParameterCase{"SquareAtItsSingularity", "square", {0}},
                                           ParameterCase{"SquareBesideItsSingularity", "square", {1e-6}},
                                           ParameterCase{"InnerHoleStillClosed", "square", {0.0424 - 1e-4}},
                                           ParameterCase{"InnerHoleJustOpen", "square", {0.0424 + 1e-4}},
                                           ParameterCase{"OuterHolesStillOpen", "square", {0.9576 - 1e-4}},
                                           ParameterCase{"OuterHolesJustClosed", "square", {0.9576 + 1e-4}},
                                           ParameterCase{"CornerOfTheBox", "IH28", {0.005, 0.005}}),
                         [](const auto& c) { return c.param.name; });

/// A design on a line through the box of parameters, with its stiffness at rest and its number of holes.
struct DesignOnLine {
  double place = 0;
  Eigen::Matrix3d stiffness;
  std::size_t holes = 0;
  bool tiles_cross = false;
};

class Line {
 public:
  Line(const tiling::Family& family, std::vector<double> from, std::vector<double> to)
      : family_(family), from_(std::move(from)), to_(std::move(to)) {}

  DesignOnLine at(double place) const {
    std::vector<double> parameters;
    for (std::size_t k = 0; k < from_.size(); ++k) parameters.push_back((1 - place) * from_[k] + place * to_[k]);
    const tiling::Structure structure = tiling::make_structure(family_, parameters);
    DesignOnLine design{.place = place, .stiffness = {}, .tiles_cross = structure.tiles_cross};
    for (const auto& holes : structure.holes) design.holes += holes.size();
    SimulationOptions options = hard_case_options(0.8);
    options.deformed_meshes = false;
    design.stiffness = Simulator(structure, options).run(BiaxialLoad{0, {{1, 1}}}).states.at(0).tangent;
    return design;
  }

 private:
  const tiling::Family& family_;
  std::vector<double> from_, to_;
};

double change(const DesignOnLine& a, const DesignOnLine& b) {
  return (a.stiffness - b.stiffness).norm() / std::max(a.stiffness.norm(), b.stiffness.norm());
}

std::vector<double> random_design(const tiling::Family& family, RandomStream& random, bool crossed) {
  std::vector<double> parameters;
  for (int attempt = 0; attempt < 300; ++attempt) {
    parameters.clear();
    for (const auto& [lower, upper, preset] : family.parameters) parameters.push_back(random.uniform(lower, upper));
    if (!crossed) break;
    try {
      if (tiling::make_structure(family, parameters).tiles_cross) break;
    } catch (const Error&) {
      continue;
    }
  }
  return parameters;
}

struct LineCase {
  std::string family;
  int lines;
  int steps;
};

class LinesThroughTheBox : public ::testing::TestWithParam<LineCase> {};

// Hard: tiles cross themselves, sides are short, and holes divide. The stiffness at rest changes fast there, but does
// not jump. Bisection towards the largest change therefore ends at a change below the differences between meshes,
// unless a hole opens or closes there.
TEST_P(LinesThroughTheBox, MeetNoJumpOfTheStiffnessAtRest) {
  const LineCase& c = GetParam();
  const tiling::Family& family = tiling::family(c.family);
  RandomStream random("microscale.lines." + c.family, 1);
  int designs = 0, crossing = 0;
  for (int line = 0; line < c.lines; ++line) {
    // Every other line connects designs whose tiles cross themselves, if the family has any.
    const bool crossed = line % 2 == 1;
    const Line through(family, random_design(family, random, crossed), random_design(family, random, crossed));
    std::optional<DesignOnLine> before;
    for (int k = 0; k <= c.steps; ++k) {
      try {
        const DesignOnLine here = through.at(static_cast<double>(k) / c.steps);
        ++designs;
        crossing += here.tiles_cross;
        if (before && change(*before, here) > 0.1) {
          DesignOnLine lower = *before, upper = here;
          while (upper.place - lower.place > 1e-6 && change(lower, upper) > 0.03) {
            const DesignOnLine middle = through.at((lower.place + upper.place) / 2);
            (change(lower, middle) > change(middle, upper) ? upper : lower) = middle;
          }
          EXPECT_TRUE(change(lower, upper) <= 0.03 || lower.holes != upper.holes)
              << c.family << ", line " << line << " at " << lower.place << ": " << change(lower, upper);
        }
        before = here;
      } catch (const Error& error) {
        EXPECT_TRUE(error.code() == "tiling.cell_too_small" || error.code() == "tiling.hole_closed") << error.code();
        before.reset();
      }
    }
  }
  EXPECT_GT(designs, c.steps / 2);
  EXPECT_TRUE(c.family != "IH01" || crossing > 10) << crossing;
}

INSTANTIATE_TEST_SUITE_P(Tilings, LinesThroughTheBox,
                         ::testing::Values(LineCase{"IH01", 8, 30}, LineCase{"IH22", 2, 20}, LineCase{"IH67", 3, 20},
                                           LineCase{"IH28", 1, 15}, LineCase{"square", 1, 40}),
                         [](const auto& c) { return c.param.family; });

// When joints were made tile by tile, a hole of these designs became three holes and one again, and the stiffness grew
// by a factor of twelve.
TEST(CrossingTiles, AreAsStiffAsTheirNeighboursInTheBox) {
  const tiling::Family& family = tiling::family("IH01");
  const Line line(family, {0.097405, 0.406142, 0.05, 0.762537}, {0.097405, 0.406142, 0.05, 0.782537});
  double before = line.at(0).stiffness(0, 0);
  for (int k = 1; k <= 8; ++k) {
    const DesignOnLine here = line.at(k / 8.0);
    EXPECT_TRUE(here.tiles_cross);
    EXPECT_NEAR(here.stiffness(0, 0) / before, 1, 0.05) << k;
    before = here.stiffness(0, 0);
  }
}

}  // namespace
}  // namespace supple::microscale
