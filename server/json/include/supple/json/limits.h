#pragma once

#include <cstddef>

namespace supple::json {

/// Limits of requests and their answers. Each limit that an operator can change is named after its setting.
struct Limits {
  std::size_t depth = 32;              ///< nesting of arrays and objects; fixed
  std::size_t max_values = 8'000'000;  ///< JSON values of one body; about 50 bytes of memory each
  std::size_t max_pairs = 100'000;
  std::size_t max_points = 100'000;      ///< points of a mean or a network, sources of a field, sites
  std::size_t max_springs = 300'000;     ///< springs of a network: about the edges of a triangulation of max_points
  std::size_t max_parameters = 32;       ///< parameters of a tiling; fixed
  std::size_t max_states = 1000;         ///< states of a load path
  std::size_t max_strains = 100'000;     ///< strains of an evaluation of a model
  int max_mesh_nodes = 100'000;          ///< mesh nodes of one cell of a structure
  int max_part_nodes = 2'000'000;        ///< mesh nodes of a part; fixed, since its memory is limited before
  std::size_t max_deformed = 1'000'000;  ///< nodes of an answer's deformed meshes or strands, over all states; fixed
  std::size_t max_print_points = 1'000'000;   ///< points of a toolpath; fixed
  std::size_t max_border_points = 1'000'000;  ///< border points of an answer's Voronoi diagram; fixed
  std::size_t max_piece_corners = 2'000'000;  ///< corners of the pieces of cut faces in such an answer; fixed
  std::size_t max_gcode_lines = 200'000;      ///< lines of a G-code file that is checked; fixed
  double max_deadline = 3600;                 ///< seconds
  const char* deadline_setting = "--max-deadline";
  double default_deadline = 600;              ///< seconds
  std::size_t max_layout_points = 5'000'000;  ///< points of the polylines of a layout's strands; fixed
  std::size_t max_load_points = 1'000'000;    ///< points with supports or forces, those in boxes too; fixed
  std::size_t max_strands = 20'000;           ///< strands of a weave's layout; fixed
  std::size_t max_strand_points = 100'000;    ///< points of all strands of a layout; fixed
  std::size_t max_path_points = 1'000'000;    ///< points of all known paths of a request; fixed
};

}  // namespace supple::json
