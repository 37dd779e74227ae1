#pragma once

#include <vector>

#include "supple/voronoi/diagram.h"

namespace supple::voronoi {

/// A part of a border between two points of the diagram, with the sites of the cells on both sides. A part of the
/// mesh's boundary has -1 on the right.
struct BorderPart {
  std::int32_t from = -1;
  std::int32_t to = -1;
  std::int32_t left = -1;
  std::int32_t right = -1;
  double length = 0;  ///< along the border, mesh units
};

/// Fills a diagram that has its points: its vertices, edges and dual, and the boundary, vertices and neighbours of its
/// cells. The parts that leave a point of the kind `vertex` must come counterclockwise if a cell meets it more than
/// once. Voronoi vertices closer than `merge_distance` along a border are merged.
void assemble_cells(const std::vector<BorderPart>& parts, double merge_distance, Diagram& diagram);

}  // namespace supple::voronoi
