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

/// How the best known path reaches a vertex. One cache line.
struct alignas(64) VertexRecord {
  double sigma = 0;  ///< of the pseudo-source, as in a Window
  double source_x = 0;
  double depth = 0;             ///< the pseudo-source in the frame of `halfedge`, as in a Window
  double crossing = 0;          ///< where the path crosses `halfedge`, if a window covers the vertex
  Trail trail = Trail::none();  ///< of the window that covers the vertex, unknown if none
  std::int32_t halfedge = -1;   ///< whose apex the vertex is; -1 for a path along an edge
  std::int32_t origin = -1;     ///< pseudo-source: a vertex, or -1 - i for the i-th source
  std::int32_t along = -1;      ///< halfedge with the vertex at one end when the path runs along an edge, else -1
  BucketQueue::Bucket queued = BucketQueue::kNotQueued;
  bool emits = false;  ///< sends out windows: pins paths, or stands in for windows that an allowed error has dropped
  bool everywhere = false;  ///< does so in all directions
  bool sent = false;        ///< the windows that continue this path are on their way
  std::int32_t ties = -1;   ///< first TiedArrival of a vertex that sends out windows; -1 for none
};
static_assert(sizeof(VertexRecord) == 64);

/// Another path to a vertex that sends out windows than the recorded one, from another direction and about as short: it
/// tells whether paths by the vertex are unique. WindowSearch::note_tie says why the vertex may have to continue it
/// too.
struct TiedArrival {
  double angle;       ///< under which it arrives, counted as SearchMesh::polar_angle
  double length;      ///< of the path
  bool sent;          ///< the windows that continue it are on their way
  std::int32_t next;  ///< of the same vertex, -1 for none
};

/// How a path reaches a target.
struct Arrival {
  enum class Kind { none, direct, window, vertex, near_vertex } kind = Kind::none;
  double length = kInfinity;
  std::int32_t vertex = -1;
  std::int32_t source = -1;  ///< for direct arrivals and those near a vertex
  // Of arrivals by a window: the halfedge at which it waited, how it came there, and where the path crosses.
  std::int32_t halfedge = -1;
  std::int32_t origin = -1;  ///< as in a Window
  Trail trail = Trail::none();
  double crossing = 0;
  /// Prefers, of ways of equal length, straight ones (0), then those by a vertex (1), then those bent at a window's
  /// end, which only approach one of the others (2).
  int rank = 0;
  /// The unfolded pseudo-source relative to the target: in the planar frame of side 0 of the target's face, or, for a
  /// target at a vertex, in polar coordinates whose full turn is the vertex's total angle.
  Eigen::Vector2d image = Eigen::Vector2d::Zero();
  /// Of a path that is bent at a vertex which can hold it: that vertex, as `image` gives the source; else zero.
  Eigen::Vector2d bend = Eigen::Vector2d::Zero();
};

/// A point whose distance is wanted, and what the search finds of it.
struct SearchTarget {
  SurfacePoint point;
  std::int32_t vertex = -1;               ///< the vertex that the point lies on exactly
  std::array<Eigen::Vector2d, 3> planar;  ///< the point in the frames of the three sides of its face
  Eigen::Vector3d position;
  Arrival best;
  double competing_length = kInfinity;  ///< shortest length met of a path with another image
};

/// The vertex of its face that the point is nearest to, by barycentric coordinates.
std::int32_t nearest_corner(const TriangleMesh& mesh, const SurfacePoint& point);
/// Vector from a vertex of its face to the point, from barycentric coordinates: accurate relative to its own length.
Eigen::Vector3d offset_from(const TriangleMesh& mesh, const SurfacePoint& point, std::int32_t vertex);
/// The point, or the vertex that it cannot be told from.
SurfacePoint snapped(const SurfacePoint& point);
SearchTarget make_target(const SearchMesh& mesh, const SurfacePoint& point);
/// Angle around its vertex at which the recorded path arrives, counted as SearchMesh::polar_angle.
double arrival_angle(const SearchMesh& mesh, const VertexRecord& record, std::int32_t vertex);
/// Offers the way by a corner of the target's face, or, where the target is a vertex, that vertex's own record.
void offer_vertex(const SearchMesh& mesh, SearchTarget& target, int corner, double distance,
                  const VertexRecord& record);
