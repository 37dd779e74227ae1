#pragma once

#include <optional>
#include <span>

#include "search_target.h"
#include "supple/surface/geodesic.h"
#include "supple/surface/path_start.h"

namespace supple::surface {

/// Views of the results of a finished search, which belong to a WindowSearch or to a field.
struct SearchState {
  const SearchMesh* mesh;
  std::span<const Trail> trails;  ///< the full trails to which other trails refer
  const VertexRecord* records;
  std::span<const SurfacePoint> sources;
  std::span<const TiedArrival> ties = {};
};

/// The first and the last straight segment of a shortest path, in the tangent frames of the ends' faces.
struct PathEnds {
  Eigen::Vector2d from_direction = Eigen::Vector2d::Zero();  ///< unit direction of travel at the source
  Eigen::Vector2d to_direction = Eigen::Vector2d::Zero();    ///< unit direction of travel at the target
  double first_length = 0;                                   ///< length from the source to the first pin or the target
  double last_length = 0;                                    ///< length from the last pin or the source to the target
  bool pinned = false;                                       ///< a vertex pins the path between its ends
};

/// The geodesic of a target's best arrival: length, uniqueness and pins, and the path and derivatives if asked for.
Geodesic assemble(const SearchState& state, const SearchTarget& target, const GeodesicOptions& options);

/// Index of the source at which the arrival's path begins; -1 if there is none.
int source_of(const SearchState& state, const SearchTarget& target);

/// How the arrival's path leaves its source.
PathStart start_of(const SearchState& state, const SearchTarget& target);

/// Derivatives of the distance in closed form, computed from the path's end segments.
GeodesicDerivatives end_derivatives(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                                    const PathEnds& ends, int order);

}  // namespace supple::surface
