#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "face_distances.h"
#include "polygon_sides.h"

namespace supple::voronoi {

/// Finds the Voronoi vertex of the cells that begin at the `cuts` (indices into `boundary`) of a convex polygon: the
/// point that is equally far from their sites [Thesis, eq. 3.25], by Newton's method from `place`, which gets the
/// result. Returns true if it lies in the polygon, whose longest side is `longest`, and no other site is nearer.
/// `corners` are the face's.
bool find_vertex(const FaceDistances& distances, const Active& active, const std::array<Eigen::Vector2d, 3>& corners,
                 const Sides& sides, const std::vector<BoundaryVertex>& boundary, const std::vector<std::size_t>& cuts,
                 double longest, Eigen::Vector2d& place);

}  // namespace supple::voronoi
