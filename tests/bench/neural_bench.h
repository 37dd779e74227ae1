#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "supple/neural/model.h"

/// The studies of the neural benchmark. Each writes a page of its own.
namespace supple::bench {

struct NeuralSettings {
  std::filesystem::path folder = "docs/bench";
  std::filesystem::path models = "models";             ///< trained models, and their data sets in "datasets"
  std::filesystem::path work = "build/bench/studies";  ///< simulations and trainings, which later runs go on from
  /// Few repetitions and designs: shows that the program works, not what the numbers are.
  bool brief = false;
  int designs = 0;                      ///< random designs of each model; 0 for as many as the study is meant to have
  std::vector<std::string> families{};  ///< empty: all models of the folder

  int designs_or(int usual) const { return designs > 0 ? designs : usual; }
};

std::string neural_introduction(const NeuralSettings& settings, const std::string& study,
                                const std::string& conditions);

/// Where a study keeps what takes long to make, made if it is not there. Empty at first in a short run, which is to
/// show that all of it works.
std::filesystem::path work_folder(const NeuralSettings& settings, const std::string& study);

/// The models of the folder that the settings ask for, by name of the file.
std::vector<neural::Model> models_of(const NeuralSettings& settings);

void study_speed(const NeuralSettings& settings);
void study_uniaxial(const NeuralSettings& settings);
void study_floor(const NeuralSettings& settings);
void study_native_time(const NeuralSettings& settings);
void study_smoothness(const NeuralSettings& settings);
void study_activations(const NeuralSettings& settings);
void study_singularity(const NeuralSettings& settings);
void study_cost(const NeuralSettings& settings);
void study_data(const NeuralSettings& settings);
void study_training(const NeuralSettings& settings);

}  // namespace supple::bench
