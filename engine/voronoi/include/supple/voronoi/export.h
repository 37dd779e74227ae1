#pragma once

#include <string>

#include "supple/voronoi/diagram.h"

// A diagram as files, in mesh units. Numbers read back as the same doubles.
namespace supple::voronoi {

/// A Wavefront OBJ file: the borders as line elements, one for each Voronoi edge, then an object "cells" with the
/// surface cut along them, one group for each cell.
std::string write_obj(const surface::TriangleMesh& mesh, const Diagram& diagram);

/// A VTK unstructured grid (VTU, ASCII) of the surface cut along the borders, with the cell data "site" and "area" (of
/// the site's cell), and the borders as polylines, where "site" is -1.
std::string write_vtu(const surface::TriangleMesh& mesh, const Diagram& diagram);

/// Flat panels for a workshop, as SVG in millimetres: the corners of each cell in the plane that fits them best, seen
/// from outside, side by side on one sheet, every edge with the number that it has in Diagram::edges and every panel
/// with its site's. `scale` is millimetres per mesh unit. Corners are Voronoi vertices and, on the mesh's boundary, its
/// vertices and the ends of borders; cells of fewer than three corners and those with holes have no panel.
std::string write_panels_svg(const Diagram& diagram, double scale = 1);

/// The panels as a table (CSV), one line for each corner and the edge that follows it: panel (site), edge and neighbour
/// (empty on the mesh's boundary), length (mesh units, straight as on the panel), border_length (along the surface),
/// interior angle at the corner (degrees), deviation of the corner from the panel's plane (mesh units, outwards
/// positive).
std::string write_panels_csv(const Diagram& diagram);

}  // namespace supple::voronoi
