#pragma once

#include <torch/types.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "supple/files/hdf5_file.h"
#include "supple/training/trainer.h"

namespace supple::training {

/// All that training goes on from.
struct Checkpoint {
  using Tensors = std::vector<std::pair<std::string, torch::Tensor>>;
  std::vector<std::pair<std::string, std::string>> options;  ///< of the training, and a mark of its samples
  Tensors parameters;
  Tensors best;  ///< parameters of the best epoch
  Tensors optimizer;
  std::int64_t steps = 0;
  int epochs = 0;  ///< that are complete
  int best_epoch = 0;
  double best_error = 0;
  double seconds = 0;
  std::vector<EpochReport> history;
};

/// A group of tensors in single precision: members 0, 1, ..., and `names`, each with " matrix" or " vector" behind it.
void write_tensors(files::Hdf5Writer& file, const std::string& group, const Checkpoint::Tensors& tensors);
Checkpoint::Tensors read_tensors(const files::Hdf5Reader& file, const std::string& group);

/// The file appears whole or not at all. Throws "file.write_failed".
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// Throws "file.unreadable".
Checkpoint read_checkpoint(const std::filesystem::path& path);

}  // namespace supple::training
