#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "supple/design/inverse_design.h"
#include "support/random_network.h"

namespace supple::design {

/// A model with random weights. It is small, so that tests are fast, and its response is clearly nonlinear.
inline neural::Model random_model(int parameters, std::uint64_t seed) {
  neural::NetworkShape shape;
  shape.parameters = parameters;
  shape.width = 16;
  shape.stiffness_width = 16;
  neural::Model model;
  model.id = "test-" + std::to_string(seed);
  model.family = "IH" + std::to_string(seed);
  model.network = neural::random_network(shape, seed);
  // The quadratic part prevails, so that the energy is convex over the strains of the tests.
  model.network.trunk.back().weights *= 0.05;
  model.strain_range = {-0.4, 0.8, 10};
  return model;
}

/// A model, and what its design space refers to.
struct TestSpace {
  explicit TestSpace(int parameters, std::uint64_t seed)
      : model(random_model(parameters, seed)), evaluator(model.network), candidates(model.network) {}
  DesignSpace space() const { return {model, evaluator, candidates}; }
  /// Parameters at these fractions of their bounds.
  std::vector<double> at(std::vector<double> shares) const {
    for (std::size_t k = 0; k < shares.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      shares[k] = model.network.lower[i] + shares[k] * (model.network.upper[i] - model.network.lower[i]);
    }
    return shares;
  }

  neural::Model model;
  neural::Evaluator evaluator;
  Candidates candidates;
};

/// A target that the given parameters meet exactly. Its samples are its control points.
inline Target target_of(const TestSpace& test, const std::vector<double>& parameters, Task task, int points = 12) {
  Target target;
  target.task = task;
  target.direction = 0.3;
  target.strain = 0.1;
  target.samples = points;
  ProfileSamples samples{task, target.direction, target.strain, StrainMeasure::green, {}};
  for (int i = 0; i < points; ++i)
    samples.x.push_back(task == Task::stress_strain ? -0.1 + 0.3 * i / (points - 1) : std::numbers::pi * i / points);
  const auto profile = evaluate_profile(test.model, test.evaluator, parameters, samples);
  for (int i = 0; i < points; ++i)
    target.control_points.emplace_back(samples.x[static_cast<std::size_t>(i)], profile.y[i]);
  return target;
}

inline Eigen::VectorXd vector_of(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace supple::design
