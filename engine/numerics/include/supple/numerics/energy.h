#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <limits>
#include <string_view>
#include <vector>

namespace supple::numerics {

/// The running sum that energies add themselves to.
struct EnergySum {
  double value = 0;
  Eigen::VectorXd gradient;  ///< one entry per degree of freedom; empty for order 0
  /// Entries (row, column, second derivative) of both triangles; entries of the same place add up. Unused below
  /// order 2.
  std::vector<Eigen::Triplet<double>> hessian;
};

/// One term of a scene's energy: an elastic element group, a contact, a spring, a pressure.
///
/// A term reads the scene's degrees of freedom x (it knows which are its own) and adds its share to the sum. It holds
/// no state that depends on x, so a scene may evaluate it from several threads. Adding physics means adding one class
/// like this; no solver changes.
class Energy {
 public:
  virtual ~Energy() = default;

  /// A stable name for the bill and for error messages, e.g. "neo_hookean".
  virtual std::string_view name() const = 0;

  /// Adds the value (order 0), the gradient (1) and the Hessian (2) at x. An infinite value marks x as invalid.
  virtual void add(const Eigen::VectorXd& x, int order, EnergySum& sum) const = 0;

  /// The largest t > 0 for which x + t * step is valid for this term; infinity where every step is.
  virtual double largest_step(const Eigen::VectorXd& /*x*/, const Eigen::VectorXd& /*step*/) const {
    return std::numeric_limits<double>::infinity();
  }
};

}  // namespace supple::numerics
