#pragma once

#include "material_law.h"
#include "supple/base/lanes.h"

namespace supple::microscale {

/// A triangle's six nodes and the two columns of F. A column acts like a node whose shape function is a coordinate.
inline constexpr int local_nodes = 8;
inline constexpr int local_pairs = local_nodes * (local_nodes + 1) / 2;

/// Four triangles, one in each lane of a vector.
struct ElasticBatch {
  // Input:
  Lanes barycentric_gradient[3][2];  ///< gradients of the corners' barycentric coordinates at rest, 1/mm
  Lanes area;                        ///< mm^2
  Lanes displacement[6][2];          ///< periodic part of the nodes' displacements, mm
  Lanes strain_change[2][2];         ///< F - I
  // Output:
  Lanes energy;                        ///< MPa mm^2
  Lanes force[local_nodes][2];         ///< first derivatives of the energy
  Lanes stiffness[local_pairs][2][2];  ///< second derivatives: pair (k, l), l <= k, at k (k + 1) / 2 + l
};

/// Computes the energy (order 0), also the forces (order 1), also the stiffness (order 2). Returns false if det F <= 0
/// at an integration point. The code is compiled for AVX2 and for any x86-64; one of the two is chosen at run time.
bool integrate(const MaterialLaw& law, int order, ElasticBatch& batch);

/// An inversion at a larger t than this may be overlooked.
inline constexpr double max_inversion_step = 1.25;
/// The least t > 0 at which det F vanishes at an integration point of the state `at` + t `along`. It may be infinite if
/// there is none up to max_inversion_step.
double first_inversion(const ElasticBatch& at, const ElasticBatch& along);

}  // namespace supple::microscale
