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

/// The running sum that terms add themselves to: derivatives by all degrees of freedom, also held ones.
struct EnergySum {
  double value = 0;
  Eigen::VectorXd gradient{};  ///< one entry per degree of freedom; empty for order 0
  HessianEntries hessian{};    ///< unused below order 2
  /// What couples all degrees of freedom with each other: each column a adds a a^T to the Hessian (order 2).
  std::vector<Eigen::VectorXd> rank_one{};
  /// Whether terms that can (`has_convex_hessian`) give each element a positive semidefinite matrix near its Hessian.
  bool convex = false;
  /// Looked at every few thousand elements; null where nobody stops the evaluation. Outlives it.
  const CancellationToken* cancellation = nullptr;

  /// Makes the sum zero, for n degrees of freedom and derivatives up to `order`.
  void clear(Eigen::Index n, int order) {
    value = 0;
    if (order >= 1) gradient.setZero(n);
    if (order < 2) return;
    hessian.clear();
    rank_one.clear();
  }

  /// Adds the share of an element of the degrees of freedom `rows`: its gradient (order 1) and the lower triangle of
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
/// means adding one class like this; no solver changes. What a term has to work out before is asked for by name:
/// `prepare` at a state, `look_ahead` before a step. All else is const and depends on the state alone.
template <class S>
class Term {
 public:
  virtual ~Term() = default;

  /// A stable name for the bill and for error messages, e.g. "neo_hookean".
  virtual std::string_view name() const = 0;

  /// Adds the value (order 0), the gradient (1) and the Hessian (2) at the state. An infinite value marks the state as
  /// invalid.
  virtual void add(const S& state, int order, EnergySum& sum) const = 0;

  /// Whether `add` follows EnergySum::convex. Where an energy bends the wrong way in single elements, as compressed and
  /// buckling ones do, steps by such matrices are far better than by the Hessian with a multiple of the identity.
  virtual bool has_convex_hessian() const { return false; }

  /// Whether there is anything to add at present: a term that is not active is neither called nor billed.
  virtual bool active() const { return true; }

  /// Works out what `add` needs at this state up to this order and keeps it, in the state or in the term. Called once
  /// before `add` is, at every state and where the order rises.
  virtual void prepare(S& /*state*/, int /*order*/, const Execution& /*execution*/) {}

  /// The largest t > 0 for which the state stays valid along t * step; infinity where every step is. What can be said
  /// of a step before it is taken.
  virtual double largest_step(const S& /*state*/, const Eigen::VectorXd& /*step*/) const {
    return std::numeric_limits<double>::infinity();
  }

  /// Looks at the way from one state to another before it is taken and gets ready for all states on it. Returns the
  /// share of it, in [0, 1], that may be taken.
  virtual double look_ahead(const S& /*from*/, const S& /*to*/, CostLedger* /*cost*/) { return 1; }

  /// A state that a line search cannot find: where the term has a kink that may hold a minimum, or where only the parts
  /// of the state that stand before a kink have moved less than the others.
  struct Kink {
    S state;
    std::int64_t id = 0;      ///< the same for the same kink
    double distance = 0;      ///< from the current state
    bool same_place = false;  ///< rounding alone keeps the current state from it
  };
  /// Kinks near the current state and the trial states since it became that, in the order of the trials, no farther
  /// than `reach` from it.
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
