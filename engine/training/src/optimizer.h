#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "supple/training/trainer.h"
#include "torch_network.h"

namespace supple::training {

/// Adam, and Adam in the eigenbases of each weight matrix's gradient statistics (SOAP; Vyas et al. 2024).
///
/// For a matrix W with gradients G, L and R are running means of G G^T and G^T G with eigenvectors Q_L and Q_R; Adam's
/// moments are those of Q_L^T G Q_R. The bases are renewed every `basis_interval` steps, and both moments go along:
/// the first as a matrix, the second as the variances of what it was (T o T v for the change of basis T), so that no
/// direction meets moments of another. Matrices with many columns are split in parts of their own.
class Optimizer {
 public:
  /// Steps change `parameters` in place. Matrices among the first `preconditioned` of them have bases, if the kind has
  /// any, and shrink by learning rate * `weight_decay` in each step (decoupled; Loshchilov and Hutter 2019).
  Optimizer(OptimizerKind kind, Parameters& parameters, std::size_t preconditioned, double weight_decay = 0);

  void step(const std::vector<torch::Tensor>& gradients, double learning_rate);

  /// All that the next step depends on, with names.
  std::vector<std::pair<std::string, torch::Tensor>> state() const;
  /// Takes over what `state` gave. Throws "file.unreadable" if a part is missing or has another shape.
  void restore(const std::vector<std::pair<std::string, torch::Tensor>>& state, std::int64_t steps);
  std::int64_t steps() const { return steps_; }

 private:
  /// A matrix, a part of one's columns, or a vector.
  struct Block {
    std::size_t parameter = 0;
    std::int64_t column = 0;
    std::int64_t columns = 0;
    bool has_bases = false;
    bool decays = false;
    torch::Tensor first;   ///< moment, in the bases
    torch::Tensor second;  ///< moment
    torch::Tensor left_statistics;
    torch::Tensor right_statistics;
    torch::Tensor left_basis;
    torch::Tensor right_basis;
  };
  static torch::Tensor part(const Block& block, const torch::Tensor& whole);
  void step(Block& block, const torch::Tensor& gradient, double learning_rate) const;
  void renew_bases(Block& block) const;

  OptimizerKind kind_;
  Parameters& parameters_;
  double weight_decay_;
  std::vector<Block> blocks_;
  std::int64_t steps_ = 0;
};

}  // namespace supple::training
