#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "supple/base/error.h"

namespace supple::meshing {

/// No method of gmsh triangulates a region ("tiling.meshing_failed").
class MeshingFailed : public Error {
 public:
  using Error::Error;
};

struct PlanarMesh {
  std::vector<Eigen::Vector2d> points;        ///< first those of the boundary, in the given order, then those inside
  std::vector<std::array<int, 3>> triangles;  ///< counterclockwise
};

/// A connected part of the plane: its outline, then the outlines of its holes, as polygons.
using PlanarFace = std::vector<std::vector<Eigen::Vector2d>>;

/// Triangulates faces with gmsh. Every vertex becomes a node, and every side is the side of a triangle. The method is
/// frontal Delaunay, plain Delaunay or adaption of an initial mesh, whichever first gives triangles that fill the face.
/// `size` is the wanted length of sides at a point, in the unit of the coordinates. This unit should be about 1 mm,
/// because points inside are rounded to 2^-32 of it. Faces that touch have nodes of their own.
///
/// gmsh has one global state. The process has one owner of it, whose callers wait for each other. gmsh prints nothing,
/// reads no file and installs no signal handler. Throws MeshingFailed with gmsh's message.
PlanarMesh triangulate(const std::vector<PlanarFace>& faces, const std::function<double(const Eigen::Vector2d&)>& size);

}  // namespace supple::meshing
