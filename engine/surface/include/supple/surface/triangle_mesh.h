#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "supple/base/execution.h"

#include "supple/base/ids.h"

namespace supple::surface {

using Triangle = std::array<std::int32_t, 3>;

/// An immutable, oriented, manifold triangle mesh (with or without boundary, of any number of components) with the
/// intrinsic quantities that geodesics need.
///
/// Halfedge h = 3 f + i runs from corner i to corner i + 1 of face f, so next, previous and face need no table. All
/// lengths are in mesh units, all angles in radians. Memory: about 150 bytes per face.
class TriangleMesh {
 public:
  /// An empty mesh.
  TriangleMesh() = default;

  /// Builds the connectivity. O(n log n): about 0.3 s for a million faces. `warnings` are those from reading the file;
  /// they come before the ones that are added here.
  ///
  /// Faces whose orientation disagrees with their neighbours are turned if the surface is orientable, which `warnings`
  /// reports. Throws Error, with one detail for each of the first 20 faulty elements ("face 17", "edge 3 8", "vertex
  /// 5"; the message gives the total): "mesh.empty", "mesh.too_large" (above 715,827,882 vertices or faces),
  /// "mesh.non_finite" (coordinates, also above a magnitude of 1e70), "mesh.index_out_of_range", "mesh.degenerate_face"
  /// (a repeated vertex, or an area that vanishes in double precision: a height below the rounding of the coordinates,
  /// or below 1e-140), "mesh.non_manifold_edge", "mesh.non_manifold_vertex", "mesh.not_orientable". Ends within
  /// milliseconds after a stop is requested.
  static TriangleMesh build(std::vector<Eigen::Vector3d> positions, std::vector<Triangle> faces,
                            std::vector<std::string> warnings = {}, const Execution& execution = {});

  /// The same surface with its vertices moved. Faces, twins, fans and components are copied; lengths and angles are
  /// those of the new positions. O(n), without the sorting and traversals of `build`, for surfaces that deform step by
  /// step. Everything but `warnings` equals build(positions, faces()). The warnings are empty, because those of this
  /// mesh are about its connectivity, and coincident vertices are not searched for.
  ///
  /// Throws what `build` throws for positions: "mesh.non_finite" and "mesh.degenerate_face", with the same details.
  /// Throws "mesh.position_count" (detail "vertices") if the number of positions is not vertex_count().
  TriangleMesh with_positions(std::vector<Eigen::Vector3d> positions) const;

  std::int32_t vertex_count() const { return static_cast<std::int32_t>(positions_.size()); }
  std::int32_t face_count() const { return static_cast<std::int32_t>(faces_.size()); }
  std::int32_t halfedge_count() const { return 3 * face_count(); }
  const std::vector<Eigen::Vector3d>& positions() const { return positions_; }
  const std::vector<Triangle>& faces() const { return faces_; }
  /// One sentence for each thing that was repaired or deserves attention (turned faces, unused or coincident vertices).
  const std::vector<std::string>& warnings() const { return warnings_; }

  static std::int32_t face_of(std::int32_t h) { return h / 3; }
  static std::int32_t next(std::int32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::int32_t previous(std::int32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  /// The halfedge of the other face on the same edge, -1 on the boundary.
  std::int32_t twin(std::int32_t h) const { return twins_[h]; }
  std::int32_t tail(std::int32_t h) const { return faces_[h / 3][h % 3]; }
  std::int32_t head(std::int32_t h) const { return faces_[h / 3][(h + 1) % 3]; }
  double edge_length(std::int32_t h) const { return lengths_[h]; }
  /// The corner angle of face_of(h) at tail(h).
  double corner_angle(std::int32_t h) const { return angles_[h]; }

  /// An outgoing halfedge of v from which h -> twin(previous(h)) visits every face around v counterclockwise. At a
  /// boundary vertex it is the one without a twin. -1 for a vertex that no face uses.
  std::int32_t outgoing(std::int32_t v) const { return outgoing_[v]; }
  /// The next outgoing halfedge of the same tail, counterclockwise; -1 after the last one of a boundary vertex.
  std::int32_t rotate(std::int32_t h) const { return twins_[previous(h)]; }
  bool is_boundary(std::int32_t v) const { return boundary_[v] != 0; }
  /// Sum of the corner angles around v. It is 2 pi if the surface is flat there, and more at a saddle vertex.
  double vertex_angle(std::int32_t v) const { return vertex_angles_[v]; }
  /// Connected component of a face, numbered from 0 in the order of their first faces.
  std::int32_t component(std::int32_t f) const { return components_[f]; }
  std::int32_t component_count() const { return component_count_; }

  double mean_edge_length() const { return mean_edge_length_; }
  /// Length of the bounding box's diagonal. Vertices that no face uses do not count.
  double diagonal() const { return diagonal_; }

 private:
  /// Fills lengths, angles and extent from positions and connectivity.
  void measure(const Execution& execution = {});

  std::vector<Eigen::Vector3d> positions_;
  std::vector<Triangle> faces_;
  std::vector<std::int32_t> twins_;
  std::vector<double> lengths_;
  std::vector<double> angles_;
  std::vector<std::int32_t> outgoing_;
  std::vector<std::uint8_t> boundary_;
  std::vector<double> vertex_angles_;
  std::vector<std::int32_t> components_;
  std::int32_t component_count_ = 0;
  double mean_edge_length_ = 0;
  double diagonal_ = 0;
  std::vector<std::string> warnings_;
};

}  // namespace supple::surface
