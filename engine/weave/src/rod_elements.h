#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "rod_model.h"
#include "rod_state.h"
#include "supple/numerics/element_loop.h"
#include "supple/numerics/term.h"

namespace supple::weave {

/// A term of a weave's energy.
using Energy = numerics::Term<RodState>;

/// A local variable ("slot") of an element is a sum of coefficients times degrees of freedom.
struct Link {
  int dof = 0;
  int slot = 0;
  double coefficient = 0;
};
using Links = std::vector<Link>;

/// Slots first, first + 1, ... are the components of an edge's vector.
void link_edge(const RodModel& model, const Edge& edge, int first, Links& links);
/// Slots first, ... are the joint's unknowns.
void link_joint(const RodModel& model, int joint, int first, Links& links);

/// The sliders that a few material coordinates depend on; slot first + i is the i-th of them.
class SliderSlots {
 public:
  static constexpr int most = 3;
  void add(const MaterialCoordinate& c);
  bool empty() const { return count_ == 0; }
  /// Of the i-th slider in c.
  double share(const MaterialCoordinate& c, int i) const;
  int count() const { return count_; }
  void link(const RodModel& model, int first, Links& links) const;

 private:
  std::array<int, most> slider_{-1, -1, -1};
  int count_ = 0;
};

/// What an element gives by the degrees of freedom that it depends on.
struct ElementShare {
  static constexpr std::size_t most_rows = 24;
  double value;
  std::array<double, most_rows> slope;                                        ///< order 1
  std::array<double, numerics::HessianEntries::entries_of(most_rows)> lower;  ///< order 2, row by row
};

/// The degrees of freedom that an element's slots depend on, each once, in ascending order.
class ElementRows {
 public:
  explicit ElementRows(const Links& links);
  std::span<const std::int32_t> rows() const { return {rows_.data(), count_}; }

  /// The derivatives by the degrees of freedom from those by the slots: gradient[slot], and hessian(i, j) for slots
  /// i >= j.
  template <typename Gradient, typename HessianOf>
  void contract(int order, const Gradient& gradient, const HessianOf& hessian, ElementShare& share) const {
    if (order < 1) return;
    std::fill_n(share.slope.begin(), count_, 0.0);
    for (const RowLink& a : links_) share.slope[a.row] += a.coefficient * gradient[a.slot];
    if (order < 2) return;
    std::fill_n(share.lower.begin(), numerics::HessianEntries::entries_of(count_), 0.0);
    for (std::size_t i = 0; i < links_.size(); ++i) {
      const RowLink& a = links_[i];
      for (std::size_t j = 0; j <= i; ++j) {
        const RowLink& b = links_[j];
        const double entry =
            a.coefficient * b.coefficient * hessian(std::max(a.slot, b.slot), std::min(a.slot, b.slot));
        const auto [low, high] = std::minmax(a.row, b.row);
        // Of two links to one degree of freedom both orders count.
        share.lower[high * (high + 1) / 2 + low] += a.row == b.row && i != j ? 2 * entry : entry;
      }
    }
  }

 private:
  struct RowLink {
    std::size_t row;  ///< index into rows_
    std::size_t slot;
    double coefficient;
  };
  std::array<std::int32_t, ElementShare::most_rows> rows_{};
  std::size_t count_ = 0;
  std::vector<RowLink> links_;
};

/// Adds the elements of a term to the sum, worked out in parallel. evaluate(element, share) gives the value and the
/// derivatives up to the order, by element.rows.contract.
template <class Element, class Evaluate>
void add_rod_elements(const std::vector<Element>& elements, int order, const Evaluate& evaluate,
                      numerics::EnergySum& sum) {
  constexpr std::size_t elements_per_task = 32;
  numerics::add_elements<ElementShare>(
      elements.size(), elements_per_task, [&](std::size_t i, ElementShare& share) { evaluate(elements[i], share); },
      [&](std::size_t i, const ElementShare& share) {
        sum.add_element(elements[i].rows.rows(), order, share.value, share.slope.data(), share.lower.data());
        return true;
      });
}

}  // namespace supple::weave
