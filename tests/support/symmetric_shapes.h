#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "supple/base/random.h"
#include "supple/surface/surface_point.h"

namespace supple::testing {

/// A surface that rotations or reflections map onto itself, with sites that they map onto each other: the borders of
/// the sites' cells lie on the axes and planes of the symmetry, and so on edges, vertices and diagonals of the mesh.
struct SymmetricSites {
  std::string name;  ///< the shape, where the sites lie, and the draw
  surface::TriangleMesh mesh;
  std::vector<surface::SurfacePoint> sites;
  std::vector<int> orbits;  ///< for each site a number: sites of equal numbers have cells of equal area
};

/// What is done to the vertices once the sites have their barycentric coordinates.
struct Disturbance {
  bool turned = false;   ///< by a random rotation and translation, which changes last digits
  bool float32 = false;  ///< coordinates rounded to single precision
  double noise = 0;      ///< every coordinate moves by up to this, in units of the bounding box's diagonal
};

/// How many families of shapes there are: tori, boxes, prisms with caps, tubes, rectangles, L-shapes, plates with a
/// square hole, subdivided octahedra.
inline constexpr int symmetric_families = 8;

/// A shape of a family with random proportions, random diagonals where these keep the symmetry of the surface, and the
/// images of one or two random places (vertices, edge middles, points of edges, face middles, points of faces) under
/// its rotations or reflections. Not empty: two sites or more.
SymmetricSites random_symmetric_sites(int family, RandomStream& stream);

/// The same sites on the disturbed surface.
SymmetricSites disturbed(const SymmetricSites& sites, const Disturbance& disturbance, RandomStream& stream);

/// A ring of `around` times 4 trapezoids, cut along the same diagonals, with coordinates of four decimals, as a CAD
/// export has them: vertex 4 i + j lies at angle i round the ring and j round its section.
surface::TriangleMesh exported_ring(int around = 8);

}  // namespace supple::testing
