#pragma once

#include <torch/types.h>

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "supple/base/random.h"
#include "supple/training/samples.h"
#include "torch_network.h"

namespace supple::training {

/// Rows of one design, which go together: its parameter branch is evaluated once for them.
struct Chunk {
  int design = 0;  ///< index into the samples' designs
  std::vector<std::int64_t> rows;
};

/// The rows by design, a chunk for each design that has any; `rows` ascend.
std::vector<Chunk> chunks_by_design(const Samples& samples, const std::vector<int>& rows);

/// Pieces of nearly equal length of at most `chunk_rows` rows, in an order that the stream draws, as are the rows of
/// each.
std::vector<Chunk> shuffled_chunks(const std::vector<Chunk>& designs, int chunk_rows, RandomStream& stream);

/// Strains of several designs with what the simulation says about them, in single precision.
struct LabelledBatch {
  Batch batch;
  torch::Tensor energy;   ///< rows, MPa
  torch::Tensor stress;   ///< rows x 3, MPa
  torch::Tensor tangent;  ///< rows x 3 x 3, MPa
};

/// The samples as tensors on a device, and chunks of them as they are or seen through symmetries.
class TrainingData {
 public:
  /// `symmetries` are maps A of strains; the identity comes first besides them.
  TrainingData(const Samples& samples, const std::vector<Eigen::Matrix3d>& symmetries, torch::Device device);

  /// Number of symmetries, the identity among them.
  int symmetries() const { return symmetries_; }
  /// All designs' parameters, mapped from their bounds to [-1, 1]: designs x parameters.
  const torch::Tensor& designs() const { return p_; }
  /// Type and device of the tensors.
  torch::TensorOptions tensor_options() const { return strain_.options(); }

  /// The rows of the chunks, each chunk seen through the symmetry of its number: e -> A e, S -> A^-T S, C -> A^-T C
  /// A^-1. About 100 flops a row.
  LabelledBatch labelled(std::span<const Chunk> chunks, std::span<const int> symmetry) const;

 private:
  torch::Tensor p_;
  torch::Tensor strain_;
  torch::Tensor stress_;
  torch::Tensor energy_;
  torch::Tensor tangent_;  ///< rows x 6
  int symmetries_ = 1;
  torch::Tensor strain_maps_;  ///< symmetries x 3 x 3: A
  torch::Tensor stress_maps_;  ///< symmetries x 3 x 3: A^-T
};

}  // namespace supple::training
