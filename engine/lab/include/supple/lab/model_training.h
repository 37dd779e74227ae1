#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "supple/dataset/dataset.h"
#include "supple/neural/model.h"
#include "supple/tiling/family.h"
#include "supple/training/trainer.h"

namespace supple::lab {

/// Maps A of strains e = (E_xx, E_yy, 2 E_xy) under which every structure of the family stores the same energy: those
/// of the rotations and reflections that carry a tile of the cell to another. Without the identity.
std::vector<Eigen::Matrix3d> strain_symmetries(const tiling::Family& family);

struct ModelOptions {
  std::string id;  ///< empty: the family's, in lower case
  training::SampleOptions samples;
  training::SplitOptions split;
  training::TrainingOptions training;  ///< `shape.parameters` and `symmetries` are set from the data
  bool use_symmetry = true;
};

struct ModelResult {
  neural::Model model;  ///< with its measured errors
  std::vector<training::EpochReport> history;
  int best_epoch = 0;
  bool finished = false;
};

/// Trains a network on a data set, as training::train, and measures it on designs and on rows that training has not
/// seen. Throws what that throws, and "tiling.family_not_found".
ModelResult train_model(const dataset::Dataset& data, const std::string& data_name, const ModelOptions& options,
                        const std::filesystem::path& checkpoint, const CancellationToken& cancellation,
                        const std::function<void(const training::EpochReport&)>& report);

}  // namespace supple::lab
