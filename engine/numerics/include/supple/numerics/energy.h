#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <limits>
#include <string_view>
#include <vector>

namespace supple::numerics {

/// Second derivatives as they are added. The matrix is symmetric: an unordered pair of degrees of freedom is one place,
/// each entry is given once, and entries of the same place add up.
class HessianEntries {
 public:
  void add(Eigen::Index i, Eigen::Index j, double value) {
    entries_.emplace_back(static_cast<int>(i > j ? i : j), static_cast<int>(i > j ? j : i), value);
  }
  /// The n x n matrix, both triangles filled.
  Eigen::SparseMatrix<double> matrix(Eigen::Index n) const;

 private:
  std::vector<Eigen::Triplet<double>> entries_;  ///< of the lower triangle
};

/// The running sum that energies add themselves to.
struct EnergySum {
  double value = 0;
  Eigen::VectorXd gradient;  ///< one entry per degree of freedom; empty for order 0
  HessianEntries hessian;    ///< unused below order 2
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
