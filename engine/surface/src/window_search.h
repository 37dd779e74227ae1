#pragma once

#include <Eigen/Core>
#include <array>
#include <bit>
#include <limits>
#include <span>
#include <vector>

#include "bucket_queue.h"
#include "edge_frames.h"
#include "supple/base/execution.h"
#include "supple/base/large_page_allocator.h"
#include "supple/surface/surface_point.h"
#include "window.h"
#include "window_log.h"

namespace supple::surface {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The best known path to a vertex. One cache line.
struct alignas(64) VertexRecord {
  double sigma = 0;  ///< distance of the pseudo-source, as in a Window
  /// The pseudo-source in the frame of `halfedge`, as in a Window.
  double source_x = 0;
  double depth = 0;
  double crossing = 0;          ///< coordinate at which the path crosses `halfedge`, if a window covers the vertex
  Trail trail = Trail::none();  ///< trail of the window that covers the vertex; none() without one
  std::int32_t halfedge = -1;   ///< the halfedge whose apex the vertex is; -1 for a path along an edge
  std::int32_t origin = -1;     ///< pseudo-source: a vertex, or -1 - i for the i-th source
  std::int32_t along = -1;      ///< halfedge of the edge along which the path arrives; -1 for other paths
  BucketQueue::Bucket queued = BucketQueue::kNotQueued;
  /// Whether the vertex emits windows: it bends paths, or replaces windows that an allowed error has dropped.
  bool emits = false;
  bool emits_all_around = false;  ///< the vertex emits windows in all directions
  bool emitted = false;           ///< the windows that continue this path have been emitted
  std::int32_t ties = -1;         ///< first TiedArrival of a vertex that emits windows; -1 for none
};
static_assert(sizeof(VertexRecord) == 64);

/// Another path to a vertex that emits windows, about as short as the recorded one and from another direction. It tells
/// whether paths by the vertex are unique. WindowSearch::note_tie says why the vertex may have to continue it too.
struct TiedArrival {
  double angle;       ///< angle of arrival in radians, counted as SearchMesh::polar_angle
  double length;      ///< length of the path
  bool emitted;       ///< the windows that continue it have been emitted
  std::int32_t next;  ///< index of the next tied arrival of the same vertex; -1 for none
};

/// How a path reaches a target.
struct Arrival {
  enum class Kind { none, direct, window, vertex, near_vertex } kind = Kind::none;
  double length = kInfinity;
  std::int32_t vertex = -1;
  std::int32_t source = -1;  ///< for direct arrivals and those near a vertex
  // For arrivals by a window: the halfedge at which it was queued, its trail, and where the path crosses the edge.
  std::int32_t halfedge = -1;
  std::int32_t origin = -1;  ///< as in a Window
  Trail trail = Trail::none();
  double crossing = 0;
  /// Preference among paths of equal length: 0 straight, 1 by a vertex that can bend paths, 2 bent at a window's end,
  /// which only approximates another path, 3 by another vertex.
  int rank = 0;
  /// The unfolded pseudo-source relative to the target, in the planar frame of side 0 of the target's face. For a
  /// target at a vertex, angles around the vertex are scaled to SearchMesh::turn_of_images.
  Eigen::Vector2d image = Eigen::Vector2d::Zero();
  /// The vertex at which the path is bent, in the coordinates of `image`; zero unless that vertex can bend paths.
  Eigen::Vector2d bend = Eigen::Vector2d::Zero();
};

/// A point whose distance is wanted, and what the search has found for it.
struct SearchTarget {
  SurfacePoint point;
  std::int32_t vertex = -1;               ///< the vertex on which the point lies exactly; -1 for none
  std::array<Eigen::Vector2d, 3> planar;  ///< the point in the frames of the three sides of its face
  Eigen::Vector3d position;
  Arrival best;
  double competing_length = kInfinity;  ///< length of the shortest path found with another image
};

/// The vertex of the point's face with the largest barycentric coordinate.
std::int32_t nearest_corner(const TriangleMesh& mesh, const SurfacePoint& point);
/// Vector to the point from a vertex of its face. It is computed from barycentric coordinates, and accurate relative to
/// its own length.
Eigen::Vector3d offset_from(const TriangleMesh& mesh, const SurfacePoint& point, std::int32_t vertex);
/// The point, or the vertex of its face from which rounding cannot distinguish it.
SurfacePoint rounded_to_vertex(const SurfacePoint& point);
SearchTarget make_target(const SearchMesh& mesh, const SurfacePoint& point);
/// Angle in radians at which the recorded path arrives at the vertex, counted as SearchMesh::polar_angle.
double arrival_angle(const SearchMesh& mesh, const VertexRecord& record, std::int32_t vertex);
/// Updates the target with the path by a corner of its face, whose distance and record are given. If the target is a
/// vertex, only that vertex's own record counts.
void update_by_vertex(const SearchMesh& mesh, SearchTarget& target, int corner, double distance,
                      const VertexRecord& record);
/// Updates the target with the path through a window of halfedge `h`.
void update_by_window(const SearchMesh& mesh, std::span<const SurfacePoint> sources, SearchTarget& target,
                      std::int32_t h, const Window& window);
/// Updates the target with the straight path from a source in its face or on an edge of it.
void update_by_direct_path(const SearchMesh& mesh, SearchTarget& target, const SurfacePoint& source, int source_index);
/// Finds the target's best path without a search if the target and a source lie close to the same vertex in different
/// faces. Returns whether it has found one. Among several such sources the nearest one counts, and only if no source
/// further from the vertex can be nearer to the target.
bool arrive_near_vertex(const SearchMesh& mesh, std::span<const SurfacePoint> sources, SearchTarget& target);
/// Length of the last straight segment of the recorded path.
double last_segment_length(const SearchMesh& mesh, const VertexRecord& record);
/// Updates the target's best arrival and its competing length with an arrival whose image is set.
void update_target(SearchTarget& target, const Arrival& arrival);

/// The (pseudo-)source `origin` of a window that comes straight from it, in the frame of the halfedge `h` where the
/// window arrives. The search uses the same numbers.
WindowSource first_source(const SearchMesh& mesh, std::span<const SurfacePoint> sources, std::int32_t origin,
                          std::int32_t h);

struct SearchSettings {
  bool goal_directed = false;  ///< there is exactly one target, and only its distance matters
  bool keep_windows = false;   ///< every processed window is logged, for take_logged_windows
  double relative_error = 0;
  double limit = kInfinity;  ///< distances beyond it need not be found
  /// For goal_directed: exact distance of each vertex from a landmark, a point near the target; empty for none.
  std::span<const double> landmark = {};
  double landmark_distance = 0;  ///< distance of the landmark from the target, or more
  /// Distance of each vertex from sources that are not part of this search, infinity where unknown; empty for none. A
  /// vertex that no source of this search improves keeps it, and its origin is the source after the last.
  std::span<const double> known_distances = {};
};

/// Maximum bytes that an ended search retains of each buffer that grows with its work: pending windows, trails, logged
/// windows, queue. Searches of a few milliseconds, of which there are many, need less and therefore allocate nothing.
inline constexpr std::size_t max_retained_buffer_bytes = std::size_t{4} << 20;

/// A path may turn at a saddle vertex if the angle on either side is at least pi. Rays within this angle (radians) of
/// that limit are emitted too, so that no gap opens beside the windows that pass the vertex. A sector without any other
/// width emits nothing: the path goes straight on, in a window of its own.
inline constexpr double kSectorTolerance = 1e-13;

/// The search goes on past the best known length by this relative amount, so that it finds paths of equal length.
inline constexpr double kTieTolerance = 1e-9;

/// One continuous Dijkstra search [Mitchell1987] with all its state, which can be used again. Records carry the number
/// of the search that wrote them (`epoch`), so that a new search clears nothing.
///
/// The queue holds halfedges and vertices, never single windows. When a halfedge is popped, all windows that are
/// pending at it are trimmed to their lower envelope and propagated through its face at once. When a saddle or boundary
/// vertex is popped, it emits windows into the angles to which a shortest path may turn. The order decides only how
/// much work is wasted: windows that improve on earlier ones may come at any time.
class WindowSearch {
 public:
  explicit WindowSearch(const SearchMesh& mesh);

