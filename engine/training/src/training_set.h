#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "supple/neural/network.h"
#include "supple/training/samples.h"
#include "supple/training/trainer.h"

namespace supple::training {

/// The options of a training with marks of its rows: trainings agree in them if they learn the same from the same.
std::vector<std::pair<std::string, std::string>> identity(const Samples& samples, const Split& split,
                                                          const TrainingOptions& options,
                                                          const std::vector<RestStiffness>& rest);

/// Throws "training.different_options", which names the first option in which `theirs`, of a file, differs.
void require_same(const std::vector<std::pair<std::string, std::string>>& mine,
                  const std::vector<std::pair<std::string, std::string>>& theirs, const std::filesystem::path& file);

/// Writes the first network, the rows, their parts of the split, and the designs as they are seen through each
/// symmetry, all as tensors in single precision. docs/models.md lists what the file holds. Throws "file.write_failed".
void write_training_set(const std::filesystem::path& path, const Samples& samples, const Split& split,
                        const TrainingOptions& options, const std::vector<RestStiffness>& rest,
                        const neural::Network& first);

/// What another trainer made of a training set.
struct TrainedElsewhere {
  neural::Network network;
  std::vector<std::pair<std::string, std::string>> options;  ///< how it was trained, by name
  double seconds = 0;
};

/// Reads a network of the shape of `first`. Throws "file.unreadable", and "training.different_options" unless the
/// network was trained on the set that these arguments make.
TrainedElsewhere read_trained(const std::filesystem::path& path, const Samples& samples, const Split& split,
                              const TrainingOptions& options, const std::vector<RestStiffness>& rest);

}  // namespace supple::training
