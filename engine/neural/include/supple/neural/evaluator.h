#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>

#include "supple/neural/network.h"

namespace supple::neural {

/// The highest derivatives with respect to strain that an evaluation returns. Lower derivatives are returned too.
enum class Order {
  energy = 0,
  stress = 1,   ///< first derivatives
  tangent = 2,  ///< second derivatives
  third = 3,    ///< third derivatives
};

/// The results for n strains of one design, with one column for each strain. Results that were not requested are empty.
/// Derivatives are with respect to e = (E_xx, E_yy, 2 E_xy), so that the first derivatives are the second
/// Piola-Kirchhoff stress S_xx, S_yy, S_xy. In derivatives with respect to the tiling parameters p, row
/// q * parameters + k is the derivative of row q with respect to p_k.
struct Evaluation {
  Eigen::RowVectorXd energy_density;     ///< 1 x n, MPa
  Eigen::Matrix3Xd stress;               ///< 3 x n, MPa
  Eigen::Matrix<double, 6, -1> tangent;  ///< 6 x n, MPa: 11, 12, 13, 22, 23, 33
  /// 10 x n, MPa: 111, 112, 113, 122, 123, 133, 222, 223, 233, 333
  Eigen::Matrix<double, 10, -1> third;
  Eigen::MatrixXd energy_by_parameters;   ///< parameters x n; present from Order::stress on
  Eigen::MatrixXd stress_by_parameters;   ///< 3 parameters x n; present from Order::tangent on
  Eigen::MatrixXd tangent_by_parameters;  ///< 6 parameters x n; present from Order::third on
};

/// Evaluates one network. It has the network's weights in an order that suits the processor. Nothing in it changes
/// after construction, so that several threads may evaluate at once, each with its own Workspace.
///
/// A forward pass through the layers propagates derivatives with respect to strain of one order less than requested. A
/// backward pass adds one order. It also gives the derivatives with respect to all parameters. For each strain, each of
/// the strain_layers + trunk_layers - 1 square matrices is multiplied with 1 vector for the energy, with 2 for the
/// stress too, with 8 for the tangent too, and with 20 for third derivatives too. One such product takes width^2
/// multiply-adds. A network with symmetries evaluates several images of each strain. The parameter branch, the rest
/// state and the first layer are computed once for each design.
template <class Real>
class BasicEvaluator {
 public:
  /// Throws what `validate` throws.
  explicit BasicEvaluator(const Network& network);
  ~BasicEvaluator();
  BasicEvaluator(BasicEvaluator&&) noexcept;
  BasicEvaluator& operator=(BasicEvaluator&&) noexcept;

  /// The part of an evaluation that depends on the tiling parameters alone.
  class Design {
   public:
    ~Design();
    Design(Design&&) noexcept;
    Design& operator=(Design&&) noexcept;

    /// A third of the trace of the rest stiffness that the stiffness branch predicts, s in EnergyForm, in MPa; 1 for
    /// softplus.
    double rest_stiffness() const;

   private:
    friend class BasicEvaluator;
    Design();
    struct Content;
    std::unique_ptr<Content> content_;
  };

  /// Scratch memory, which calls reuse so that they need not allocate any.
  class Workspace {
   public:
    Workspace();
    ~Workspace();
    Workspace(Workspace&&) noexcept;
    Workspace& operator=(Workspace&&) noexcept;

   private:
    friend class BasicEvaluator;
    struct Content;
    std::unique_ptr<Content> content_;
  };

  /// Prepares a design. Parameters may lie outside their bounds. They must be finite, and as many as the network has;
  /// otherwise "model.parameter_count" is thrown. `with_parameter_derivatives` prepares derivatives with respect to the
  /// parameters, which costs about one more evaluation of the rest state for each parameter.
  Design design(std::span<const double> parameters, bool with_parameter_derivatives = false) const;

  /// Evaluates strains, which are finite columns (E_xx, E_yy, 2 E_xy). Derivatives with respect to parameters are
  /// computed if the design was prepared for them. Throws nothing. Far outside the training range the numbers are
  /// finite and meaningless.
  void evaluate(const Design& design, const Eigen::Ref<const Eigen::Matrix3Xd>& strains, Order order,
                Workspace& workspace, Evaluation& evaluation) const;
  Evaluation evaluate(const Design& design, const Eigen::Ref<const Eigen::Matrix3Xd>& strains, Order order) const;

  const NetworkShape& shape() const;

 private:
  struct Content;
  std::unique_ptr<const Content> content_;
};

extern template class BasicEvaluator<double>;
extern template class BasicEvaluator<float>;

/// The evaluator that the service uses, in double precision throughout.
using Evaluator = BasicEvaluator<double>;
/// An evaluator that takes half the time and memory, with the rounding of single precision.
using SingleEvaluator = BasicEvaluator<float>;

}  // namespace supple::neural