  void run(std::span<const SurfacePoint> sources, std::span<SearchTarget> targets, const SearchSettings& settings,
           const Execution& execution);

  const SearchMesh& mesh() const { return *mesh_; }
  /// The label by which the search orders vertices: the distance, infinity where unreached. With an allowed error e it
  /// is the least sigma + |S - v|, where the sigma of a vertex that emits windows is the length of its path over 1 + e.
  double distance(std::int32_t vertex) const {
    // The choice between integers needs no branch, which would be hard to predict.
    const Distance& d = distances_[vertex];
    const auto bits = std::bit_cast<std::uint64_t>(d.value);
    return std::bit_cast<double>(d.epoch == epoch_ ? bits : std::bit_cast<std::uint64_t>(kInfinity));
  }
  /// Length of the path that the record of a reached vertex describes. It is at most 1 + e times the distance.
  double length_of_path(std::int32_t vertex) const {
    return distances_[vertex].value + settings_.relative_error * vertices_[vertex].sigma;
  }
  /// One record for each vertex. Those that the search did not reach are out of date.
  const VertexRecord* records() const { return vertices_.data(); }
  /// The full trails to which the trails of windows and records refer.
  std::span<const Trail> trails() const { return trails_; }
  /// The tied arrivals to which records refer.
  std::span<const TiedArrival> ties() const { return ties_; }
  /// Moves what point queries need to the caller: the records of all vertices, the logged windows with true lengths,
  /// sorted by halfedge, and in `first` the index of each halfedge's first window, and the end.
  void take_logged_windows(std::vector<VertexRecord>& records, LargeVector<Window>& windows,
                           std::vector<std::int32_t>& first);
  /// Discards the last search, whose results must have been read, and frees large buffers. To be called after every
  /// search, even after a cancelled one.
  void give_back_memory();
  /// Bytes of the buffers that grow with a search. memory_bytes adds the arrays of the mesh's size.
  std::size_t buffer_bytes() const;
  std::size_t memory_bytes() const;
  std::int64_t windows_created() const { return windows_created_; }
  std::int64_t batches() const { return batches_; }
  std::span<const SurfacePoint> sources() const { return sources_; }

