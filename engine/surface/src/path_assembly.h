#pragma once

#include <optional>
#include <span>

#include "supple/surface/geodesic.h"
#include "supple/surface/path_start.h"
#include "window_search.h"

namespace supple::surface {

/// What a finished search knows, whether it still sits in its workspace or was moved into a field.
struct SearchState {
  const SearchMesh* mesh;
  std::span<const Trail> trails;  ///< the full ones that others refer to
  const VertexRecord* records;
  std::span<const SurfacePoint> sources;
  std::span<const TiedArrival> ties = {};
};

/// The straight pieces at both ends of a shortest path, in the tangent frames of the ends' faces.
struct PathEnds {
  Eigen::Vector2d from_direction = Eigen::Vector2d::Zero();  ///< unit, of travel, at the source
  Eigen::Vector2d to_direction = Eigen::Vector2d::Zero();    ///< unit, of travel, at the target
  double first_length = 0;                                   ///< from the source to the first pin or the target
  double last_length = 0;                                    ///< from the last pin or the source to the target
  bool pinned = false;                                       ///< a vertex holds the path somewhere between
};

/// Completes the answer for a target from its arrival: length, uniqueness, pins, and path and derivatives if asked for.
Geodesic assemble(const SearchState& state, const SearchTarget& target, const GeodesicOptions& options);

/// Index of the source at which the arrival's path begins; -1 if there is none.
int source_of(const SearchState& state, const SearchTarget& target);

/// How the arrival's path leaves its source.
PathStart start_of(const SearchState& state, const SearchTarget& target);

/// Closed-form derivatives of the distance from its ends' directions and lengths.
GeodesicDerivatives end_derivatives(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                                    const PathEnds& ends, int order);

}  // namespace supple::surface
