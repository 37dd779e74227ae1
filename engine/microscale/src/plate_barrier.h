#pragma once

#include "cell_state.h"
#include "part_supports.h"
#include "supple/numerics/term.h"

namespace supple::microscale {

/// Keeps nodes from passing far through the surfaces of plates while an equilibrium is searched:
///   E = k / (3 h) sum_p l_p max(0, -d_p)^3
/// in MPa mm^2 per mm of thickness. d_p is the distance of node p from a plate in mm, l_p the rest length of outline
/// assigned to p, h the size of the mesh, and k Young's modulus. E is twice continuously differentiable and convex, and
/// exactly zero together with its derivatives if no node has passed a surface. At an equilibrium of the part none has:
/// PartSupports::corrected holds such nodes at the surface.
class PlateBarrier : public numerics::Term<CellState> {
 public:
  /// The supports must outlive the term.
  PlateBarrier(const PartSupports& supports, const Material& material, double mesh_size);

  std::string_view name() const override { return "plate_barrier"; }
  bool active() const override { return !supports_.surfaces().empty(); }
  void add(const CellState& state, int order, numerics::EnergySum& sum) const override;

  /// Moves the plates to their positions at this fraction of the path.
  void set_fraction(double fraction) { fraction_ = fraction; }

 private:
  const PartSupports& supports_;
  double stiffness_;  ///< k / h, MPa / mm
  double fraction_ = 0;
};

}  // namespace supple::microscale