 private:
  struct HalfedgeRecord {
    std::int32_t pending;  ///< pool index of the first pending window; -1 for none
    std::int32_t logged;   ///< number of logged windows
    std::uint32_t epoch;
    BucketQueue::Bucket queued;
  };
  struct Distance {
    double value;
    std::uint32_t epoch;
  };
  /// An element of the list of targets in a face.
  struct TargetLink {
    std::int32_t target;
    std::int32_t next;  ///< the next link of the same face; -1 for none
  };
  struct FaceRecord {
    std::uint32_t epoch;
    std::int32_t first_link;
  };

  [[gnu::always_inline]] HalfedgeRecord& halfedge_record(std::int32_t h);
  VertexRecord& vertex_record(std::int32_t v);
  void update_by_corners(SearchTarget& target);
  void start(std::span<const SurfacePoint> sources, std::span<SearchTarget> targets, const SearchSettings& settings);
  void register_target(std::int32_t face, std::int32_t target);
  template <typename Visit>
  void visit_targets(std::int32_t face, Visit visit) {
    if (faces_[face].epoch != epoch_) return;
    for (std::int32_t i = faces_[face].first_link; i >= 0; i = target_links_[i].next)
      visit(targets_[target_links_[i].target]);
  }
  /// Whether every target is certain: no path that is still to be found can be shorter than its best one.
  bool all_certain();

