#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "supple/surface/mesh_io.h"

namespace supple::surface {

/// The repairs, in the order in which they are made.
enum class Repair { weld, drop_degenerate, drop_duplicates, split_non_manifold };

constexpr std::array<std::string_view, 4> repair_names{"weld", "drop_degenerate", "drop_duplicates",
                                                       "split_non_manifold"};

/// Stands in a request for the repairs that are needed, see repair_automatically.
constexpr std::string_view automatic_repair_name = "automatic";

struct RepairOptions {
  static constexpr double largest_weld_tolerance = 0.01;

  std::array<bool, repair_names.size()> asked{};  ///< whether each Repair is wanted
  bool automatic = false;                         ///< the repairs that are needed; none is in `asked` then
  /// The distance up to which any vertices are welded, divided by the diagonal of the bounding box of the faces;
  /// dimensionless. Without it the corners of cracks are welded and nothing else.
  std::optional<double> weld_tolerance;

  bool has(Repair repair) const { return asked[static_cast<std::size_t>(repair)]; }
  void ask(Repair repair) { asked[static_cast<std::size_t>(repair)] = true; }
};

/// What the repairs have changed. "Given" vertices and faces are those before all repairs.
struct RepairOutcome {
  std::int64_t welded_vertices = 0;  ///< vertices that were joined to an earlier one
  /// The distance up to which they were joined, in mesh units: the tolerance, or the widest gap of a crack.
  double weld_distance = 0;
  std::int64_t dropped_degenerate_faces = 0;
  std::int64_t dropped_duplicate_faces = 0;
  std::int64_t split_edges = 0;       ///< edges with more than two faces that were cut apart
  std::int64_t split_vertices = 0;    ///< vertices that became several
  std::int64_t removed_vertices = 0;  ///< vertices that lost all of their faces; welded ones are not counted

  std::vector<std::int64_t> vertex_starts;  ///< one entry more than there are given vertices; see vertices_of
  std::vector<std::int32_t> new_vertices;
  std::vector<std::int32_t> new_faces;  ///< the new number of each given face; -1 if it was dropped

  /// Whether the repair has changed anything.
  bool made(Repair repair) const;

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
/// - weld without a tolerance: the corners of cracks are joined. These are edges of one face whose ends are equal or
///   differ in their last digits only (by up to 4 units in the last place of single precision at the largest
///   coordinate, else by up to 1e-5 of the diagonal), while every edge there is at least 8 times as long. Vertices
///   inside a surface stay apart, and so do the sides of thin walls and sheets. Each vertex moves to the first one.
/// - weld with a tolerance: a vertex is joined to the vertex with the least number that is no further away than the
///   weld distance and was not joined to another one itself. So no vertex moves further than that distance, and the
///   vertices that are left are further apart.
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

/// Makes the mesh sound with as few repairs as it takes, in the order of their names: weld (of cracks only) where there
/// are cracks or faults, then each further one as long as TriangleMesh::build finds a fault. One that finds nothing to
/// repair counts as not made (RepairOutcome::made). Where welding leads to no sound mesh, the others are tried without
/// it; a mesh without faults then stays as it is.
///
/// Throws Error: what TriangleMesh::build throws for the soup as it was given, where no repairs make it sound.
/// O(n log n), with at most eight copies of the soup one after the other.
RepairOutcome repair_automatically(TriangleSoup& soup, const MeshLimits& limits = {}, const Execution& execution = {});

/// Builds the mesh. Throws what TriangleMesh::build throws; the sentence then names the repairs that remove the fault,
/// if there are any: those that repair_automatically makes.
TriangleMesh build_with_advice(const TriangleSoup& soup, const MeshLimits& limits = {},
                               const Execution& execution = {});

/// A sentence that counts the corners of cracks and names the repair weld if it closes them; none for a mesh without
/// cracks. Where more than two edges meet, none are counted. O(n), plus O(b log b) for the b edges with one face.
std::vector<std::string> crack_warnings(const TriangleMesh& mesh, const Execution& execution = {});

}  // namespace supple::surface
