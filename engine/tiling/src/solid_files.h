#pragma once

#include <string>
#include <vector>

#include "beams.h"
#include "supple/base/execution.h"
#include "supple/meshing/planar_mesh.h"

// These functions write plane solids, given as faces in millimetres, as files. They work in this process.
namespace supple::tiling {

/// One SVG path with holes (even-odd fill), true to scale, with the origin in its middle. The title must not need
/// escapes. `attributes` are further attributes of the root, each after a space.
std::string svg_of(const std::vector<Face>& faces, const std::string& title, const std::string& attributes = {});
/// Closed LWPOLYLINEs, AutoCAD R2000 ASCII. A title that is not empty becomes a comment.
std::string dxf_of(const std::vector<Face>& faces, const std::string& title);

/// The triangles of the solid's top, whose boundary nodes are the faces' vertices. Throws "tiling.meshing_failed".
meshing::PlanarMesh caps_of(const std::vector<Face>& faces);
/// The faces extruded by `thickness` (mm): a closed, consistently oriented surface, binary STL. The title, which is cut
/// to 79 bytes, must not begin with "solid".
std::string stl_of(const std::vector<Face>& faces, const meshing::PlanarMesh& caps, double thickness,
                   const std::string& title);
/// Faces with a name, and the triangles of their top (see `caps_of`).
struct NamedSolid {
  std::string name;
  std::vector<Face> faces;
  meshing::PlanarMesh caps;
};
/// The extruded solids as a 3MF package with one object for each, named after it. If there are several, they are the
/// components of one object named by the title, so that programs keep them together. The title must not need escapes.
std::string three_mf_of(const std::vector<NamedSolid>& solids, double thickness, const std::string& title);

/// The faces extruded by `thickness` (mm) as solids with plane faces, ISO 10303-21 of the protocol AP214. The title
/// must not need escapes. Takes some 1.2 kB for each corner.
std::string step_of(const std::vector<Face>& faces, double thickness, const std::string& title,
                    const Execution& execution);

}  // namespace supple::tiling