  void emit_from_source(std::int32_t index);
  void emit_from_vertex(std::int32_t v);
  /// Emits windows into the sector behind the vertex, for a path that arrives at angle `arrival`. What other arrivals
  /// have covered is left out. `recorded` is the angle of the recorded path.
  void emit_behind(std::int32_t v, double arrival, double recorded);
  /// Emits a window through the part [low, high] of a corner's angle, and improves the neighbours at those ends of the
  /// corner that the part reaches.
  void emit_through(std::int32_t v, const FanCorner& corner, double low, double high);
  /// Improves the corners of a face with a source in it, and emits a window across each side but `entered_through`, on
  /// which the source lies. `planar` is the source in the frames of the three sides.
  void emit_into_face(std::int32_t face, const std::array<Eigen::Vector2d, 3>& planar, std::int32_t origin,
                      int entered_through);
  /// Records a path to the vertex if it is better than the recorded one. `straight` is false for a path that bends at
  /// an end of its window. Returns whether the path is recorded and shorter than the one before.
  bool improve_vertex(std::int32_t v, double distance, double sigma, double source_x, double depth,
                      std::int32_t halfedge, Trail trail, std::int32_t origin, std::int32_t along, double crossing = 0,
                      bool straight = true);
  /// With an allowed error e: makes the vertex a pseudo-source whose sigma is the length of its path over 1 + e. A path
  /// that restarts there has not been charged for the error that it may still make, so that errors do not add up:
  /// D(x) = (1 + e) sigma + |S - x| <= (1 + e) (sigma + |S - x|), and the search minimizes the right-hand side.
  void make_pseudo_source(std::int32_t v);
  /// Notes a tie if `path` is as short as the recorded path to a vertex that emits windows, and comes from another
  /// direction. What is noted is `path`, or the recorded path if `path` replaces it. The vertex then continues both.
  /// Returns whether it has windows to emit.
  ///
  /// Why no shortest path is lost, although lengths are rounded: let P be a shortest path to a point y.
  ///
  /// 1. A window is cut in favour of a vertex only where the path by the vertex is shorter by kDropTolerance, which is
  ///    far more than the rounding of lengths. P would not be shortest there. So no cut removes P.
  /// 2. A window w that holds P may be trimmed in favour of another window c where both are equal up to rounding. The
  ///    path by c to the point where P crosses the edge, and then along P, is as long as P up to rounding, and the rays
  ///    of c have nearly the direction of P. Where w and c divide an edge, their rays cross beyond it, so that no gap
  ///    opens between them. Therefore c holds a path to y that is as short, or y lies beyond an end of c. If c was
  ///    trimmed at that end, the same holds for the window in whose favour this was done. If c has passed beside a
  ///    vertex v at that end, v emits windows into the region beyond it, behind the path that has come to v by c.
  /// 3. That path is longer than the recorded path to v by kDropTolerance at most, since otherwise v would have cut c,
  ///    which step 1 excludes. But it need not be the recorded one. Paths whose lengths differ by one part in 10^12 may
  ///    come from directions that differ by 10^-6 radians, because a chord past a corner saves only the square of the
  ///    angle. Behind the recorded path, v then emits nothing into the part where y lies: the angle there falls short
  ///    of pi.
  ///
  /// Therefore v emits windows behind every path that ties with the recorded one up to the tolerance of cuts. Each of
  /// these paths has a sector behind it, and only what the sectors of the others leave out is emitted.
  bool note_tie(std::int32_t v, const VertexRecord& path, double length, bool replaces);
  void queue_vertex(std::int32_t v, VertexRecord& record);
  void queue_halfedge(std::int32_t h, HalfedgeRecord& record, double key);

  void process(std::int32_t h);
  /// Sorts the windows of a large batch by their beginnings, and trims each to the part where it is the shortest.
  /// Overlaps of at most `touching` stay. O(n log n), even if all windows overlap.
  void trim_large_batch(double touching);
  /// Appends a full trail to the list, and returns an empty trail that continues it.
  Trail continued(Trail full);
  /// The edge by which a batch of windows enters a face, and the opposite corner. The copy spares reading the frame
  /// again after every window that is written.
  struct Entrance {
    std::int32_t halfedge, apex;
    double length, apex_x, apex_y;
  };
  /// One of the two edges by which a batch of windows leaves a face.
  struct Exit {
    std::int32_t halfedge;  ///< halfedge at which they arrive in the next face; -1 on the boundary
    double length;
    double ux, uy;                      ///< EdgeFrame::left_direction or right_direction
    double tail, head;                  ///< drop_threshold of its end vertices
    double key;                         ///< least key of the windows that have left by it
    double tail_to_goal, head_to_goal;  ///< lower bounds of its ends' distances to the goal
    Eigen::Vector2d goal;               ///< goal_in_frame of the edge, in goal-directed searches
    std::int32_t pending;               ///< first pending window of the halfedge; new ones are put before it
  };
  Exit exit_towards(std::int32_t halfedge, std::int32_t tail, std::int32_t head, double length,
                    EdgeFrame::Direction direction);
  /// Propagates a window through its face to both exits. A `plain` search has no goal, no allowed error and no limit to
  /// test for. With `near_vertices` (see near_vertices_), windows overlap at the ends of edges.
  template <bool plain, bool near_vertices>
  void propagate(const Window& window, const Entrance& entrance, Exit& left, Exit& right);
  /// Cuts a new window against the vertices of its edge, and adds what no bound excludes to the exit.
  template <bool plain>
  [[gnu::always_inline]] void admit(Window& window, Exit& exit);
  /// Hands the windows of an exit over to its halfedge, and queues the halfedge.
  void queue_exit(const Exit& exit);
  /// Cuts a window with an allowed error. Vertices that take over a part of it emit windows of their own. Returns
  /// whether anything is left.
  bool cut_within_error(Window& window, std::int32_t halfedge);
  /// Admits a window that comes straight from a (pseudo-)source and arrives at `halfedge`, and queues the halfedge.
  void admit_first(Window& window, std::int32_t halfedge);
  /// Distance of an end of an edge of the given length, plus the excess at which a window is dropped in favour of that
  /// vertex. Near a source the distance is tiny, and the excess covers the rounding of the edge's length.
  double drop_threshold(std::int32_t vertex, double length) const {
    return distance(vertex) * (1 + kDropTolerance) + kEdgeRounding * length;
  }
  /// Whether lengths of paths to a vertex are so close that both count as shortest.
  bool both_shortest(double a, double b) const { return std::abs(a - b) <= kTieTolerance * a + edge_rounding_; }
  /// Whether lengths of paths to a vertex differ by less than the excess at which windows are dropped in its favour.
  bool within_drop_tolerance(double a, double b) const {
    return std::abs(a - b) <= kDropTolerance * a + edge_rounding_;
  }
  /// Vector from a vertex to the goal. Unlike the goal's position, it has all its digits if the goal is next to the
  /// vertex.
  Eigen::Vector3d vector_to_goal(std::int32_t vertex) const {
    return (goal_corner_ - mesh_->mesh->positions()[vertex]) + goal_offset_;
  }
  /// Largest key that matters for a target whose best known length is given, with allowances for ties and rounding.
  double max_useful_key(double length) const;
  /// The goal, rotated about the edge into the plane of the next face. Its distance from a point of the edge is the
  /// distance in space, a lower bound of a path's length.
  Eigen::Vector2d goal_in_frame(std::int32_t tail, std::int32_t head, double length) const;
  [[gnu::always_inline]] std::int32_t allocate();
  /// Lower bound of a vertex's distance to the goal by the landmark; -infinity without one.
  double min_distance_to_goal(std::int32_t vertex) const {
    return settings_.landmark.empty() ? -kInfinity : settings_.landmark[vertex] - settings_.landmark_distance;
  }
  /// Lower bound of the length of a path through the window to the goal.
  double goal_key(const Window& window, const Exit& exit) const;
  void report_progress(const Execution& execution) const;
  /// Prefetches what the next batches need.
  void prefetch() const;
  /// Returns a slot to the pool.
  void release(std::int32_t window);

