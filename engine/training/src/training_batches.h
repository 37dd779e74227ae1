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

/// Some rows of one design, for which its parameter branch is evaluated once.
struct Chunk {
  int design = 0;  ///< index into the samples' designs
  std::vector<std::int64_t> rows;
};

/// One chunk for each design that has any of the rows. `rows` must be sorted.
std::vector<Chunk> chunks_by_design(const Samples& samples, const std::vector<int>& rows);

/// Shuffles the rows of each design, splits them into chunks of nearly equal length of at most `chunk_rows` rows, and
/// shuffles the chunks.
std::vector<Chunk> shuffled_chunks(const std::vector<Chunk>& designs, int chunk_rows, RandomStream& stream);

/// Strains of several designs with the simulated values, in single precision.
struct LabelledBatch {
  Batch batch;
  torch::Tensor energy;   ///< rows, MPa
  torch::Tensor stress;   ///< rows x 3, MPa
  torch::Tensor tangent;  ///< rows x 3 x 3, MPa
  /// W = |C|^-1/2 with the tangent C; rows x 3 x 3, MPa^-1/2. It maps unit vectors to strains v of equal energy, v^T C
  /// v = 1. Negative eigenvalues of C are replaced by their absolute values, and small ones are bounded below.
  torch::Tensor whitening;
};

/// The inputs of a network for designs. `parameters` has a column for each design, and so has the result: parameters,
/// mapped from their bounds to [-1, 1], above the features of the geometry.
Eigen::MatrixXd design_inputs(const Samples& samples, const neural::TileGeometry& geometry,
                              const Eigen::Ref<const Eigen::MatrixXd>& parameters);
/// The parameters of the designs' images under a symmetry, a column for each.
Eigen::MatrixXd images(const Eigen::Ref<const Eigen::MatrixXd>& parameters, const EnergySymmetry& symmetry);
/// The symmetries with the identity before them.
std::vector<EnergySymmetry> with_identity(const std::vector<EnergySymmetry>& symmetries, long parameters);
/// Whether a design equals one of others but for rounding. All are given by mapped parameters, `others` by columns.
bool coincides(const Eigen::Ref<const Eigen::VectorXd>& design, const Eigen::Ref<const Eigen::MatrixXd>& others);
/// Whether the image of a design may be used for training. It must lie in the box, or not further from it than data
/// sets or the design itself do, and coincide with no held-out design. All designs are given by mapped parameters,
/// those of `held_out` by columns.
bool usable_image(const Eigen::Ref<const Eigen::VectorXd>& own, const Eigen::Ref<const Eigen::VectorXd>& image,
                  const Eigen::Ref<const Eigen::MatrixXd>& held_out);

/// A design or its image under a symmetry.
struct DesignImage {
  std::int64_t design = 0;
  std::int64_t symmetry = 0;  ///< 0 is the identity
};

/// The samples as tensors on a device, to which symmetries can be applied.
class TrainingData {
 public:
  /// Images that coincide with `held_out` designs are not used, because they have the same energies as these.
  /// `geometry` lists the features that follow the parameters; it may be empty.
  TrainingData(const Samples& samples, const std::vector<EnergySymmetry>& symmetries, const std::vector<int>& held_out,
               const neural::TileGeometry& geometry, torch::Device device);

  /// The symmetries that may be applied to a design. The first is 0, the identity.
  const std::vector<int>& symmetries_of(int design) const {
    return usable_symmetries_[static_cast<std::size_t>(design)];
  }
  /// Parameters, mapped from their bounds to [-1, 1], and features: designs x (parameters + features).
  torch::Tensor parameters(std::span<const DesignImage> designs) const;
  /// A^-T, by which a symmetry transforms stresses if it transforms strains by A.
  const Eigen::Matrix3d& stress_map(std::int64_t symmetry) const {
    return stress_map_matrices_[static_cast<std::size_t>(symmetry)];
  }
  /// Type and device of the tensors.
  torch::TensorOptions tensor_options() const { return strain_.options(); }

  /// All data as tables for another trainer, by name: "inputs" (images of all designs under the first symmetry, under
  /// the second, ...), "usable" (designs x symmetries, 1 where the symmetry may be applied to the design), "strain",
  /// "stress", "energy", "tangent" and "whitening" of each row, and "strain_maps" (A of each symmetry, a row of 9).
  std::vector<std::pair<std::string, torch::Tensor>> tables() const;

  /// The rows of the chunks. To chunk i the symmetry number symmetry[i] is applied: e -> A e, S -> A^-T S, C -> A^-T C
  /// A^-1, W -> A W. About 150 flops for each row.
  LabelledBatch labelled(std::span<const Chunk> chunks, std::span<const int> symmetry) const;

 private:
  std::int64_t designs_ = 0;
  torch::Tensor inputs_;  ///< images under the first symmetry, under the second, ...; x (parameters + features)
  torch::Tensor strain_;
  torch::Tensor stress_;
  torch::Tensor energy_;
  torch::Tensor tangent_;    ///< rows x 6
  torch::Tensor whitening_;  ///< rows x 6
  std::vector<std::vector<int>> usable_symmetries_;
  std::vector<Eigen::Matrix3d> stress_map_matrices_;
  torch::Tensor strain_maps_;  ///< symmetries x 3 x 3: A
  torch::Tensor stress_maps_;  ///< symmetries x 3 x 3: A^-T
};

}  // namespace supple::training
