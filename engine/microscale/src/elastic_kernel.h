#pragma once

#include "material_law.h"
#include "supple/base/lanes.h"

namespace supple::microscale {

/// A triangle's six nodes and the two columns of F. The latter act like nodes with the coordinates as shape functions.
inline constexpr int local_nodes = 8;
inline constexpr int local_pairs = local_nodes * (local_nodes + 1) / 2;

/// Four triangles side by side.
struct ElasticBatch {
  // In:
  Lanes barycentric_gradient[3][2];  ///< of the corners' barycentric coordinates at rest, 1/mm
  Lanes area;                        ///< mm^2
  Lanes displacement[6][2];          ///< periodic part, mm
  Lanes strain_change[2][2];         ///< F - I
  // Out:
  Lanes energy;                        ///< MPa mm^2
  Lanes force[local_nodes][2];         ///< derivative of the energy
  Lanes stiffness[local_pairs][2][2];  ///< second derivative: pair (k, l), l <= k, at k (k + 1) / 2 + l
};

/// Energy (order 0), force (1) and stiffness (2). False where det F <= 0 at an integration point. Written once;
/// compiled for AVX2 and for any x86-64, chosen when the program runs.
bool integrate(const MaterialLaw& law, int order, ElasticBatch& batch);

/// The least t > 0 at which det F of an integration point vanishes on at + t along; may be infinite if there is none up
/// to farthest_inversion.
inline constexpr double farthest_inversion = 1.25;
double first_inversion(const ElasticBatch& at, const ElasticBatch& along);

}  // namespace supple::microscale