  const SearchMesh* mesh_;
  std::vector<HalfedgeRecord> halfedges_;
  std::vector<Distance> distances_;  ///< separate from the records, because every window reads them
  std::vector<VertexRecord> vertices_;
  LargeVector<Window> pool_;  ///< the pending windows of all halfedges, and free slots
  std::int32_t first_free_ = -1;
  std::vector<Trail> trails_;
  WindowLog logged_;
  BucketQueue queue_;
  std::vector<FaceRecord> faces_;  ///< the targets of this search in each face
  std::uint32_t epoch_ = 0;

  std::vector<SurfacePoint> sources_;
  std::span<SearchTarget> targets_;
  std::vector<TargetLink> target_links_;
  std::vector<TiedArrival> ties_;
  SearchSettings settings_;
  bool plain_ = true;
  bool records_trails_ = false;      ///< paths will be asked for, and not only distances
  bool near_vertices_ = false;       ///< a (pseudo-)source may be much closer to a vertex than its edges are long
  double edge_rounding_ = 0;         ///< kEdgeRounding times the longest edge
  double max_key_ = kInfinity;       ///< larger keys are of no use
  std::size_t first_uncertain_ = 0;  ///< the targets before this one are certain
  Eigen::Vector3d goal_corner_ = Eigen::Vector3d::Zero();  ///< position of the goal's nearest_corner
  Eigen::Vector3d goal_offset_ = Eigen::Vector3d::Zero();  ///< vector from that corner to the goal
  const CancellationToken* cancellation_ = nullptr;        ///< token of the current run
  std::vector<std::int32_t> batch_;                        ///< pool indices of the windows that are processed together
  std::vector<std::int32_t> remaining_;                    ///< the windows of a large batch that trimming has left
  std::int64_t windows_created_ = 0;
  std::int64_t batches_ = 0;
  std::int64_t vertices_reached_ = 0;
};

inline WindowSearch::HalfedgeRecord& WindowSearch::halfedge_record(std::int32_t h) {
  HalfedgeRecord& record = halfedges_[h];
  if (record.epoch != epoch_) record = {-1, 0, epoch_, BucketQueue::kNotQueued};
  return record;
}

inline std::int32_t WindowSearch::allocate() {
  ++windows_created_;
  if (first_free_ >= 0) {
    const std::int32_t i = first_free_;
    first_free_ = pool_[i].link;
    return i;
  }
  pool_.emplace_back();
  return static_cast<std::int32_t>(pool_.size()) - 1;
}

}  // namespace supple::surface
