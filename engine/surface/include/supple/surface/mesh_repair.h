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

/// The name in a request for the repairs that are needed; see repair_automatically.
constexpr std::string_view automatic_repair_name = "automatic";

struct RepairOptions {
  static constexpr double max_weld_tolerance = 0.01;

  std::array<bool, repair_names.size()> asked{};  ///< whether each Repair is wanted
  bool automatic = false;                         ///< whether the needed repairs are made; no repair is in `asked` then
  /// The distance up to which any vertices are welded, divided by the diagonal of the faces' bounding box
  /// (dimensionless). Without it, only the corners of cracks are welded.
  std::optional<double> weld_tolerance;

  bool has(Repair repair) const { return asked[static_cast<std::size_t>(repair)]; }
  void ask(Repair repair) { asked[static_cast<std::size_t>(repair)] = true; }
};

/// What the repairs have changed. "Given" vertices and faces are those before all repairs.
struct RepairOutcome {
  std::int64_t welded_vertices = 0;  ///< vertices that were joined to an earlier one
  /// The distance in mesh units up to which they were joined: the tolerance, or the largest gap of a crack.
  double weld_distance = 0;
  std::int64_t dropped_degenerate_faces = 0;
  std::int64_t dropped_duplicate_faces = 0;
  std::int64_t split_edges = 0;       ///< edges with more than two faces that were split
  std::int64_t split_vertices = 0;    ///< vertices that were replaced by several
  std::int64_t removed_vertices = 0;  ///< vertices that lost all of their faces; welded ones are not counted

  std::vector<std::int64_t> vertex_starts;  ///< one entry more than there are given vertices; see vertices_of
  std::vector<std::int32_t> new_vertices;
  std::vector<std::int32_t> new_faces;  ///< the new number of each given face; -1 if it was dropped

  /// Whether the repair has changed anything.
  bool made(Repair repair) const;

  /// The new vertices of given vertex v: those that its faces now have, in ascending order. There are several if it was
  /// split. If none of its faces remains, this is the vertex to which it was welded, or itself, or none if it was
  /// removed.
  std::span<const std::int32_t> vertices_of(std::size_t v) const {
    return {new_vertices.data() + vertex_starts[v], new_vertices.data() + vertex_starts[v + 1]};
  }
};

/// Makes the repairs that `options` asks for. The soup's warnings then report them, with one sentence for each repair
/// that found something. Positions, order and orientation of everything else stay as they are.
///
/// - weld without a tolerance: corners of cracks are joined. A crack consists of edges with one face whose end points
///   are equal, or differ in their last digits only: by up to 4 units in the last place of single precision at the
///   largest coordinate, or else by up to 1e-5 of the diagonal. Every edge there must be at least 8 times as long.
///   Vertices inside a surface stay separate, and so do the sides of thin walls and sheets. Each vertex moves to the
///   first one.
/// - weld with a tolerance: a vertex is joined to the vertex of least number within the weld distance that was not
///   joined to another one itself. No vertex moves further than the distance, and the remaining vertices are further
///   apart.
/// - drop_degenerate: drops faces that TriangleMesh::build would call degenerate.
/// - drop_duplicates: drops faces that have the three vertices of an earlier face, in any order.
/// - split_non_manifold: all faces are cut apart at edges with more than two faces [Gueziec2001]. Then each fan of
///   faces that are joined by edges around a vertex gets a vertex of its own. The fan of the first face retains the old
///   vertex, and the new vertices follow after all others. If two of the faces of a cut edge are still joined around
///   both of its ends, they become neighbours again.
///
/// Vertices of faces that were all dropped are removed. Vertices that no given face uses stay. O(n log n).
///
/// Throws Error: "mesh.empty", also if no face remains; "mesh.non_finite" and "mesh.index_out_of_range" as
/// TriangleMesh::build does; "mesh.too_large" if the split vertices exceed `limits`; with split_non_manifold,
/// "mesh.degenerate_face" if such faces remain.
RepairOutcome repair_mesh(TriangleSoup& soup, const RepairOptions& options, const MeshLimits& limits = {},
                          const Execution& execution = {});

/// Makes the mesh sound with as few repairs as possible, in the order of their names. First cracks are welded if there
/// are cracks or faults. Each further repair is made while TriangleMesh::build finds a fault. A repair that finds
/// nothing to change does not count as made (RepairOutcome::made). If welding leads to no sound mesh, the others are
/// tried without it. A mesh without faults then stays as it is.
///
/// Throws what TriangleMesh::build throws for the given soup, if no repairs make it sound. O(n log n), with at most
/// eight copies of the soup one after the other.
RepairOutcome repair_automatically(TriangleSoup& soup, const MeshLimits& limits = {}, const Execution& execution = {});

/// Builds the mesh. Throws what TriangleMesh::build throws. The message then names the repairs that remove the fault,
/// if there are any: those that repair_automatically makes.
TriangleMesh build_with_advice(const TriangleSoup& soup, const MeshLimits& limits = {},
                               const Execution& execution = {});

/// A sentence that counts the corners of cracks, and names the repair weld if it closes them. Empty if there are no
/// cracks. Places where more than two boundary edges coincide are not counted. O(n), plus O(b log b) for the b edges
/// with one face.
std::vector<std::string> crack_warnings(const TriangleMesh& mesh, const Execution& execution = {});

}  // namespace supple::surface
