#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "supple/surface/face_arrival.h"
#include "supple/surface/geodesic.h"

namespace supple::surface {

enum class FieldMethod {
  windows,    ///< window propagation: exact, or within (1 + relative_error) of exact where that is positive
  edge_graph  ///< Dijkstra's algorithm over edges and across pairs of faces: an upper bound, the cheapest
};

struct FieldOptions {
  FieldMethod method = FieldMethod::windows;
  /// Allowed relative error of every distance, >= 0. A guarantee, not an estimate; 0 is exact.
  double relative_error = 0;
  /// Distances beyond this need not be found (they are reported as unreached). Mesh units.
  double max_distance = std::numeric_limits<double>::infinity();
  /// Keep what answers queries for any point (0.5 KB per face on small meshes, growing like the square
  /// root of the faces where the surface is smooth: 3 KB at 80,000); without it only vertices have distances.
  bool keep_windows = false;
  /// Of each vertex a distance that is known already, that of sources which are left out here, infinity where nothing
  /// is known; empty for none. Of windows with no allowed error. Paths that reach a vertex later than this end there,
  /// so that only places that the sources are nearest to, and their surroundings, cost work. Vertices that no source is
  /// nearer to keep this distance; their vertex_sources is the number of sources, one past the last, and so is that of
  /// their FaceArrival. Elsewhere the field is only right where these sources are the nearest.
  std::span<const double> known_distances = {};
};

/// The distances from a set of sources, each point's to the nearest. Immutable; may be shared between threads.
class GeodesicField {
 public:
  struct Data;
  explicit GeodesicField(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

  /// Distance at each vertex; infinity where unreached.
  const std::vector<double>& vertex_distances() const;
  /// Distance at any point. O(windows of the face), about a microsecond. Throws Error "field.not_kept" if the field was
  /// computed without keep_windows.
  double distance(const SurfacePoint& point) const;
  /// The shortest path from the nearest source to `point`, with what `options` asks for. Same errors.
  Geodesic geodesic(const SurfacePoint& point, const GeodesicOptions& options = {}) const;
  /// Index of the source that the point is nearest to; -1 where unreached. Same errors.
  int nearest_source(const SurfacePoint& point) const;

  /// The source that each vertex is nearest to, of several one; -1 where unreached. Throws "field.not_kept" for windows
  /// that were not kept.
  const std::vector<std::int32_t>& vertex_sources() const;
  /// The bundles of paths that reach a face, into `arrivals`, which is cleared: the distance at any point of the face,
  /// its border included, is the least length_to() of them. Some are nowhere the shortest. Of an edge_graph these are
  /// the ways by the corners and those from sources in the face. O(their number). Same error.
  void arrivals(FaceId face, std::vector<FaceArrival>& arrivals) const;
  /// Whether any path from the sources reaches the face or one of its corners, one that is not the shortest too. O(1),
  /// but for the sources in the face. Same error.
  bool reaches(FaceId face) const;

  /// Guaranteed bound on the relative error of every distance; NaN where the method gives none (edge_graph).
  double relative_error_bound() const;
  std::int64_t window_count() const;
  std::int64_t memory_bytes() const;

 private:
  std::shared_ptr<const Data> data_;
};

}  // namespace supple::surface
