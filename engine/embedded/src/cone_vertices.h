#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "elastic_network.h"
#include "network_state.h"
#include "supple/numerics/term.h"
#include "supple/surface/geodesic_solver.h"
#include "supple/surface/vertex_cone.h"

namespace supple::embedded {

/// The forces of the paths that end at a point which is at a vertex. There the surface is like the tip of a cone, and
/// the energy has a directional derivative in every direction instead of a gradient.
struct ConeForces {
  std::vector<surface::ArrivingPath> paths;  ///< directions in which paths arrive, with their forces
  double stiffness = 0;           ///< sum of the energy's second derivatives by the lengths, as far as positive
  bool has_separate_end = false;  ///< whether some path has its other end in another place
  bool is_valid = true;           ///< whether the energy is finite and no spring pushes coincident points apart
};
using PathLookup = std::function<const surface::TangentGeodesic&(std::size_t path)>;

ConeForces cone_forces(const ElasticNetwork& network, std::size_t point, const PathLookup& path);

/// Adds the derivatives of the energy by a point at a vertex: as gradient the steepest descent of all directions, zero
/// where no direction descends, and as Hessian that of a flat surface.
void add_cone_vertex(const ElasticNetwork& network, const NetworkState& state, std::size_t point, int order,
                     numerics::EnergySum& sum);

/// Whether a point would rest at a vertex, with all others where they are. One search for each path of the point.
bool rests_at_vertex(const ElasticNetwork& network, const surface::GeodesicSolver& solver, const NetworkState& state,
                     std::size_t point, std::int32_t vertex);

}  // namespace supple::embedded
