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

/// Flat panels for a workshop, as SVG in millimetres: each cell's vertices in the plane that fits them best, side by
/// side, every edge with the number that it has in Diagram::edges and every panel with its site's. `scale` is
/// millimetres per mesh unit. Cells of fewer than three vertices have no panel.
std::string write_panels_svg(const Diagram& diagram, double scale = 1);

/// The panels as a table (CSV): panel (site), edge, neighbour, length (mesh units, straight between the vertices as on
/// the panel), border_length (along the surface), interior angle at the edge's first vertex (degrees), deviation (of
/// that vertex from the panel's plane).
std::string write_panels_csv(const Diagram& diagram);

}  // namespace supple::voronoi
