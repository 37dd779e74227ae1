#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "supple/base/cost_ledger.h"
#include "supple/base/execution.h"
#include "supple/numerics/hessian_entries.h"
#include "supple/numerics/state.h"

namespace supple::numerics {

/// The sum to which terms add their values and derivatives. Derivatives are with respect to all degrees of freedom,
/// including fixed ones.
struct EnergySum {
  double value = 0;
  Eigen::VectorXd gradient{};  ///< one entry for each degree of freedom; empty for order 0
  HessianEntries hessian{};    ///< unused below order 2
  /// Dense low-rank part of the Hessian: each vector a adds a a^T (order 2). It serves terms that couple all degrees of
  /// freedom.
  std::vector<Eigen::VectorXd> rank_one{};
  /// Whether terms that can do so (`has_convex_hessian`) add, for each element, a positive semidefinite matrix near its
  /// Hessian.
  bool convex = false;
  /// The token that is checked every few thousand elements; it must outlive the evaluation. Null if nobody stops it.
  const CancellationToken* cancellation = nullptr;

  /// Resets the sum to zero, for n degrees of freedom and derivatives up to `order`.
  void clear(Eigen::Index n, int order) {
    value = 0;
    if (order >= 1) gradient.setZero(n);
    if (order < 2) return;
    hessian.clear();
    rank_one.clear();
  }

  /// Adds the energy of an element with the degrees of freedom `rows`, its gradient (order 1) and the lower triangle of
  /// its Hessian, row by row (order 2; see HessianEntries::add_block).
  template <std::size_t size>
  void add_element(const std::array<std::int32_t, size>& rows, int order, double energy, const double* element_gradient,
                   const double* lower) {
    check_for_stop();
    value += energy;
    if (order < 1) return;
    for (std::size_t k = 0; k < size; ++k) gradient[rows[k]] += element_gradient[k];
    if (order >= 2) hessian.add_block(rows, lower);
  }
  /// The same for a number of rows that differs from element to element. HessianEntries::add_block says how they are
  /// ordered.
  void add_element(std::span<const std::int32_t> rows, int order, double energy, const double* element_gradient,
                   const double* lower) {
    check_for_stop();
    value += energy;
    if (order < 1) return;
    for (const std::int32_t row : rows) gradient[row] += *element_gradient++;
    if (order >= 2) hessian.add_block(rows, lower);
  }

 private:
  static constexpr std::uint32_t elements_between_checks = 4096;  // a power of two
  void check_for_stop() {
    if (++added_ % elements_between_checks == 0 && cancellation) cancellation->throw_if_requested();
  }
  std::uint32_t added_ = 0;
};

/// One term of a scene's energy, e.g. a group of elastic elements, a contact, a spring or a pressure.
///
/// A term knows which degrees of freedom are its own. It reads the state and adds its energy and derivatives to the
/// sum. Adding physics means adding one such class, and no solver changes. If a term has to compute something first, it
/// does so in `prepare` (at a state) or in `look_ahead` (before a step). Everything else is const and depends on the
/// state alone.
template <class S>
class Term {
 public:
  virtual ~Term() = default;

  /// A stable name for the bill and for error messages, e.g. "neo_hookean".
  virtual std::string_view name() const = 0;

  /// Adds the value (order 0), the gradient (1) and the Hessian (2) at the state. An infinite value marks the state as
  /// invalid.
  virtual void add(const S& state, int order, EnergySum& sum) const = 0;

  /// Whether `add` follows EnergySum::convex. Where single elements have negative curvature, as compressed and buckling
  /// ones have, steps with such matrices are far better than steps with the Hessian plus a multiple of the identity.
  virtual bool has_convex_hessian() const { return false; }

  /// Whether there is anything to add at present. A term that is not active is neither called nor billed.
  virtual bool active() const { return true; }

  /// Computes what `add` needs at this state up to this order, and stores it in the state or in the term. It is called
  /// once before `add`, at every state and whenever the order rises.
  virtual void prepare(S& /*state*/, int /*order*/, const Execution& /*execution*/) {}

  /// The largest t > 0 for which the state stays valid along t * step, or infinity if every step is valid. It is asked
  /// before a step is taken.
  virtual double largest_step(const S& /*state*/, const Eigen::VectorXd& /*step*/) const {
    return std::numeric_limits<double>::infinity();
  }

  /// Inspects the straight path between two states before the step is taken, and prepares for all states on it. Returns
  /// the fraction of the step, in [0, 1], that may be taken.
  virtual double look_ahead(const S& /*from*/, const S& /*to*/, CostLedger* /*cost*/) { return 1; }

  /// Writes one evaluation, which took `seconds`, to the ledger.
  virtual void bill(CostLedger& cost, double seconds) const {
    cost.add_effect(name(), true, "a term of the energy", 1, seconds);
  }
};

}  // namespace supple::numerics
