// Curves that no design of a family follows. A search by the network's deviation alone then ends where the network is
// wrong. Shipped models and real simulations on coarse meshes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "supple/base/random.h"
#include "supple/design/inverse_design.h"
#include "supple/design/verification.h"
#include "supple/tiling/structure.h"

namespace supple::design {
namespace {

constexpr int curves = 12;

class TrustedDesigns : public ::testing::Test {
 protected:
  static microscale::SimulationOptions coarse() {
    microscale::SimulationOptions options;
    options.mesh.mesh_size = 1;
    options.refinement = microscale::Refinement::extrapolated;
    return options;
  }
  DesignSpace space() const {
    return {model, evaluator, candidates, [this](const Eigen::VectorXd& parameters) {
              return tiling::can_be_built(tiling::family(model.family),
                                          {parameters.data(), static_cast<std::size_t>(parameters.size())});
            }};
  }

  neural::Model model = neural::read_model(std::filesystem::path(SUPPLE_MODELS) / "ih01.h5");
  neural::Evaluator evaluator{model.network};
  Candidates candidates{model.network};
  SimulateProfile simulate = simulation_of(tiling::family(model.family), coarse());
};

/// A random curve in tension or compression. The stress is a power of the strain, from 0.5 (stiff, then soft) to 2.5
/// (soft, then stiff).
Target drawn_curve(RandomStream& random) {
  Target target;
  target.direction = random.uniform(0, 3);
  target.samples = 8;
  const double end = random.uniform(0.1, 0.2);
  const double height = std::exp(random.uniform(std::log(0.02), std::log(0.7)));
  const double power = random.uniform(0.5, 2.5);
  const double sign = random.uniform() < 0.5 ? -1 : 1;
  for (int i = 0; i <= 5; ++i)
    target.control_points.emplace_back(sign * end * i / 5, sign * height * std::pow(i / 5.0, power));
  if (sign < 0) std::reverse(target.control_points.begin(), target.control_points.end());
  return target;
}

/// The errors of a design by its simulation.
struct Seen {
  double deviation = 0;  ///< relative deviation of the simulation from the target
  double error = 0;      ///< relative error of the model against the simulation
  bool is_trusted = true;
};

TEST_F(TrustedDesigns, DeviateLessFromCurvesOutOfReachThanTheNearestOnesByTheModel) {
  RandomStream random("curves out of reach", 20);
  double sum_nearest = 0;
  double sum_trusted = 0;
  int wrong_nearest = 0;
  int wrong_and_trusted = 0;
  int changed = 0;
  for (int k = 0; k < curves; ++k) {
    const DesignProblem problem{{drawn_curve(random)}, {}, {}};
    const auto look = [&](Switch trust) -> std::optional<Seen> {
      DesignOptions options;
      options.trust = trust;
      const auto design = find_design(space(), problem, options);
      const auto& profile = design.profiles[0];
      const Eigen::VectorXd y = simulate(design.parameters, profile.target.samples, {});
      if (!y.allFinite()) return std::nullopt;
      Seen seen;
      seen.deviation = *profile.target.relative_rms(y);
      seen.error = (y - profile.achieved).norm() / y.norm();
      for (const auto flag : profile.in_range) seen.is_trusted = seen.is_trusted && flag != 0;
      return seen;
    };
    const auto nearest = look(Switch::off);
    const auto trusted = look(Switch::automatic);
    if (!nearest || !trusted) continue;
    sum_nearest += std::log(nearest->deviation);
    sum_trusted += std::log(trusted->deviation);
    changed += nearest->deviation != trusted->deviation ? 1 : 0;
    wrong_nearest += nearest->error > 0.1 ? 1 : 0;
    wrong_and_trusted += trusted->error > 0.1 && trusted->is_trusted ? 1 : 0;
    RecordProperty("curve_" + std::to_string(k),
                   std::to_string(nearest->deviation) + " " + std::to_string(trusted->deviation));
  }
  EXPECT_GE(changed, curves / 4) << "or nothing is hard";
  EXPECT_GT(wrong_nearest, 0) << "or nothing is hard";
  EXPECT_LT(sum_trusted, sum_nearest);
  EXPECT_LE(wrong_and_trusted, 1) << "nine of ten errors are within their bars";
}

}  // namespace
}  // namespace supple::design
