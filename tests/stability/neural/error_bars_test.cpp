// Error bars of the shipped models for designs and strains with which they were not calibrated.
#include "supple/neural/error_bars.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "supple/base/random.h"
#include "supple/neural/uniaxial.h"

namespace supple::neural {
namespace {

std::vector<std::string> calibrated_models() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(SUPPLE_MODELS))
    if (entry.path().extension() == ".h5") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

class ErrorBarsOfShippedModels : public ::testing::TestWithParam<std::string> {
 protected:
  ErrorBarsOfShippedModels()
      : model_(read_model(std::filesystem::path(SUPPLE_MODELS) / (GetParam() + ".h5"))), evaluator_(model_.network) {}

  /// The parameters on the diagonal of their box: 0 is at the lower bounds, and 1 at the upper ones.
  std::vector<double> at(double share) const {
    const Eigen::VectorXd p = model_.network.lower + share * (model_.network.upper - model_.network.lower);
    return {p.begin(), p.end()};
  }

  /// The trust in a quantity at each strain, which is reached directly from rest. None if there is no equilibrium.
  std::vector<std::optional<Trust>> along(const std::vector<double>& parameters, double direction,
                                          const std::vector<double>& strains, Quantity quantity) const {
    const auto design = evaluator_.design(parameters);
    const ErrorBars bars(model_, evaluator_, design, parameters, true);
    std::vector<std::optional<Trust>> asked(strains.size());
    for (std::size_t i = 0; i < strains.size(); ++i) {
      const auto state = uniaxial_path(evaluator_, design, direction, std::vector{strains[i]}).front();
      if (state.converged)
        asked[i] = bars.uniaxial(quantity, UniaxialFrame(direction), strains[i], state.strain,
                                 {state.energy_density, state.stress, state.tangent});
    }
    return asked;
  }

  Model model_;
  Evaluator evaluator_;
};

constexpr std::array<Quantity, 3> uniaxial_quantities{Quantity::stress, Quantity::stiffness, Quantity::poisson};

TEST_P(ErrorBarsOfShippedModels, AreThereForEveryModel) { EXPECT_TRUE(model_.calibration.has_value()); }

// Hard: at corners of the box, there are training data on one side only.
TEST_P(ErrorBarsOfShippedModels, AreFiniteAtTheEdgesOfTheBoxAndOfTheStrains) {
  for (const double share : {0.0, 1e-9, 0.5, 1.0}) {
    for (const auto quantity : uniaxial_quantities) {
      for (int k = 0; k < 6; ++k) {
        const auto asked = along(at(share), k * std::numbers::pi / 6, {-0.2, -1e-3, 1e-3, 0.1, 0.5}, quantity);
        for (const auto& trust : asked) {
          if (!trust || !trust->error) continue;
          EXPECT_GE(*trust->error, 0);
          EXPECT_LE(*trust->error, largest_error);
          EXPECT_EQ(trust->in_range, *trust->error <= max_trusted_error(quantity));
        }
        // In a corner there may be no valid tile, so that the stiffness that the network predicts may make no sense.
        if (share == 0.5) {
          EXPECT_TRUE(asked[1] && asked[1]->error && asked[2] && asked[2]->error) << "next to rest";
        }
      }
    }
  }
}

// Hard: ratios of stresses to strains are 0 / 0 at rest.
TEST_P(ErrorBarsOfShippedModels, DoNotJumpAtRest) {
  for (const auto quantity : uniaxial_quantities) {
    const auto bars = along(at(0.4), 0.3, {-1e-7, 0, 1e-7}, quantity);
    for (const auto& trust : bars) {
      ASSERT_TRUE(trust && trust->error);
      EXPECT_NEAR(*trust->error, *bars[1]->error, 0.02 * *bars[1]->error + 1e-5);
    }
  }
}

// Hard: there were no simulations with which errors could be compared.
TEST_P(ErrorBarsOfShippedModels, AreSilentFarOutside) {
  for (const double share : {-0.1, 1.1, 50.0, -1e6}) {
    for (const auto& trust : along(at(share), 0.5, {-0.01, 0.02}, Quantity::stress)) {
      if (!trust) continue;
      EXPECT_FALSE(trust->in_range);
      EXPECT_FALSE(trust->error.has_value());
    }
  }
  for (const auto& trust : along(at(0.5), 0.5, {-0.499, 7}, Quantity::stiffness)) {
    if (!trust) continue;
    EXPECT_FALSE(trust->in_range);
    EXPECT_FALSE(trust->error.has_value());
  }
}

// Hard: requests may contain any strain.
TEST_P(ErrorBarsOfShippedModels, AreFiniteOrSilentAtAnyStrain) {
  RandomStream random("error bars at any strain " + GetParam(), 1);
  for (int i = 0; i < 300; ++i) {
    const auto parameters = at(random.uniform(-0.05, 1.05));
    const auto design = evaluator_.design(parameters);
    const ErrorBars bars(model_, evaluator_, design, parameters, false);
    const double size = std::pow(10, random.uniform(-12, 2));
    const Eigen::Vector3d strain = size * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    const auto answer = evaluator_.evaluate(design, strain, Order::stress);
    const auto trust = bars.at_strain(strain, answer.energy_density[0], answer.stress.col(0));
    if (trust.error) {
      EXPECT_TRUE(*trust.error >= 0 && *trust.error <= largest_error) << "sample " << i;
    } else {
      EXPECT_FALSE(trust.in_range) << "sample " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, ErrorBarsOfShippedModels, ::testing::ValuesIn(calibrated_models()),
                         [](const auto& instance) { return instance.param; });

}  // namespace
}  // namespace supple::neural
