#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bucket_queue.h"
#include "face_targets.h"
#include "search_goal.h"
#include "supple/base/execution.h"
#include "vertex_table.h"
#include "window_log.h"
#include "window_pool.h"

namespace supple::surface {

struct SearchSettings {
  bool goal_directed = false;  ///< there is exactly one target, and only its distance matters
  bool keep_windows = false;   ///< every processed window is logged, for take_logged_windows
  double relative_error = 0;
  double limit = infinity;  ///< distances beyond it need not be found
  /// For goal_directed: exact distance of each vertex from a landmark, a point near the target; empty for none.
  std::span<const double> landmark = {};
  double landmark_distance = 0;  ///< distance of the landmark from the target, or more
  /// Distance of each vertex from sources that are not part of this search, infinity where unknown; empty for none. A
  /// vertex that no source of this search improves keeps it, and its origin is the source after the last.
  std::span<const double> known_distances = {};
};

/// What a running search has found and what it still has to do: the best paths to vertices and targets, the windows
/// that wait at halfedges, and the queue of those halfedges and vertices. Vertices emit windows (window_emission.h),
/// and halfedges pass theirs on through the next face (WindowPropagation).
struct SearchFront {
  struct HalfedgeRecord {
    std::int32_t pending;  ///< pool index of the first pending window; -1 for none
    std::int32_t logged;   ///< number of logged windows
    std::uint32_t epoch;
    BucketQueue::Bucket queued;
  };

  explicit SearchFront(const SearchMesh& its_mesh);
  /// Begins a new search. Records carry its number (`epoch`), so that nothing is cleared.
  void start(std::span<const SurfacePoint> from, std::span<SearchTarget> to, const SearchSettings& how);

  [[gnu::always_inline]] HalfedgeRecord& halfedge(std::int32_t h) {
    HalfedgeRecord& record = halfedges[h];
    if (record.epoch != epoch) record = {-1, 0, epoch, BucketQueue::not_queued};
    return record;
  }
  /// VertexTable::improve, and queues the vertex if it has windows to emit. Returns whether the path is recorded and
  /// shorter than the one before.
  bool improve_vertex(std::int32_t v, double distance, double sigma, double source_x, double depth,
                      std::int32_t halfedge, Trail trail, std::int32_t origin, std::int32_t along, double crossing = 0,
                      bool straight = true) {
    const auto improvement =
        vertices.improve(v, distance, sigma, source_x, depth, halfedge, trail, origin, along, crossing, straight);
    if (improvement.must_emit) queue_vertex(v);
    return improvement.shorter;
  }
  void queue_vertex(std::int32_t v);
  void queue_halfedge(std::int32_t h, HalfedgeRecord& record, double key);
  /// Admits a window that comes straight from a (pseudo-)source and arrives at `halfedge`, and queues the halfedge.
  void admit_first(Window& window, std::int32_t halfedge);

  const SearchMesh* mesh;
  std::uint32_t epoch = 0;
  SearchSettings settings;
  std::vector<SurfacePoint> sources;
  VertexTable vertices;
  FaceTargets targets;
  SearchGoal goal;  ///< in goal-directed searches
  std::vector<HalfedgeRecord> halfedges;
  WindowPool pool;            ///< the pending windows of all halfedges
  std::vector<Trail> trails;  ///< the full trails to which the trails of windows and records refer
  WindowLog logged;
  BucketQueue queue;            ///< halfedges, and ~v for vertices
  double max_key = infinity;    ///< larger keys are of no use
  bool plain = true;            ///< the search has no goal, no allowed error and no limit to test for
  bool records_trails = false;  ///< paths will be asked for, and not only distances
  bool near_vertices = false;   ///< a (pseudo-)source may be much closer to a vertex than its edges are long
};

}  // namespace supple::surface
