// The ends of the range of loads, for every family at its default parameters.
#include <numbers>
#include <ostream>

#include "simulation_case.h"

namespace supple::microscale {
namespace {

struct FamilyCase {
  std::string family;
  double direction;  // rad; along beams, so that compression buckles them
  double mesh_size;
};

void PrintTo(const FamilyCase& c, std::ostream* out) { *out << c.family; }

class LargeStrain : public ::testing::TestWithParam<FamilyCase> {
 protected:
  void load_to(const std::vector<double>& stretches) {
    const FamilyCase& c = GetParam();
    const UniaxialLoad load{c.direction, stretches};
    std::vector<double> parameters = preset(c.family);
    expect_resistance(follow(c.family, parameters, load, hard_case_options(c.mesh_size)), load);
  }
};

// Hard: beams buckle, fold and come to lie on each other.
TEST_P(LargeStrain, CompressionByThirtyPercentConverges) { load_to({0.97, 0.9, 0.8, 0.7}); }

// Hard: beams rotate into the direction of the load, and become many times as stiff.
TEST_P(LargeStrain, TensionByFiftyPercentConverges) { load_to({1.03, 1.15, 1.3, 1.5}); }

constexpr double upright = std::numbers::pi / 2;
INSTANTIATE_TEST_SUITE_P(Families, LargeStrain,
                         ::testing::Values(FamilyCase{"IH01", upright, 0.5}, FamilyCase{"IH21", 0, 1},
                                           FamilyCase{"IH22", upright, 0.5}, FamilyCase{"IH28", 0, 1},
                                           FamilyCase{"IH29", 0, 1}, FamilyCase{"IH50", upright, 0.8},
                                           FamilyCase{"IH67", upright, 0.5}, FamilyCase{"square", 0, 0.8}),
                         [](const auto& c) { return c.param.family; });

}  // namespace
}  // namespace supple::microscale
