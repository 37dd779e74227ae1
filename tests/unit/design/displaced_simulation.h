#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "supple/design/polish.h"
#include "test_space.h"

namespace supple::design {

inline constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// Replaces a simulation: the network at slightly displaced parameters, times a factor. The deviation by this
/// simulation has its minima at other parameters than the deviation by the network.
class Displaced {
 public:
  explicit Displaced(const TestSpace& test, double factor = 1.05) : test_(test), factor_(factor) {}

  Eigen::VectorXd operator()(const Eigen::VectorXd& parameters, const ProfileSamples& samples) const {
    const Eigen::VectorXd width = test_.model.network.upper - test_.model.network.lower;
    const Eigen::VectorXd share = (parameters - test_.model.network.lower).cwiseQuotient(width);
    std::vector<double> moved(static_cast<std::size_t>(share.size()));
    for (Eigen::Index k = 0; k < share.size(); ++k)
      moved[static_cast<std::size_t>(k)] =
          test_.model.network.lower[k] + width[k] * (share[k] + 0.04 * std::sin(3 * share[k] + 1.0 * k));
    return factor_ * evaluate_profile(test_.model, test_.evaluator, moved, samples).y;
  }

  SimulateProfile counted(int& calls) const {
    return
        [this, &calls](const Eigen::VectorXd& parameters, const ProfileSamples& samples, const Execution& execution) {
          ++calls;
          execution.checkpoint(0, "simulation");
          return (*this)(parameters, samples);
        };
  }

 private:
  const TestSpace& test_;
  double factor_;
};

inline Target target_at(const TestSpace& test, const Displaced& simulation, std::vector<double> shares, Task task,
                        int points = 9) {
  Target target;
  target.task = task;
  target.direction = 0.3;
  target.strain = 0.1;
  target.samples = points;
  target.interpolation = numerics::Interpolation::linear;
  ProfileSamples samples{task, target.direction, target.strain, StrainMeasure::green, {}};
  for (int i = 0; i < points; ++i)
    samples.x.push_back(task == Task::stress_strain ? -0.1 + 0.3 * i / (points - 1) : std::numbers::pi * i / points);
  const auto at = test.at(std::move(shares));
  const Eigen::VectorXd parameters = Eigen::Map<const Eigen::VectorXd>(at.data(), static_cast<Eigen::Index>(at.size()));
  const auto y = simulation(parameters, samples);
  for (int i = 0; i < points; ++i) target.control_points.emplace_back(samples.x[static_cast<std::size_t>(i)], y[i]);
  return target;
}

/// A problem in which the network's design deviates by some per cent in the simulation.
struct Missed {
  explicit Missed(Task task = Task::stress_strain, int points = 9)
      : problem{{target_at(test, displaced, {0.4, 0.65}, task, points)}, {}, {}},
        found(find_design(test.space(), problem)) {}

  Polished polished(const PolishOptions& options = {}, const Execution& execution = {},
                    const OnPolishRound& on_round = {}) {
    return polish(test.space(), problem, found.parameters, simulate, options, execution, on_round);
  }

  TestSpace test{2, 1};
  Displaced displaced{test};
  DesignProblem problem;
  Design found;
  int calls = 0;
  SimulateProfile simulate = displaced.counted(calls);
};

}  // namespace supple::design