/// Offers a window of halfedge `h` as a way to the target.
void offer_window(const SearchMesh& mesh, std::span<const SurfacePoint> sources, SearchTarget& target, std::int32_t h,
                  const Window& window);
/// Offers the straight way from a source in the same face, or in a face that shares the edge on which the source lies.
void offer_direct(const SearchMesh& mesh, SearchTarget& target, const SurfacePoint& source, int source_index);
/// Where the target and a source lie close to the same vertex in different faces, makes the path between them, which
/// is then known without a search, the target's best and returns true. Of several sources the nearest is taken, if none
/// further from the vertex can be nearer to the target.
bool arrive_near_vertex(const SearchMesh& mesh, std::span<const SurfacePoint> sources, SearchTarget& target);
/// Length of the last straight piece of the recorded path.
double last_piece(const SearchMesh& mesh, const VertexRecord& record);
/// Offers an arrival whose image is set.
void offer(SearchTarget& target, const Arrival& arrival);

/// The (pseudo-)source of a window that has just left it and arrives at halfedge `h`: what the search began with there.
WindowSource first_source(const SearchMesh& mesh, std::span<const SurfacePoint> sources, std::int32_t origin,
                          std::int32_t h);

struct SearchSettings {
  bool goal_directed = false;  ///< exactly one target, only its distance matters
  bool keep_windows = false;   ///< every processed window is logged, for take_kept
  double relative_error = 0;
  double limit = kInfinity;  ///< distances beyond need not be found
  /// With goal_directed: exact distance of each vertex from a point near the target, and that point's from the target.
  std::span<const double> landmark = {};
  double landmark_distance = 0;
  /// Of each vertex the distance from sources that are left out, infinity where unknown; empty for none. Vertices that
  /// no source improves have it still, and as their origin the source after the last.
  std::span<const double> known = {};
};

/// A search that ends keeps at most this many bytes of each buffer that has grown with its work (windows that wait,
/// trails, windows on their way into a field, queue): enough for whatever takes a few milliseconds, so that short
/// searches, of which there are many, allocate nothing.
inline constexpr std::size_t kMostKept = std::size_t{4} << 20;

/// A path may turn at a saddle vertex if both sides measure pi; rays within this angle (radians) of the limit are sent
/// too, so that nothing is lost between them and the windows that pass by. A sector of no more than that on both sides
/// is none: the path goes straight on, in a window of its own.
inline constexpr double kSectorTolerance = 1e-13;

/// The search goes on past the best known length by this much, relative, so that ties are seen.
inline constexpr double kTieTolerance = 1e-9;

/// One continuous-Dijkstra search with all its state, reusable: a search marks what it touches with its number, so that
/// starting one clears nothing.
///
/// The queue holds halfedges and vertices, never single windows. A popped halfedge takes all windows that wait at it,
/// trims them to their lower envelope and sends what is left through its face at once; a popped saddle or boundary
/// vertex sends windows into the angles that a shortest path may turn to. The order only decides how much work is
/// wasted: windows that improve on earlier ones may come at any time.
class WindowSearch {
 public:
  explicit WindowSearch(const SearchMesh& mesh);

  void run(std::span<const SurfacePoint> sources, std::span<SearchTarget> targets, const SearchSettings& settings,
           const Execution& execution);

