#pragma once

#include <vector>

#include "rod_model.h"
#include "rod_state.h"
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

/// Adds an element's gradient (order 1) and Hessian (2) to the sum. gradient[slot]; hessian(i, j) for slots i >= j.
template <typename Gradient, typename HessianOf>
void scatter(const Links& links, int order, const Gradient& gradient, const HessianOf& hessian,
             numerics::EnergySum& sum) {
  if (order < 1) return;
  for (const Link& a : links) sum.gradient[a.dof] += a.coefficient * gradient[static_cast<std::size_t>(a.slot)];
  if (order < 2) return;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Link& a = links[i];
    if (sum.hessian.drops(a.dof)) continue;
    for (std::size_t j = 0; j <= i; ++j) {
      const Link& b = links[j];
      if (sum.hessian.drops(b.dof)) continue;
      const double entry =
          a.coefficient * b.coefficient * (a.slot >= b.slot ? hessian(a.slot, b.slot) : hessian(b.slot, a.slot));
      // Of two links to one degree of freedom both orders count.
      sum.hessian.add(a.dof, b.dof, a.dof == b.dof && i != j ? 2 * entry : entry);
    }
  }
}

}  // namespace supple::weave
