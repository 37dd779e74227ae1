#pragma once

#include <memory>
#include <utility>

#include "supple/base/random.h"
#include "supple/surface/triangle_mesh.h"

/// Meshes for tests and benchmarks, which are the same on every machine.
namespace supple::testing {

using surface::TriangleMesh;

/// The mesh as a shared pointer, for the solvers.
inline std::shared_ptr<const TriangleMesh> share(TriangleMesh mesh) {
  return std::make_shared<const TriangleMesh>(std::move(mesh));
}

/// Unit sphere, 20 * 4^subdivisions faces: 1,280 at 3.
TriangleMesh icosphere(int subdivisions);
/// Torus about the z axis with tube radius `minor`, 2 around * across faces: 2,304 at 48, 24.
TriangleMesh torus(int around = 48, int across = 24, double major = 1.0, double minor = 0.4);
/// Smoothed slab with three holes, 136 n^2 faces: 2,176 at 4.
TriangleMesh genus3(int n = 4);
/// Sitting rabbit of rounded blocks about 7 high, z up, with thin ears, 216 n^2 faces: 7,776 at 6.
TriangleMesh rabbit(int n = 6);
/// Unit cube [0, 1]^3, each side an n by n grid, 12 n^2 faces.
TriangleMesh cube(int n);
/// The cube with `bumps` waves along each side of height `amplitude` (in units of the side), 12 n^2 faces: 40,368
/// at 58. Shallow bumps split wave fronts many times, so that each edge has about 20 windows; steep ones would block
/// windows behind them, so that there were fewer. `bumps` is a multiple of 0.5, and 2 bumps is no multiple of n.
TriangleMesh bumpy_cube(int n = 58, double bumps = 6.5, double amplitude = 0.004);
/// A flattened tube wound into a rising spiral and closed at both ends, 2 along * across faces: 34,800 at 870, 20. It
/// is so long and thin that paths cross hundreds of edges.
TriangleMesh spiral_cup(int along = 870, int across = 20, double turns = 4);

/// Graph of z = x^2 - y^2 over [-1, 1]^2, 2 n^2 faces; every inner vertex is hyperbolic.
TriangleMesh saddle(int n);
/// Upper half of the unit sphere, bounded by the equator; around * (2 rings - 1) faces.
TriangleMesh open_hemisphere(int around = 32, int rings = 10);
/// Plane annulus of radii 0.5 and 1 cut open along the positive x axis, 2 around * rings faces. The two sides of the
/// slit coincide but are not joined: paths between them go around the hole.
TriangleMesh slit_annulus(int around = 40, int rings = 6);
/// Plane L: the square [0, 2]^2 without (1, 2]^2, 6 n^2 faces. Geodesics at the boundary bend at the corner (1, 1).
TriangleMesh l_shape(int n);
/// Plane grid of unit squares [0, nx] x [0, ny], each cut along the same diagonal.
TriangleMesh flat_grid(int nx, int ny);
/// The same grid with inner vertices moved by up to 0.3 in either direction and random diagonals.
TriangleMesh jittered_grid(int nx, int ny, RandomStream& stream);
/// Fan of `n` flat sectors of slant length 1 around vertex 0, whose angle is `total_angle` (radians, below n pi); each
/// sector is cut into `rings` strips. Above 2 pi the apex is a saddle and n must be even. n (2 rings - 1) faces. The
/// development is exact: distances follow from plane trigonometry.
TriangleMesh cone(int n, double total_angle, int rings = 1);

/// Open cylinder of length 1 and radius `radius` about the z axis, `around` * 2 `along` faces: with the defaults the
/// faces are needles of aspect ratio above 1,000.
TriangleMesh needle_cylinder(int around = 12, int along = 4, double radius = 2e-4);
/// Unit sphere of rings in close pairs, `gap` (radians) apart and rotated against each other: obtuse slivers of aspect
/// ratio above 1,000 next to large faces. 2 around * (2 pairs) faces.
TriangleMesh sliver_sphere(int around = 24, int pairs = 8, double gap = 1e-4);
/// An icosphere and a torus that do not touch.
TriangleMesh two_components();

/// Closed tube of radius 0.38 around a trefoil knot, 2 along * across faces.
TriangleMesh trefoil_knot(int along = 160, int across = 12);

}  // namespace supple::testing