  const SearchMesh& mesh() const { return *mesh_; }
  /// What the search orders by: the distance, or with an allowed error e the least sigma + |S - v|, where the sigma of
  /// a vertex that sends windows is its true distance over 1 + e.
  double distance(std::int32_t vertex) const {
    // Selected as integers, because whether a vertex has been reached is hard to predict.
    const Distance& d = distances_[vertex];
    const auto bits = std::bit_cast<std::uint64_t>(d.value);
    return std::bit_cast<double>(d.epoch == epoch_ ? bits : std::bit_cast<std::uint64_t>(kInfinity));
  }
  /// Length of the path that the record of a reached vertex describes: the distance, or at most 1 + e times it.
  double length_of_path(std::int32_t vertex) const {
    return distances_[vertex].value + settings_.relative_error * vertices_[vertex].sigma;
  }
  /// Per vertex; those that the search did not reach are out of date.
  const VertexRecord* records() const { return vertices_.data(); }
  /// The full trails that those of windows and records refer to.
  std::span<const Trail> trails() const { return trails_; }
  /// Those that records refer to.
  std::span<const TiedArrival> ties() const { return ties_; }
  /// What point queries need: records of all vertices, the kept windows with true lengths, and per halfedge where its
  /// windows begin (they end where the next one's begin). Hands the windows over: only the first call gets them.
  void take_kept(std::vector<VertexRecord>& records, LargeVector<Window>& windows, std::vector<std::int32_t>& first);
  /// Forgets the last search, whose answers must have been read, and frees what its buffers hold beyond kMostKept. To
  /// be called after every search, one that was cancelled too.
  void give_back_memory();
  /// What the buffers hold that grow with a search, and all arrays of the size of the mesh besides.
  std::size_t buffer_bytes() const;
  std::size_t memory_bytes() const;
  std::int64_t windows_created() const { return windows_created_; }
  std::int64_t batches() const { return batches_; }
  std::span<const SurfacePoint> sources() const { return sources_; }

 private:
  struct HalfedgeRecord {
    std::int32_t pending;  ///< pool index of the first window that waits
    std::int32_t kept;     ///< number of logged windows
    std::uint32_t epoch;
    BucketQueue::Bucket queued;
  };
  struct Distance {
    double value;
    std::uint32_t epoch;
  };
  struct Hook {
    std::int32_t target;
    std::int32_t next;  ///< the next hook in the same face
  };
  struct FaceRecord {
    std::uint32_t epoch;
    std::int32_t hook;
  };

  [[gnu::always_inline]] HalfedgeRecord& halfedge_record(std::int32_t h);
  VertexRecord& vertex_record(std::int32_t v);
  void offer_corners(SearchTarget& target);
  void start(std::span<const SurfacePoint> sources, std::span<SearchTarget> targets, const SearchSettings& settings);
  void hook(std::int32_t face, std::int32_t target);
  template <typename Visit>
  void visit_targets(std::int32_t face, Visit visit) {
    if (faces_[face].epoch != epoch_) return;
    for (std::int32_t i = faces_[face].hook; i >= 0; i = hooks_[i].next) visit(targets_[hooks_[i].target]);
  }
  /// Whether every target is certain: no path still to be found can be shorter than what is known.
  bool settled();

