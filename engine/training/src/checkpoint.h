#pragma once

#include <torch/types.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "supple/files/hdf5_file.h"
#include "supple/training/trainer.h"

namespace supple::training {

/// The state from which a training continues.
struct Checkpoint {
  using Tensors = std::vector<std::pair<std::string, torch::Tensor>>;
  std::vector<std::pair<std::string, std::string>> options;  ///< what identifies the training (see identity)
  Tensors parameters;
  Tensors best;  ///< parameters of the best epoch
  Tensors optimizer;
  std::int64_t steps = 0;
  int epochs = 0;  ///< number of complete epochs
  int best_epoch = 0;
  double best_error = 0;
  double seconds = 0;
  std::vector<EpochReport> history;
};

/// Writes tensors in single precision as a group of the file: members 0, 1, ..., and `names`. Each name is followed by
/// " matrix" or " vector".
void write_tensors(files::Hdf5Writer& file, const std::string& group, const Checkpoint::Tensors& tensors);
Checkpoint::Tensors read_tensors(const files::Hdf5Reader& file, const std::string& group);

/// Writes a file that appears completely or not at all. Throws "file.write_failed".
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// Throws "file.unreadable".
Checkpoint read_checkpoint(const std::filesystem::path& path);

}  // namespace supple::training
