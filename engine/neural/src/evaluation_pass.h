#pragma once

#include <Eigen/Core>

#include "activation_kernel.h"
#include "evaluator_content.h"
#include "supple/neural/evaluator.h"

namespace supple::neural {

/// Strains of one design on their way forward through the layers, with derivatives of one order less than asked for,
/// and back, which adds the last order and the derivatives by all parameters.
template <class Real>
class EvaluationPass {
 public:
  /// Of n strains in all. Keeps references; sizes the answer's arrays.
  EvaluationPass(const PackedNetwork<Real>& network, const PackedDesign<Real>& design, Order asked, long n,
                 PassSpace<Real>& space, Evaluation& answer);

  /// Strains that go through the layers together: enough to use what is loaded of the weights, few enough that the jets
  /// of all layers stay near.
  int strains_at_once() const;

  /// Answers these strains as columns begin, begin + 1, ...
  void run(const Eigen::Ref<const Eigen::Matrix3Xd>& strains, long begin);

 private:
  int channels() const { return channels_of_order[order_]; }
  int columns() const { return channels() * jets_; }
  /// A block of this pass's jets on top of `numbers`.
  JetBlock<Real> block(std::vector<Real>& numbers, int rows) const;

  void forward();
  /// From the outputs' jets N: the energy's jets, and in place of N those of its derivatives by N.
  void close_sum_of_squares();
  void close_softplus();
  void backward();
  /// The addends of the parameters' derivatives that come from the stiffness and the rest state.
  void begin_parameters();
  /// From the derivatives by the first layer's three columns of each map, `maps_back`.
  void finish_strains(const JetBlock<Real>& maps_back);
  void finish_parameters(const JetBlock<Real>& maps_back);
  /// Adds add(jet, parameter, channel) to the derivatives by parameters.
  template <class Add>
  void by_parameters(Add&& add);
  /// Channel c of sum_k dPhi / d(map's column i), of the first layer and the linear part; map 0 is the design's, map 1
  /// + k its derivative by parameter k.
  double mapped(const JetBlock<Real>& maps_back, int map, int i, int c, int j) const;

  const PackedNetwork<Real>& network_;
  const PackedDesign<Real>& design_;
  const NetworkShape& shape_;
  PassSpace<Real>& space_;
  Evaluation& answer_;
  Order asked_;
  int order_;       ///< of the jets
  int width_;       ///< with padding
  int parameters_;  ///< by which the design has derivatives

  // Of the strains at work.
  long begin_ = 0;
  int jets_ = 0;
  JetBlock<Real> e_;     ///< strains
  JetBlock<Real> a_;     ///< activations, then derivatives by them
  JetBlock<Real> last_;  ///< outputs, then derivatives by them
};

extern template class EvaluationPass<double>;
extern template class EvaluationPass<float>;

}  // namespace supple::neural