  void emit_from_source(std::int32_t index);
  void emit_from_vertex(std::int32_t v);
  /// Sends windows to where a path may go that arrives at the vertex under that angle, but for the parts that have been
  /// sent behind other arrivals; `recorded` is the angle of the recorded path.
  void emit_behind(std::int32_t v, double arrival, double recorded);
  /// Sends a window through the part [low, high] of a corner's angle, and distances along the edges that bound it.
  void emit_through(std::int32_t v, const FanCorner& corner, double low, double high);
  /// Distance to the source point and a window across each side of the face; the face's frame sees the source at
  /// `planar` (per side). `entered_through` is skipped: the side that the source lies on.
  void emit_into_face(std::int32_t face, const std::array<Eigen::Vector2d, 3>& planar, std::int32_t origin,
                      int entered_through);
  bool improve_vertex(std::int32_t v, double distance, double sigma, double source_x, double depth,
                      std::int32_t halfedge, Trail trail, std::int32_t origin, std::int32_t along, double crossing = 0,
                      bool straight = true);
  /// With an allowed error e: makes the vertex a source of its own, whose sigma is its true distance over 1 + e. A path
  /// that restarts there has not been charged for the error that it may still make, so errors do not add up:
  /// D(x) = (1 + e) sigma + |S - x| <= (1 + e) (sigma + |S - x|), which the search makes least.
  void become_source(std::int32_t v);
  /// Where `path` is as short as the recorded path to a vertex that sends out windows, and comes from another
  /// direction: notes whichever is not going to be the recorded one (`replaces`: the present one), so that the vertex
  /// continues both. Returns whether there is something to send.
  ///
  /// Why no shortest path is lost, although lengths are rounded: let P be a shortest path to a point y.
  ///
  /// 1. A window is cut in favour of a vertex only if the way by the vertex is shorter by kDropTolerance, which is far
  ///    more than the rounding of lengths. P would then not be shortest. So no cut takes P away.
  /// 2. A window w that holds P may be trimmed in favour of another, c, where both are equal up to rounding. A path
  /// that
  ///    goes on by c as far as P does is as long as P up to rounding, and its rays go nearly the same way. Where w and
  ///    c share an edge, their rays cross beyond it, so that no gap opens between them. c therefore holds a way to y
  ///    that is as short, or one end of c lies between. If that end is where c has been trimmed, the same holds for the
  ///    window that it was trimmed for. If it is where c has passed beside a vertex v, what lies beyond is what v sends
  ///    behind the path that has come to v by c.
  /// 3. This path is not longer than the recorded one by more than kDropTolerance: otherwise v would have cut c,
  /// against
  ///    1. But it need not be the recorded one. Paths whose lengths differ by one part in 10^12 may come from
  ///    directions that differ by 10^-6, because a chord past a corner saves only the square of the angle. Behind the
  ///    recorded path v then has nothing to send into the part where y lies: there the angle falls short of pi.
  ///
  /// So v sends windows behind every path that ties with the recorded one, by the tolerance of cuts. Each of these
  /// paths has a sector behind it, and only what the sectors of the others leave out is sent.
  bool note_tie(std::int32_t v, const VertexRecord& path, double length, bool replaces);
  void queue_vertex(std::int32_t v, VertexRecord& record);
  void queue_halfedge(std::int32_t h, HalfedgeRecord& record, double key);

