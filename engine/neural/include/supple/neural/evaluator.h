#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>

#include "supple/neural/network.h"

namespace supple::neural {

/// Which derivatives an evaluation returns; each includes those before it.
enum class Order {
  energy = 0,
  stress = 1,   ///< first derivatives
  tangent = 2,  ///< second derivatives
  third = 3,    ///< third derivatives
};

/// Answers for n strains of one design, a column each; what was not asked for is empty. Derivatives are with respect to
/// e = (E_xx, E_yy, 2 E_xy), so that the first are the second Piola-Kirchhoff stress S_xx, S_yy, S_xy. Derivatives with
/// respect to the tiling parameters p are per unit of p and run through p first: row q * parameters + k is the
/// derivative of row q with respect to p_k.
struct Evaluation {
  Eigen::RowVectorXd energy_density;     ///< 1 x n, MPa
  Eigen::Matrix3Xd stress;               ///< 3 x n, MPa
  Eigen::Matrix<double, 6, -1> tangent;  ///< 6 x n, MPa: 11, 12, 13, 22, 23, 33
  /// 10 x n, MPa: 111, 112, 113, 122, 123, 133, 222, 223, 233, 333
  Eigen::Matrix<double, 10, -1> third;
  Eigen::MatrixXd energy_by_parameters;   ///< parameters x n; from Order::stress on
  Eigen::MatrixXd stress_by_parameters;   ///< 3 parameters x n; from Order::tangent on
  Eigen::MatrixXd tangent_by_parameters;  ///< 6 parameters x n; from Order::third on
};

/// Evaluates one network. Holds its weights packed for the processor; nothing in it changes after construction, so that
/// any number of threads may evaluate at once, each with its own Workspace.
///
/// A strain goes forward through the layers with its derivatives of one order less than asked for, and backward with as
/// many: the backward pass adds an order and gives the derivatives by all parameters beside those by strain. Cost per
/// strain, in products with one of the strain_layers + trunk_layers - 1 square matrices: 1 for the energy, 2 with
/// stress, 8 with the tangent, 20 with third derivatives; width^2 multiply-adds each. A network with symmetries takes
/// one strain as several. The parameter branch, the rest state and the first layer are worked out once for each design.
template <class Real>
class BasicEvaluator {
 public:
  /// Throws as `validate`.
  explicit BasicEvaluator(const Network& network);
  ~BasicEvaluator();
  BasicEvaluator(BasicEvaluator&&) noexcept;
  BasicEvaluator& operator=(BasicEvaluator&&) noexcept;

  /// What depends on the tiling parameters alone.
  class Design {
   public:
    ~Design();
    Design(Design&&) noexcept;
    Design& operator=(Design&&) noexcept;

    /// s, a third of the trace of the rest stiffness as far as the stiffness branch knows it, in MPa; 1 for softplus.
    double rest_stiffness() const;

   private:
    friend class BasicEvaluator;
    Design();
    struct Content;
    std::unique_ptr<Content> content_;
  };

  /// Scratch space, kept between calls so that they allocate nothing.
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

  /// Parameters may lie outside their bounds; they must be finite and as many as the network's. Throws
  /// "model.parameter_count". `with_parameter_derivatives` prepares those, at the cost of about as many more
  /// evaluations of the rest state as there are parameters.
  Design design(std::span<const double> parameters, bool with_parameter_derivatives = false) const;

  /// Strains are columns (E_xx, E_yy, 2 E_xy), finite. Derivatives by parameters where the design has them. Throws
  /// nothing; far outside the training range the numbers are finite and meaningless.
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

/// The evaluator of the service: double precision throughout.
using Evaluator = BasicEvaluator<double>;
/// Half the time and memory, at single precision's rounding.
using SingleEvaluator = BasicEvaluator<float>;

}  // namespace supple::neural
