#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "supple/voronoi/diagram.h"

namespace supple::voronoi {

/// A flat panel for a cell: its corners in the plane that fits them best, counterclockwise seen from outside.
struct Panel {
  std::int32_t site = -1;
  std::vector<Eigen::Vector2d> corners;
  std::vector<double> deviations;  ///< distances of the corners from the plane, mesh units, outwards positive
  std::vector<std::int32_t>
      edges;  ///< edge from each corner to the next, index into Diagram::edges; -1 on the mesh's boundary
  std::vector<std::int32_t> neighbours;  ///< site across that edge; -1 on the mesh's boundary
  std::vector<double> border_lengths;    ///< lengths of the edges along the surface, mesh units
};

/// The panels of all cells with one boundary curve and three or more corners. Corners are Voronoi vertices, the
/// vertices of the mesh's boundary, and the points where borders end on it.
std::vector<Panel> panels(const Diagram& diagram);

}  // namespace supple::voronoi
