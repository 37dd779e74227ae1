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
  int designs = 0;  ///< of each family and task; 0: the study's own number
  std::vector<std::string> families;
  bool again = false;  ///< targets that polish has missed in an earlier run
  std::filesystem::path models = "models";
  std::filesystem::path folder = "docs/bench";
};

/// A model with what belongs to it.
struct LoadedSpace {
  explicit LoadedSpace(const std::filesystem::path& file);
  explicit LoadedSpace(neural::Model loaded)
      : model(std::move(loaded)), evaluator(model.network), candidates(model.network) {}
  design::DesignSpace space() const { return {model, evaluator, candidates}; }
  std::string checksum;  ///< of the model's file, as it ends
  neural::Model model;
  neural::Evaluator evaluator;
  design::Candidates candidates;
};

std::string design_introduction(const DesignSettings& settings, const std::string& study, const std::string& text);
std::vector<std::unique_ptr<LoadedSpace>> spaces_of(const DesignSettings& settings);
std::vector<double> random_parameters(const neural::Model& model, RandomStream& random);
/// Of random parameters, for each design wanted: some corners of the bounds hold no structure.
inline constexpr int most_draws_per_design = 4;

/// The target that a design has exactly: 10 strains from -0.1 to 0.2, or so many directions. None where the design has
/// no equilibrium at one of them.
std::optional<design::Target> target_of(const LoadedSpace& space, const std::vector<double>& parameters,
                                        design::Task task, double direction, double strain, int directions = 50);

/// Simulates designs of a family on the mesh that verifies them, in a brief run on the coarser one.
design::SimulateProfile simulation_of(const std::string& family, const DesignSettings& settings);

/// A target that a random design has exactly by simulation, at 10 strains or in 12 directions at a strain of 0.05; none
/// where it cannot be simulated at every sample.
std::optional<design::Target> simulated_target(const LoadedSpace& space, design::Task task, RandomStream& random,
                                               const design::SimulateProfile& simulate);

/// Draws from `random` what simulated_target draws.
void skip_target(const LoadedSpace& space, RandomStream& random);

inline constexpr design::Task all_tasks[] = {design::Task::stress_strain, design::Task::stiffness,
                                             design::Task::poisson};

void study_recovery(const DesignSettings& settings);
void study_design_speed(const DesignSettings& settings);
void study_design_accuracy(const DesignSettings& settings);
void study_profiles(const DesignSettings& settings);
void study_solvers(const DesignSettings& settings);
void study_verification(const DesignSettings& settings);
void study_freedoms(const DesignSettings& settings);
void study_width(const DesignSettings& settings);
void study_polish(const DesignSettings& settings);
void study_discretization(const DesignSettings& settings);
void study_native(const DesignSettings& settings);
void study_design_smoothness(const DesignSettings& settings);

}  // namespace supple::bench