  void process(std::int32_t h);
  /// Sorts the windows of the batch by where they begin, and cuts each to where it is the shortest: O(n log n), also
  /// where all overlap.
  void trim_many(double touching);
  /// A trail with room for turns after those of a full one, which goes into the list.
  Trail continued(Trail full);
  /// The edge that a batch of windows enters a face by, and the corner opposite: a copy of what the frame says, which
  /// the compiler need not read again whenever a window has been written.
  struct Entrance {
    std::int32_t halfedge, apex;
    double length, apex_x, apex_y;
  };
  /// One of the two edges that windows leave a face by, as a batch of windows sees it.
  struct Exit {
    std::int32_t halfedge;  ///< that they arrive at in the next face, -1 on the boundary
    double length;
    double ux, uy;                      ///< unit direction of that halfedge in the frame of the edge entered by
    double tail, head;                  ///< distances of its ends, allowances included
    double key;                         ///< least key of the windows that have left this way
    double tail_to_goal, head_to_goal;  ///< by the landmark, at least
    Eigen::Vector2d goal;  ///< where the goal-directed search's target lies at best, in the halfedge's frame
    std::int32_t pending;  ///< the halfedge's list, on which new windows are put
  };
  Exit exit_towards(std::int32_t halfedge, std::int32_t tail, std::int32_t head, double length,
                    EdgeFrame::Direction direction);
  /// `plain` searches have no goal, no allowed error and no limit, and are not `close`: their inner loop asks for none.
  template <bool plain, bool close>
  void propagate(const Window& window, const Entrance& entrance, Exit& left, Exit& right);
  /// Cuts a new window against its edge's vertices, and keeps it if anything is left and no bound excludes it.
  template <bool plain>
  [[gnu::always_inline]] void admit(Window& window, Exit& exit);
  /// Hands the windows that left by an exit over to its halfedge, and queues that.
  void leave_by(const Exit& exit);
  /// Cuts with an allowed error: vertices that take over from a window send out windows of their own.
  bool cut_within_error(Window& window, std::int32_t halfedge);
  /// admit for windows that start at a (pseudo-)source and arrive at `halfedge`, and its place in the queue.
  void admit_first(Window& window, std::int32_t halfedge);
  /// Distance of an end of an edge of the given length, with what a window may be longer before it is dropped for it:
  /// near a source the distance is tiny, and the rounding that counts is that of the edge.
  double allowed(std::int32_t vertex, double length) const {
    return distance(vertex) * (1 + kDropTolerance) + kEdgeRounding * length;
  }
  /// Whether lengths of paths to a vertex are so close that both count as shortest.
  bool both_shortest(double a, double b) const { return std::abs(a - b) <= kTieTolerance * a + edge_rounding_; }
  /// Whether lengths of paths to a vertex are equal up to what windows may be longer before they are dropped for it.
  bool within_cut(double a, double b) const { return std::abs(a - b) <= kDropTolerance * a + edge_rounding_; }
  /// Vector from a vertex to the goal. A goal next to the vertex keeps its digits, which its coordinates do not have.
  Eigen::Vector3d goal_from(std::int32_t vertex) const {
    return (goal_corner_ - mesh_->mesh->positions()[vertex]) + goal_offset_;
  }
  /// Keys beyond this do not matter for a target whose best known length is given: they exceed it, rounding included.
  double beyond(double length) const;
  /// The goal turned about the edge into the plane of the next face: no path to it is shorter than to there.
  Eigen::Vector2d goal_in_frame(std::int32_t tail, std::int32_t head, double length) const;
  [[gnu::always_inline]] std::int32_t allocate();
  /// Lower bound, by the landmark, of a vertex's distance to the goal; -infinity without one.
  double to_goal(std::int32_t vertex) const {
    return settings_.landmark.empty() ? -kInfinity : settings_.landmark[vertex] - settings_.landmark_distance;
  }
  /// Lower bound of the length of a path through the window to the goal.
  double goal_key(const Window& window, const Exit& exit) const;
  void report_progress(const Execution& execution) const;
  /// Asks memory for what the next batches need.
  void prefetch() const;
  void release(std::int32_t window);

  const SearchMesh* mesh_;
  std::vector<HalfedgeRecord> halfedges_;
  std::vector<Distance> distances_;  ///< apart from the records, because every window looks them up
  std::vector<VertexRecord> vertices_;
  LargeVector<Window> pool_;  ///< the windows that wait at halfedges
  std::int32_t free_ = -1;
  std::vector<Trail> trails_;
  WindowLog kept_;
  BucketQueue queue_;
  std::vector<FaceRecord> faces_;  ///< which faces have targets in this search
  std::uint32_t epoch_ = 0;

  std::vector<SurfacePoint> sources_;
  std::span<SearchTarget> targets_;
  std::vector<Hook> hooks_;
  std::vector<TiedArrival> ties_;
  SearchSettings settings_;
  bool plain_ = true;
  bool follows_paths_ = false;  ///< somebody will ask how a place was reached, not only how far it is
  bool close_ = false;  ///< some sources or turning vertices may be much closer to a vertex than their edges are long
  double edge_rounding_ = 0;                               ///< kEdgeRounding of the longest edge
  double bound_ = kInfinity;                               ///< keys beyond this are of no use
  std::size_t uncertain_ = 0;                              ///< the targets before this one are certain
  Eigen::Vector3d goal_corner_ = Eigen::Vector3d::Zero();  ///< the corner of its face that the goal lies nearest to
  Eigen::Vector3d goal_offset_ = Eigen::Vector3d::Zero();  ///< of the goal from that corner
  const CancellationToken* cancellation_ = nullptr;        ///< of the run
  std::vector<std::int32_t> batch_;
  std::vector<std::int32_t> left_;  ///< of the batch, while many are trimmed
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
  if (free_ >= 0) {
    const std::int32_t i = free_;
    free_ = pool_[i].link;
    return i;
  }
  pool_.emplace_back();
  return static_cast<std::int32_t>(pool_.size()) - 1;
}

}  // namespace supple::surface
