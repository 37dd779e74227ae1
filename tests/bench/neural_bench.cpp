// Neural models: uniaxial curves and times against fresh simulations, and what evaluations cost against the
// arithmetic's floor and LibTorch. Each study writes a section of models.md.
//
//   neural_bench [--short] [--designs N] [--family ID ...] [--models DIR] [--work DIR] [--out DIR] [STUDY ...]
//   default: all studies into docs/bench
#include "neural_bench.h"

#include <algorithm>
#include <string>
#include <vector>

#include "command_line.h"

namespace supple::bench {

std::string NeuralSettings::command(const std::string& study) const {
  return "neural_bench " + (designs > 0 ? "--designs " + std::to_string(designs) + " " : "") + study;
}

std::filesystem::path work_folder(const NeuralSettings& settings, const std::string& study) {
  const auto folder = settings.work / study;
  if (settings.brief) std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

std::vector<neural::Model> models_of(const NeuralSettings& settings) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(settings.models))
    if (entry.path().extension() == ".h5") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<neural::Model> models;
  for (const auto& file : files) {
    auto model = neural::read_model(file);
    const auto& wanted = settings.families;
    if (wanted.empty() || std::find(wanted.begin(), wanted.end(), model.family) != wanted.end())
      models.push_back(std::move(model));
  }
  // One small cell and one of several tiles suffice for a short run.
  if (settings.brief && settings.families.empty())
    std::erase_if(models, [](const neural::Model& model) { return model.family != "IH01" && model.family != "IH67"; });
  return models;
}

}  // namespace supple::bench

int main(int argc, char** argv) {
  using namespace supple::bench;
  NeuralSettings settings;
  return run_program(argc, argv,
                     {flag("--short", settings.brief), number_option("--designs", settings.designs),
                      list_option("--family", settings.families), folder_option("--models", settings.models),
                      folder_option("--work", settings.work), folder_option("--out", settings.folder)},
                     {{"uniaxial", [&] { study_uniaxial(settings); }},
                      {"native-time", [&] { study_native_time(settings); }},
                      {"speed", [&] { study_speed(settings); }}});
}
