#include "plate_barrier.h"

namespace supple::microscale {

PlateBarrier::PlateBarrier(const PartSupports& supports, const Material& material, double mesh_size)
    : supports_(supports), stiffness_(material.youngs_modulus / mesh_size) {}

void PlateBarrier::add(const CellState& state, int order, numerics::EnergySum& sum) const {
  for (const PartSupports::Surface& surface : supports_.surfaces())
    for (const PartSupports::Candidate& candidate : supports_.candidates()) {
      const double gap = supports_.gap(surface, candidate.node, state.x, fraction_);
      const double depth = gap < 0 ? -gap : 0;
      const double weight = stiffness_ * candidate.length;
      const Eigen::Index dof = 2 * static_cast<Eigen::Index>(candidate.node) + surface.axis;
      sum.value += weight * depth * depth * depth / 3;
      if (order >= 1) sum.gradient[dof] -= surface.sign * weight * depth * depth;
      // Entries that are zero are added too, so that the sequence of entries is always the same.
      if (order >= 2) sum.hessian.add(dof, dof, 2 * weight * depth);
    }
}

}  // namespace supple::microscale
