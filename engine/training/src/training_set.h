#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "supple/neural/network.h"
#include "supple/training/samples.h"
#include "supple/training/trainer.h"

namespace supple::training {

/// What identifies a training: its options, the number of its rows and a weighted sum of their energies, and the number
/// and sum of its stiffnesses at rest. Trainings of the same identity have the same result.
std::vector<std::pair<std::string, std::string>> identity(const Samples& samples, const Split& split,
                                                          const TrainingOptions& options,
                                                          const std::vector<RestStiffness>& rest);

/// Throws "training.different_options" if the identity of a training differs from that in a file, and names the first
/// entry that differs.
void require_same(const std::vector<std::pair<std::string, std::string>>& expected,
                  const std::vector<std::pair<std::string, std::string>>& found, const std::filesystem::path& file);

/// Writes the initial network, the rows, the part of the split to which each row belongs, and the images of the designs
/// under each symmetry. Tensors are in single precision. docs/models.md lists the content of the file. Throws
/// "file.write_failed".
void write_training_set(const std::filesystem::path& path, const Samples& samples, const Split& split,
                        const TrainingOptions& options, const std::vector<RestStiffness>& rest,
                        const neural::Network& initial_network);

/// The network that another trainer has trained on a training set.
struct ImportedNetwork {
  neural::Network network;
  std::vector<std::pair<std::string, std::string>> options;  ///< how it was trained, by name
  double seconds = 0;
};

/// Reads the file that another trainer wrote. Throws "file.unreadable" if it is no trained network of the shape in
/// `options`, and "training.different_options" unless the network was trained on the set that these arguments
/// determine.
ImportedNetwork read_trained(const std::filesystem::path& path, const Samples& samples, const Split& split,
                             const TrainingOptions& options, const std::vector<RestStiffness>& rest);

}  // namespace supple::training
