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

/// One summand of a local variable ("slot") of an element. The variable is a sum of coefficients times degrees of
/// freedom.
struct Link {
  int dof = 0;
  int slot = 0;
  double coefficient = 0;
};
using Links = std::vector<Link>;

/// Links the slots `first`, `first` + 1, ... to the components of an edge's vector.
void link_edge(const RodModel& model, const Edge& edge, int first, Links& links);
/// Links the slots from `first` on to the joint's unknowns.
void link_joint(const RodModel& model, int joint, int first, Links& links);

/// The sliders on which the material coordinates of an element depend. Slot `first` + i is the i-th of them.
class SliderSlots {
 public:
  static constexpr int max_sliders = 3;
  void add(const MaterialCoordinate& c);
  bool empty() const { return count_ == 0; }
  /// Weight of the i-th slider in c.
  double weight(const MaterialCoordinate& c, int i) const;
  int count() const { return count_; }
  void link(const RodModel& model, int first, Links& links) const;

 private:
  std::array<int, max_sliders> slider_{-1, -1, -1};
  int count_ = 0;
};

/// Energy of an element and its derivatives by the degrees of freedom on which it depends.
struct ElementContribution {
  static constexpr std::size_t max_rows = 24;
  double value;
  std::array<double, max_rows> slope;  ///< gradient, for orders 1 and 2
  std::array<double, numerics::HessianEntries::entries_of(max_rows)>
      lower;  ///< lower triangle of the Hessian, row by row, for order 2
};

/// The degrees of freedom on which an element's slots depend, each once, in ascending order.
class ElementRows {
 public:
  explicit ElementRows(const Links& links);
  std::span<const std::int32_t> rows() const { return {rows_.data(), count_}; }

  /// Computes the derivatives by the degrees of freedom from those by the slots: gradient[slot], and hessian(i, j) for
  /// slots i >= j.
  template <typename Gradient, typename HessianOf>
  void contract(int order, const Gradient& gradient, const HessianOf& hessian,
                ElementContribution& contribution) const {
    if (order < 1) return;
    std::fill_n(contribution.slope.begin(), count_, 0.0);
    for (const RowLink& a : links_) contribution.slope[a.row] += a.coefficient * gradient[a.slot];
    if (order < 2) return;
    std::fill_n(contribution.lower.begin(), numerics::HessianEntries::entries_of(count_), 0.0);
    for (std::size_t i = 0; i < links_.size(); ++i) {
      const RowLink& a = links_[i];
      for (std::size_t j = 0; j <= i; ++j) {
        const RowLink& b = links_[j];
        const double entry =
            a.coefficient * b.coefficient * hessian(std::max(a.slot, b.slot), std::min(a.slot, b.slot));
        const auto [low, high] = std::minmax(a.row, b.row);
        // If two links have the same degree of freedom, the entry counts for both orders of the links.
        contribution.lower[high * (high + 1) / 2 + low] += a.row == b.row && i != j ? 2 * entry : entry;
      }
    }
  }

 private:
  struct RowLink {
    std::size_t row;  ///< index into rows_
    std::size_t slot;
    double coefficient;
  };
  std::array<std::int32_t, ElementContribution::max_rows> rows_{};
  std::size_t count_ = 0;
  std::vector<RowLink> links_;
};

/// Evaluates the elements of a term in parallel and adds them to the sum. evaluate(element, contribution) computes the
/// value, and the derivatives up to the order by element.rows.contract.
template <class Element, class Evaluate>
void add_rod_elements(const std::vector<Element>& elements, int order, const Evaluate& evaluate,
                      numerics::EnergySum& sum) {
  constexpr std::size_t elements_per_task = 32;
  numerics::add_elements<ElementContribution>(
      elements.size(), elements_per_task,
      [&](std::size_t i, ElementContribution& contribution) { evaluate(elements[i], contribution); },
      [&](std::size_t i, const ElementContribution& contribution) {
        sum.add_element(elements[i].rows.rows(), order, contribution.value, contribution.slope.data(),
                        contribution.lower.data());
        return true;
      });
}

}  // namespace supple::weave
