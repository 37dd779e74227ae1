#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "supple/surface/mesh_io.h"

namespace supple::surface {

/// The repairs, in the order in which they are made.
enum class Repair { weld, drop_degenerate, drop_duplicates, split_non_manifold };

constexpr std::array<std::string_view, 4> repair_names{"weld", "drop_degenerate", "drop_duplicates",
                                                       "split_non_manifold"};

struct RepairOptions {
  /// The distance up to which vertices are welded, divided by the diagonal of the bounding box of the faces;
  /// dimensionless. Single precision rounds coordinates by up to 1e-7 of the diagonal.
  static constexpr double default_weld_tolerance = 1e-6;
  static constexpr double largest_weld_tolerance = 0.01;

  std::array<bool, repair_names.size()> asked{};  ///< whether each Repair is wanted
  double weld_tolerance = default_weld_tolerance;

  bool has(Repair repair) const { return asked[static_cast<std::size_t>(repair)]; }
  void ask(Repair repair) { asked[static_cast<std::size_t>(repair)] = true; }
};

/// What the repairs have changed. "Given" vertices and faces are those before all repairs.
struct RepairOutcome {
  std::int64_t welded_vertices = 0;  ///< vertices that were joined to an earlier one
  double weld_distance = 0;          ///< the distance up to which they were joined, in mesh units
  std::int64_t dropped_degenerate_faces = 0;
  std::int64_t dropped_duplicate_faces = 0;
  std::int64_t split_edges = 0;       ///< edges with more than two faces that were cut apart
  std::int64_t split_vertices = 0;    ///< vertices that became several
  std::int64_t removed_vertices = 0;  ///< vertices that lost all of their faces; welded ones are not counted

  std::vector<std::int64_t> vertex_starts;  ///< one entry more than there are given vertices; see vertices_of
  std::vector<std::int32_t> new_vertices;
  std::vector<std::int32_t> new_faces;  ///< the new number of each given face; -1 if it was dropped

  /// What became of given vertex v: the vertices that its faces have now, in ascending order. There are several if it
  /// was split. If none of its faces is left, this is the vertex to which it was welded, or itself, or none if it was
  /// removed.
  std::span<const std::int32_t> vertices_of(std::size_t v) const {
    return {new_vertices.data() + vertex_starts[v], new_vertices.data() + vertex_starts[v + 1]};
  }
};

/// Makes the repairs that `options` asks for. The soup's warnings then report them, with one sentence for each repair
/// that found something. Positions, order and orientation of what is left stay as they are.
///
/// - weld: a vertex is joined to the vertex with the least number that is no further away than the weld distance and
///   was not joined to another one itself. So no vertex moves further than that distance, and the vertices that are
///   left are further apart.
/// - drop_degenerate: faces are dropped that TriangleMesh::build would call degenerate.
/// - drop_duplicates: faces are dropped that have the three vertices of an earlier face, in whatever order.
/// - split_non_manifold: all faces are cut apart at edges with more than two faces (as in Guéziec et al. 2001, "Cutting
///   and stitching"). Then each fan of faces that are joined by edges around a vertex gets a vertex of its own. The fan
///   of the first face keeps the old vertex, and the new vertices follow after all others. If two of the faces of a cut
///   edge stay joined around both of its ends, they are neighbours there again.
///
/// Vertices of faces that were all dropped are removed; vertices that no given face uses stay. O(n log n).
///
/// Throws Error: "mesh.empty", also where no face is left; "mesh.non_finite", "mesh.index_out_of_range" as
/// TriangleMesh::build; "mesh.too_large" where the split vertices exceed `limits`; with split_non_manifold
/// "mesh.degenerate_face" where such faces are left.
RepairOutcome repair_mesh(TriangleSoup& soup, const RepairOptions& options, const MeshLimits& limits = {},
                          const Execution& execution = {});

}  // namespace supple::surface
