#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "supple/voronoi/diagram.h"

namespace supple::voronoi {

/// A cell made flat: its corners in the plane that fits them best, counterclockwise seen from outside.
struct Panel {
  std::int32_t site = -1;
  std::vector<Eigen::Vector2d> corners;
  std::vector<double> deviations;        ///< of the corners from the plane, mesh units, outwards positive
  std::vector<std::int32_t> edges;       ///< from each corner to the next: index into Diagram::edges; -1 on the rim
  std::vector<std::int32_t> neighbours;  ///< across that edge; -1 on the rim
  std::vector<double> border_lengths;    ///< along the surface, mesh units
};

/// The panels of all cells that have one border, of three or more corners: Voronoi vertices and, on the mesh's
/// boundary, its vertices and where borders end.
std::vector<Panel> panels(const Diagram& diagram);

}  // namespace supple::voronoi
