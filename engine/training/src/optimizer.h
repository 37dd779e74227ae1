#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "supple/training/trainer.h"
#include "torch_network.h"

namespace supple::training {

/// Adam, or Adam in the eigenbases of each weight matrix's gradient statistics (SOAP) [Vyas2024].
///
/// For a matrix W with gradients G, L and R are running means of G G^T and G^T G with the eigenvectors Q_L and Q_R.
/// Adam's moments are those of Q_L^T G Q_R. The bases are updated every 50 steps, and both moments are transformed to
/// the new bases. With T the change of a basis, the first moment transforms as a matrix. The second moment, which holds
/// variances, is multiplied by the squared entries of T. Matrices with many columns are split into blocks of columns,
/// each with its own bases.
class Optimizer {
 public:
  /// Steps change `parameters` in place. The matrices among the first `preconditioned` parameters have bases if the
  /// kind is SOAP. With either kind they have decoupled weight decay: they shrink in each step by the fraction learning
  /// rate
  /// * `weight_decay` [Loshchilov2019].
  Optimizer(OptimizerKind kind, Parameters& parameters, std::size_t preconditioned, double weight_decay = 0);

  void step(const std::vector<torch::Tensor>& gradients, double learning_rate);

  /// All tensors on which the next step depends, with names.
  std::vector<std::pair<std::string, torch::Tensor>> state() const;
  /// Restores the tensors that `state` returned. Throws "file.unreadable" if one is missing or has another shape.
  void restore(const std::vector<std::pair<std::string, torch::Tensor>>& state, std::int64_t steps);
  std::int64_t steps() const { return steps_; }

 private:
  /// A vector, or some columns of a matrix.
  struct Block {
    std::size_t parameter = 0;  ///< index of the vector or matrix in `parameters`
    std::int64_t column = 0;    ///< first column
    std::int64_t columns = 0;
    bool has_bases = false;
    bool has_weight_decay = false;
    torch::Tensor first_moment;  ///< both moments are in the bases
    torch::Tensor second_moment;
    torch::Tensor left_statistics;   ///< L
    torch::Tensor right_statistics;  ///< R
    torch::Tensor left_basis;
    torch::Tensor right_basis;
  };
  static torch::Tensor block_view(const Block& block, const torch::Tensor& tensor);
  void step(Block& block, const torch::Tensor& gradient, double learning_rate) const;
  void update_bases(Block& block) const;

  OptimizerKind kind_;
  Parameters& parameters_;
  double weight_decay_;
  std::vector<Block> blocks_;
  std::int64_t steps_ = 0;
};

}  // namespace supple::training
