// Parameters at which a tiling's topology changes, holes open or close, or the box of parameters has a corner.
#include <ostream>

#include "simulation_case.h"

namespace supple::microscale {
namespace {

struct ParameterCase {
  std::string name;
  std::string family;
  std::vector<double> parameters;
};

void PrintTo(const ParameterCase& c, std::ostream* out) { *out << c.name; }

class NearSingularParameters : public ::testing::TestWithParam<ParameterCase> {};

// Hard: sides of nearly no length, holes that have only just opened, and angles that gmsh must not lose.
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

}  // namespace
}  // namespace supple::microscale
