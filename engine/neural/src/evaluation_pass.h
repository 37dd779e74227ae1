#pragma once

#include <Eigen/Core>

#include "activation_kernel.h"
#include "evaluator_content.h"
#include "supple/neural/evaluator.h"

namespace supple::neural {

/// Evaluates strains of one design. The forward pass through the layers propagates derivatives with respect to strain
/// of one order less than requested. The backward pass adds the last order and the derivatives with respect to
/// parameters.
template <class Real>
class EvaluationPass {
 public:
  /// Resizes the arrays of `answer` for n strains. The references must outlive the pass.
  EvaluationPass(const PackedNetwork<Real>& network, const PackedDesign<Real>& design, Order requested, long n,
                 PassSpace<Real>& space, Evaluation& answer);

  /// Number of strains that go through the layers together. It is so large that weights are used several times once
  /// they are loaded, and so small that the jets of all layers remain in the cache.
  int strains_at_once() const;

  /// Evaluates at most strains_at_once() strains, and writes the columns begin, begin + 1, ... of the answer.
  void run(const Eigen::Ref<const Eigen::Matrix3Xd>& strains, long begin);

 private:
  int channels() const { return channels_of_order[order_]; }
  int columns() const { return channels() * jets_; }
  /// A block of jets that uses the memory of `numbers`, which is enlarged if necessary.
  JetBlock<Real> block(std::vector<Real>& numbers, int rows) const;

  void forward();
  /// Computes the energy's jets from those of the outputs N, which are replaced by the jets of its derivatives with
  /// respect to N.
  void apply_sum_of_squares();
  void apply_softplus();
  void backward();
  /// Sets the derivatives with respect to parameters to their contributions from the stiffness s and the rest state.
  void init_parameter_derivatives();
  /// Writes the derivatives with respect to strain. `input_products` are the products with PackedDesign::input_back.
  void write_strain_derivatives(const JetBlock<Real>& input_products);
  /// Adds the contributions of the maps `input` and `linear` to the derivatives with respect to parameters.
  void add_input_derivatives(const JetBlock<Real>& input_products);
  /// Adds add(jet, parameter, channel) to the derivatives with respect to parameters.
  template <class Add>
  void add_parameter_derivatives(Add&& add);
  /// Channel c, for strain j, of component i of a product: the transposed maps `input` and `linear` of the design times
  /// the derivatives of Phi with respect to their results. Map 0 gives dPhi / de_i. Map 1 + k has the derivatives of
  /// the two maps with respect to parameter k instead.
  double map_derivative(const JetBlock<Real>& input_products, int map, int i, int c, int j) const;

  const PackedNetwork<Real>& network_;
  const PackedDesign<Real>& design_;
  const NetworkShape& shape_;
  PassSpace<Real>& space_;
  Evaluation& answer_;
  Order requested_;
  int order_;       ///< order of the jets
  int width_;       ///< width of the layers with padding
  int parameters_;  ///< number of parameters with respect to which derivatives are computed

  // The strains that are evaluated together:
  long begin_ = 0;
  int jets_ = 0;  ///< number of strains
  JetBlock<Real> strains_;
  JetBlock<Real> activations_;  ///< activations; in the backward pass, derivatives with respect to them
  JetBlock<Real> outputs_;      ///< outputs N, then derivatives with respect to them
};

extern template class EvaluationPass<double>;
extern template class EvaluationPass<float>;

}  // namespace supple::neural
