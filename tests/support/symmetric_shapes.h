#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "supple/base/random.h"
#include "supple/surface/surface_point.h"

namespace supple::testing {

/// A surface that rotations or reflections map onto itself, with sites that they map onto each other. The borders of
/// the sites' cells lie on the axes and planes of symmetry, and so on edges, vertices and diagonals of the mesh.
struct SymmetricSites {
  std::string name;  ///< the shape, the kind of the sites' places, and the random parameters
  surface::TriangleMesh mesh;
  std::vector<surface::SurfacePoint> sites;
  std::vector<int> orbits;  ///< number of each site's orbit; sites of one orbit have cells of equal area
};

/// Changes of the vertices after the barycentric coordinates of the sites have been determined.
struct Disturbance {
  bool turned = false;   ///< whether a random rotation and translation change the last digits
  bool float32 = false;  ///< whether coordinates are rounded to single precision
  double noise = 0;      ///< largest random change of a coordinate, in units of the bounding box's diagonal
};

/// Number of families of shapes: tori, boxes, prisms with caps, tubes, rectangles, L-shapes, plates with a square hole,
/// subdivided octahedra.
inline constexpr int symmetric_families = 8;

/// A shape of a family with random proportions, and with random diagonals if these preserve the symmetry of the
/// surface. Its sites, at least two, are the images of one or two random places (vertices, edge midpoints, points on
/// edges, face centres, points in faces) under its rotations or reflections.
SymmetricSites random_symmetric_sites(int family, RandomStream& stream);

/// The same sites, by their barycentric coordinates, on the disturbed surface.
SymmetricSites disturbed(const SymmetricSites& sites, const Disturbance& disturbance, RandomStream& stream);

/// A ring of `around` times 4 trapezoids, cut along the same diagonals, with coordinates of four decimals, as in a CAD
/// export. Vertex 4 i + j is at angle i of the ring and at corner j of its cross-section.
surface::TriangleMesh exported_ring(int around = 8);

}  // namespace supple::testing
