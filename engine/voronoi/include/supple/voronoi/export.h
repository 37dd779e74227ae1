#pragma once

#include <string>

#include "supple/voronoi/diagram.h"

// Export of diagrams to files, in mesh units. Numbers read back as the same doubles.
namespace supple::voronoi {

/// A Wavefront OBJ file. It has the borders as polylines, one for each Voronoi edge, and then an object "cells": the
/// surface cut along the borders, with one group for each cell.
std::string write_obj(const surface::TriangleMesh& mesh, const Diagram& diagram);

/// A VTK unstructured grid (VTU, ASCII). It has the surface cut along the borders, with the cell data "site" and "area"
/// (of the site's cell), and the borders as polylines, whose "site" is -1.
std::string write_vtu(const surface::TriangleMesh& mesh, const Diagram& diagram);

/// Flat panels for fabrication, as SVG in millimetres. Each panel has the corners of a cell projected onto the plane
/// that fits them best, seen from outside. All panels lie side by side on one sheet. An edge is labelled with its index
/// in Diagram::edges and a panel with its site. `scale` is millimetres per mesh unit. Corners are Voronoi vertices, the
/// vertices of the mesh's boundary, and the points where borders end on it. Cells with fewer than three corners and
/// cells with holes have no panel.
std::string write_panels_svg(const Diagram& diagram, double scale = 1);

/// The panels as a table (CSV), with one line for each corner and the edge that follows it. Columns: panel (site), edge
/// and neighbour (both empty on the mesh's boundary), length (straight as on the panel, mesh units), border_length
/// (along the surface, mesh units), interior angle at the corner (degrees), deviation of the corner from the panel's
/// plane (mesh units, outwards positive).
std::string write_panels_csv(const Diagram& diagram);

}  // namespace supple::voronoi
