#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "supple/base/random.h"
#include "supple/design/inverse_design.h"
#include "supple/design/profile.h"

namespace supple::bench {

struct DesignSettings {
  bool brief = false;
  int designs = 0;  ///< number for each family and task; 0: the study's own number
  std::vector<std::string> families;
  bool again = false;  ///< polish once more the targets that an earlier run has missed
  std::filesystem::path models = "models";
  std::filesystem::path folder = "docs/bench";

  /// The command that repeats a study.
  std::string command(const std::string& study) const;
};

/// A model with what belongs to it.
struct LoadedSpace {
  explicit LoadedSpace(const std::filesystem::path& file);
  explicit LoadedSpace(neural::Model loaded)
      : model(std::move(loaded)), evaluator(model.network), candidates(model.network) {}
  design::DesignSpace space() const { return {model, evaluator, candidates}; }
  std::string checksum;  ///< last digits of the model's file
  neural::Model model;
  neural::Evaluator evaluator;
  design::Candidates candidates;
};

std::vector<std::unique_ptr<LoadedSpace>> spaces_of(const DesignSettings& settings);
std::vector<double> random_parameters(const neural::Model& model, RandomStream& random);
/// Limit of random draws for each design, because some corners of the bounds hold no structure.
inline constexpr int max_draws_per_design = 4;

/// The profile of a design by the network as a target: 10 strains from -0.1 to 0.2, or this number of directions.
/// Nothing if the design has no equilibrium at one of them.
std::optional<design::Target> target_of(const LoadedSpace& space, const std::vector<double>& parameters,
                                        design::Task task, double direction, double strain, int directions = 50);

/// Simulates designs of a family as verifications do, in a short run without the refined mesh.
design::SimulateProfile simulation_of(const std::string& family, const DesignSettings& settings);

/// The simulated profile of a random design as a target, at 10 strains or in 12 directions at a strain of 0.05. Nothing
/// if it cannot be simulated at every sample.
std::optional<design::Target> simulated_target(const LoadedSpace& space, design::Task task, RandomStream& random,
                                               const design::SimulateProfile& simulate);

/// Draws the same random numbers as simulated_target.
void skip_target(const LoadedSpace& space, RandomStream& random);

inline constexpr design::Task all_tasks[] = {design::Task::stress_strain, design::Task::stiffness,
                                             design::Task::poisson};

void study_design_accuracy(const DesignSettings& settings);
void study_design_speed(const DesignSettings& settings);
void study_verification(const DesignSettings& settings);
void study_polish(const DesignSettings& settings);

}  // namespace supple::bench
