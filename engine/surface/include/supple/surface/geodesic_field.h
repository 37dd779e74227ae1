#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "supple/surface/face_arrival.h"
#include "supple/surface/geodesic.h"
#include "supple/surface/path_start.h"

namespace supple::surface {

enum class FieldMethod {
  windows,    ///< window propagation: exact, or too long by at most the factor 1 + relative_error
  edge_graph  ///< Dijkstra's algorithm over edges and across pairs of faces: a cheap upper bound
};

struct FieldOptions {
  FieldMethod method = FieldMethod::windows;
  /// The allowed relative error of every distance, >= 0. It is a guarantee and not an estimate. 0 is exact.
  double relative_error = 0;
  /// Distances beyond this need not be found (they are reported as unreached). Mesh units.
  double max_distance = std::numeric_limits<double>::infinity();
  /// Whether the field keeps what it needs to answer queries for any point. This takes 0.5 KB per face on small meshes,
  /// and grows with the square root of the number of faces where the surface is smooth (3 KB at 80,000 faces). Without
  /// it only vertices have distances.
  bool keep_windows = false;
  /// For each vertex the distance that is already known, from sources which are not given here; infinity if nothing is
  /// known. An empty list means that nothing is known. It may be used with exact windows only. Paths that reach a
  /// vertex later than its known distance end there, so that only places to which the given sources are nearest, and
  /// their surroundings, cost work. A vertex to which no given source is nearer keeps its known distance. Its
  /// vertex_sources is the number of sources, one past the last, and so is the source of its FaceArrival. Elsewhere the
  /// field is right only where the given sources are the nearest.
  std::span<const double> known_distances = {};
};

/// The distance of each point from the nearest of several sources. Fields are immutable and may be shared by threads.
class GeodesicField {
 public:
  struct Data;
  explicit GeodesicField(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

  /// The distance of each vertex; infinity if it is unreached.
  const std::vector<double>& vertex_distances() const;
  /// The distance of any point. O(windows of the face), about a microsecond. Throws "field.not_kept" if the field was
  /// computed without keep_windows.
  double distance(const SurfacePoint& point) const;
  /// The shortest path from the nearest source to `point`, with everything that `options` asks for. Throws the same.
  Geodesic geodesic(const SurfacePoint& point, const GeodesicOptions& options = {}) const;
  /// The index of the source that is nearest to the point; -1 if the point is unreached. Throws the same.
  int nearest_source(const SurfacePoint& point) const;

  /// The source that is nearest to each vertex, or one of them if there are several; -1 if the vertex is unreached.
  /// Throws "field.not_kept" if windows were not kept.
  const std::vector<std::int32_t>& vertex_sources() const;
  /// Writes the bundles of paths that reach a face into `arrivals`, which is cleared first. The distance of any point
  /// of the face, including its border, is the least length_to() of them. Some bundles are nowhere the shortest. With
  /// an edge_graph these are the paths by the corners and those from sources in the face. O(their number). Throws the
  /// same.
  void arrivals(FaceId face, std::vector<FaceArrival>& arrivals) const;
  /// The start of a path to `place`, a point of the face's plane. The path belongs to bundle number `arrival` of
  /// arrivals(face) and must not turn within the face. O(edges crossed), some tens of nanoseconds each. Throws
  /// "field.not_kept" if windows were not kept, which is always so for an edge_graph.
  PathStart start_of_path(FaceId face, std::size_t arrival, const Eigen::Vector2d& place) const;
  /// Whether any path from the sources, even one that is not the shortest, reaches the face or one of its corners. O(1)
  /// plus the number of sources in the face. Throws the same.
  bool reaches(FaceId face) const;

  /// A guaranteed bound on the relative error of every distance; NaN if the method gives none (edge_graph).
  double relative_error_bound() const;
  std::int64_t window_count() const;
  std::int64_t memory_bytes() const;

 private:
  std::shared_ptr<const Data> data_;
};

}  // namespace supple::surface
