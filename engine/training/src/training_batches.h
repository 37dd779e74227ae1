#pragma once

#include <torch/types.h>

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "supple/base/random.h"
#include "supple/training/samples.h"
#include "supple/training/trainer.h"
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
  /// rows x 3 x 3, MPa^-1/2: maps unit vectors to strains that all cost the same, v^T C v = 1 of the tangent C.
  /// Absolute eigenvalues stand for negative ones, and small ones are bounded below.
  torch::Tensor whitening;
};

/// What designs, a column of parameters each, are to a network: parameters mapped from their bounds to [-1, 1] and the
/// geometry's features below them, a column each.
Eigen::MatrixXd design_inputs(const Samples& samples, const neural::TileGeometry& geometry,
                              const Eigen::Ref<const Eigen::MatrixXd>& parameters);
/// The designs' parameters as seen through a symmetry, a column each.
Eigen::MatrixXd images(const Eigen::Ref<const Eigen::MatrixXd>& parameters, const EnergySymmetry& symmetry);
/// The identity and the given ones.
std::vector<EnergySymmetry> with_identity(const std::vector<EnergySymmetry>& symmetries, long parameters);
/// Whether a design is one of others, a column each; by mapped parameters.
bool lies_on(const Eigen::Ref<const Eigen::VectorXd>& design, const Eigen::Ref<const Eigen::MatrixXd>& others);
/// Whether the image of a design may be trained on, both given by mapped parameters: it lies in the box or not further
/// from it than the data may, and on none of the designs that are held out (a column each).
bool usable_image(const Eigen::Ref<const Eigen::VectorXd>& own, const Eigen::Ref<const Eigen::VectorXd>& image,
                  const Eigen::Ref<const Eigen::MatrixXd>& held_out);

/// A design as it is, or its image under a symmetry.
struct SeenDesign {
  std::int64_t design = 0;
  std::int64_t symmetry = 0;  ///< 0: as it is
};

/// The samples as tensors on a device, and chunks of them as they are or seen through symmetries.
class TrainingData {
 public:
  /// Designs that lie on one another by a symmetry are one design: images on `held_out` ones are not used.
  /// `geometry` lists the features that follow the parameters; it may be empty.
  TrainingData(const Samples& samples, const std::vector<EnergySymmetry>& symmetries, const std::vector<int>& held_out,
               const neural::TileGeometry& geometry, torch::Device device);

  /// Which symmetries a design may be seen through; the first is 0.
  const std::vector<int>& symmetries_of(int design) const { return usable_[static_cast<std::size_t>(design)]; }
  /// Parameters, mapped from their bounds to [-1, 1], and features: designs x (parameters + features).
  torch::Tensor parameters(std::span<const SeenDesign> designs) const;
  /// A^-T, by which stresses go with strains through the symmetry.
  const Eigen::Matrix3d& stress_map(std::int64_t symmetry) const {
    return stress_map_of_[static_cast<std::size_t>(symmetry)];
  }
  /// Type and device of the tensors.
  torch::TensorOptions tensor_options() const { return strain_.options(); }

  /// All of it as tables for another trainer, by name: "inputs" (designs under the first symmetry, the second, ...),
  /// "usable" (designs x symmetries, 1 where a design may be seen through it), "strain", "stress", "energy", "tangent"
  /// and "whitening" of each row, and "strain_maps" (A of each symmetry, a row of 9).
  std::vector<std::pair<std::string, torch::Tensor>> tables() const;

  /// The rows of the chunks, each chunk seen through the symmetry of its number: e -> A e, S -> A^-T S, C -> A^-T C
  /// A^-1, W -> A W. About 150 flops a row.
  LabelledBatch labelled(std::span<const Chunk> chunks, std::span<const int> symmetry) const;

 private:
  std::int64_t designs_ = 0;
  torch::Tensor p_;  ///< images under the first symmetry, the second, ... x (parameters + features)
  torch::Tensor strain_;
  torch::Tensor stress_;
  torch::Tensor energy_;
  torch::Tensor tangent_;    ///< rows x 6
  torch::Tensor whitening_;  ///< rows x 6
  std::vector<std::vector<int>> usable_;
  std::vector<Eigen::Matrix3d> stress_map_of_;
  torch::Tensor strain_maps_;  ///< symmetries x 3 x 3: A
  torch::Tensor stress_maps_;  ///< symmetries x 3 x 3: A^-T
};

}  // namespace supple::training
