#pragma once

#include <vector>

#include "supple/voronoi/diagram.h"

namespace supple::voronoi {

/// A part of a border between two points of the diagram, with a cell on either side; of the mesh's boundary -1 on the
/// right.
struct BorderPart {
  std::int32_t from = -1;
  std::int32_t to = -1;
  std::int32_t left = -1;
  std::int32_t right = -1;
  double length = 0;
};

/// Fills vertices, edges, dual and of the cells boundary, vertices and neighbours of a diagram that has its points,
/// from the parts of all borders. Those that leave a point of kind `vertex` which a cell meets more than once come
/// counterclockwise. Voronoi vertices that are nearer to each other than `merged` along a border are one.
void assemble_cells(const std::vector<BorderPart>& parts, double merged, Diagram& diagram);

}  // namespace supple::voronoi
