#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "supple/neural/model.h"

/// The studies of the neural benchmark. Each writes a section of models.md.
namespace supple::bench {

struct NeuralSettings {
  std::filesystem::path folder = "docs/bench";
  std::filesystem::path models = "models";             ///< trained models
  std::filesystem::path work = "build/bench/studies";  ///< simulations that later runs use again
  /// Few repetitions and designs: shows that the program works, not what the numbers are.
  bool brief = false;
  int designs = 0;                      ///< random designs of each model; 0: the study's own number
  std::vector<std::string> families{};  ///< empty: all models of the folder

  int designs_or(int usual) const { return designs > 0 ? designs : usual; }
  /// The command that repeats a study.
  std::string command(const std::string& study) const;
};

/// The folder in which a study saves what takes long to compute; it is created if it is missing. A short run empties it
/// first, so that it shows that everything works.
std::filesystem::path work_folder(const NeuralSettings& settings, const std::string& study);

/// The models that the settings ask for, in the order of their files' names.
std::vector<neural::Model> models_of(const NeuralSettings& settings);

void study_uniaxial(const NeuralSettings& settings);
void study_native_time(const NeuralSettings& settings);
void study_speed(const NeuralSettings& settings);

}  // namespace supple::bench
