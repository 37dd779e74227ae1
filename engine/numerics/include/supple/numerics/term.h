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

/// The running sum to which terms add their shares. Derivatives are with respect to all degrees of freedom, including
/// those that are held.
struct EnergySum {
  double value = 0;
  Eigen::VectorXd gradient{};  ///< one entry for each degree of freedom; empty for order 0
  HessianEntries hessian{};    ///< unused below order 2
  /// Couplings of all degrees of freedom with each other: each column a adds a a^T to the Hessian (order 2).
  std::vector<Eigen::VectorXd> rank_one{};
  /// Whether each element gets a positive semidefinite matrix near its Hessian, from terms that have one
  /// (`has_convex_hessian`).
  bool convex = false;
  /// It is checked every few thousand elements. Null if nobody stops the evaluation, which it must outlive otherwise.
  const CancellationToken* cancellation = nullptr;

  /// Resets the sum to zero, for n degrees of freedom and derivatives up to `order`.
  void clear(Eigen::Index n, int order) {
    value = 0;
    if (order >= 1) gradient.setZero(n);
    if (order < 2) return;
    hessian.clear();
    rank_one.clear();
  }

  /// Adds the share of an element with the degrees of freedom `rows`: its gradient (order 1) and the lower triangle of
  /// its Hessian, row by row (order 2; see HessianEntries::add_block).
  template <std::size_t size>
  void add_element(const std::array<std::int32_t, size>& rows, int order, double share, const double* slope,
                   const double* lower) {
    look_for_stop();
    value += share;
    if (order < 1) return;
    for (std::size_t k = 0; k < size; ++k) gradient[rows[k]] += slope[k];
    if (order >= 2) hessian.add_block(rows, lower);
  }
  /// The same for a number of rows that differs from element to element; see HessianEntries::add_block for their order.
  void add_element(std::span<const std::int32_t> rows, int order, double share, const double* slope,
                   const double* lower) {
    look_for_stop();
    value += share;
    if (order < 1) return;
    for (const std::int32_t row : rows) gradient[row] += *slope++;
    if (order >= 2) hessian.add_block(rows, lower);
  }

 private:
  static constexpr std::uint32_t elements_between_looks = 4096;  // a power of two
  void look_for_stop() {
    if (++added_ % elements_between_looks == 0 && cancellation) cancellation->throw_if_requested();
  }
  std::uint32_t added_ = 0;
};

/// One term of a scene's energy: an elastic element group, a contact, a spring, a pressure.
///
/// A term reads the state (it knows which degrees of freedom are its own) and adds its share to the sum. Adding physics
/// means adding one class like this, and no solver changes. If a term has to compute something first, it does so in
/// `prepare` (at a state) or in `look_ahead` (before a step). Everything else is const and depends on the state alone.
template <class S>
class Term {
 public:
  virtual ~Term() = default;

  /// A stable name for the bill and for error messages, e.g. "neo_hookean".
  virtual std::string_view name() const = 0;

  /// Adds the value (order 0), the gradient (1) and the Hessian (2) at the state. An infinite value marks the state as
  /// invalid.
  virtual void add(const S& state, int order, EnergySum& sum) const = 0;

  /// Whether `add` follows EnergySum::convex. If the energy of single elements has negative curvature, as in compressed
  /// and buckling elements, steps with such matrices are far better than steps with the Hessian plus a multiple of the
  /// identity.
  virtual bool has_convex_hessian() const { return false; }

  /// Whether there is anything to add at present. A term that is not active is neither called nor billed.
  virtual bool active() const { return true; }

  /// Computes what `add` needs at this state up to this order, and keeps it in the state or in the term. It is called
  /// once before `add`, at every state and whenever the order rises.
  virtual void prepare(S& /*state*/, int /*order*/, const Execution& /*execution*/) {}

  /// The largest t > 0 for which the state stays valid along t * step, or infinity if every step is valid. It is asked
  /// before a step is taken.
  virtual double largest_step(const S& /*state*/, const Eigen::VectorXd& /*step*/) const {
    return std::numeric_limits<double>::infinity();
  }

  /// Inspects the way from one state to another before it is taken, and prepares for all states on it. Returns the
  /// share of the way, in [0, 1], that may be taken.
  virtual double look_ahead(const S& /*from*/, const S& /*to*/, CostLedger* /*cost*/) { return 1; }

  /// A state that a line search cannot find: a state at which the term has a kink that may hold a minimum, or a state
  /// in which only the parts that are close to a kink have moved less than the others.
  struct Kink {
    S state;
    std::int64_t id = 0;      ///< the same for the same kink
    double distance = 0;      ///< its distance from the current state
    bool same_place = false;  ///< whether only rounding separates the current state from it
  };
  /// The kinks near the current state and near the trial states since it became the current one, in the order of the
  /// trials. They are no farther than `reach` from the current state.
  virtual std::vector<Kink> kinks(const S& /*current*/, const std::vector<S>& /*tried*/, double /*reach*/) const {
    return {};
  }
  virtual bool has_kinks() const { return false; }

  /// Writes one evaluation to the bill.
  virtual void bill(CostLedger& cost, double seconds) const {
    cost.add_effect(name(), true, "a term of the energy", 1, seconds);
  }
};

}  // namespace supple::numerics
