#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "bucket_queue.h"
#include "edge_frames.h"
#include "window.h"

namespace supple::surface {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// A path may turn at a saddle vertex if the angle on either side is at least pi. Rays within this angle (radians) of
/// that limit are emitted too, so that no gap opens beside the windows that pass the vertex. A sector without any other
/// width emits nothing: the path goes straight on, in a window of its own.
inline constexpr double sector_tolerance = 1e-13;

/// The search goes on past the best known length by this relative amount, so that it finds paths of equal length.
inline constexpr double tie_tolerance = 1e-9;

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
  BucketQueue::Bucket queued = BucketQueue::not_queued;
  /// Whether the vertex emits windows: it bends paths, or replaces windows that an allowed error has dropped.
  bool emits = false;
  bool emits_all_around = false;  ///< the vertex emits windows in all directions
  bool emitted = false;           ///< the windows that continue this path have been emitted
  std::int32_t ties = -1;         ///< first TiedArrival of a vertex that emits windows; -1 for none
};
static_assert(sizeof(VertexRecord) == 64);

/// Another path to a vertex that emits windows, about as short as the recorded one and from another direction. It tells
/// whether paths by the vertex are unique. VertexTable::note_tie says why the vertex may have to continue it too.
struct TiedArrival {
  double angle;       ///< angle of arrival in radians, counted as SearchMesh::polar_angle
  double length;      ///< length of the path
  bool emitted;       ///< the windows that continue it have been emitted
  std::int32_t next;  ///< index of the next tied arrival of the same vertex; -1 for none
};

/// The best known paths to all vertices. Records carry the number of the search that wrote them (`epoch`), so that a
/// new search clears nothing.
class VertexTable {
 public:
  /// `mesh` must outlive the table.
  explicit VertexTable(const SearchMesh& mesh);
  /// Begins a search with an allowed relative error. Epochs count from 1; epoch 1 clears all records.
  void start(std::uint32_t epoch, double relative_error);

  /// The label by which the search orders vertices: the distance, infinity where unreached. With an allowed error e it
  /// is the least sigma + |S - v|, where the sigma of a vertex that emits windows is the length of its path over 1 + e.
  double distance(std::int32_t v) const {
    // The choice between integers needs no branch, which would be hard to predict.
    const Distance& d = distances_[v];
    const auto bits = std::bit_cast<std::uint64_t>(d.value);
    return std::bit_cast<double>(d.epoch == epoch_ ? bits : std::bit_cast<std::uint64_t>(infinity));
  }
  /// Length of the path that the record of a reached vertex describes. It is at most 1 + e times the distance.
  double length_of_path(std::int32_t v) const { return distances_[v].value + relative_error_ * records_[v].sigma; }
  /// The record of a vertex of this search. It is empty if nothing has reached the vertex.
  VertexRecord& record(std::int32_t v);
  /// The record of a vertex that this search has reached.
  VertexRecord& reached(std::int32_t v) { return records_[v]; }
  /// One record for each vertex. Those that the search did not reach are out of date.
  const VertexRecord* records() const { return records_.data(); }
  std::size_t size() const { return records_.size(); }
  std::int64_t reached_count() const { return reached_count_; }
  /// The tied arrivals to which records refer.
  const std::vector<TiedArrival>& ties() const { return ties_; }
  std::vector<TiedArrival>& ties() { return ties_; }
  void prefetch_record(std::int32_t v) const { __builtin_prefetch(&records_[v]); }
  void prefetch_distance(std::int32_t v) const { __builtin_prefetch(&distances_[v]); }

  /// Gives the vertex a distance that is known before the search.
  void set_known(std::int32_t v, double distance, std::int32_t origin) {
    record(v).origin = origin;
    distances_[v].value = distance;
  }
  /// What improve() has done.
  struct Improvement {
    bool shorter;    ///< the path is recorded and shorter than the one before
    bool must_emit;  ///< the vertex has windows to emit
  };
  /// Records a path to the vertex if it is better than the recorded one. `straight` is false for a path that bends at
  /// an end of its window.
  Improvement improve(std::int32_t v, double distance, double sigma, double source_x, double depth,
                      std::int32_t halfedge, Trail trail, std::int32_t origin, std::int32_t along, double crossing,
                      bool straight);
  /// With an allowed error e: makes the vertex a pseudo-source whose sigma is the length of its path over 1 + e. A path
  /// that restarts there has not been charged for the error that it may still make, so that errors do not add up:
  /// D(x) = (1 + e) sigma + |S - x| <= (1 + e) (sigma + |S - x|), and the search minimizes the right-hand side.
  void make_pseudo_source(std::int32_t v);

  /// Distance of an end of an edge of the given length, plus the excess at which a window is dropped in favour of that
  /// vertex. Near a source the distance is tiny, and the excess covers the rounding of the edge's length.
  double drop_threshold(std::int32_t vertex, double length) const {
    return distance(vertex) * (1 + drop_tolerance) + edge_rounding * length;
  }
  /// Whether lengths of paths to a vertex differ by less than the excess at which windows are dropped in its favour.
  bool within_drop_tolerance(double a, double b) const {
    return std::abs(a - b) <= drop_tolerance * a + edge_rounding_;
  }
  std::size_t memory_bytes() const {
    return distances_.capacity() * sizeof(Distance) + records_.capacity() * sizeof(VertexRecord);
  }

 private:
  struct Distance {
    double value;
    std::uint32_t epoch;
  };

  /// Notes a tie if `path` is as short as the recorded path to a vertex that emits windows, and comes from another
  /// direction. What is noted is `path`, or the recorded path if `path` replaces it. The vertex then continues both.
  /// Returns whether it has windows to emit.
  ///
  /// Why no shortest path is lost, although lengths are rounded: let P be a shortest path to a point y.
  ///
  /// 1. A window is cut in favour of a vertex only where the path by the vertex is shorter by drop_tolerance, which is
  ///    far more than the rounding of lengths. P would not be shortest there. So no cut removes P.
  /// 2. A window w that holds P may be trimmed in favour of another window c where both are equal up to rounding. The
  ///    path by c to the point where P crosses the edge, and then along P, is as long as P up to rounding, and the rays
  ///    of c have nearly the direction of P. Where w and c divide an edge, their rays cross beyond it, so that no gap
  ///    opens between them. Therefore c holds a path to y that is as short, or y lies beyond an end of c. If c was
  ///    trimmed at that end, the same holds for the window in whose favour this was done. If c has passed beside a
  ///    vertex v at that end, v emits windows into the region beyond it, behind the path that has come to v by c.
  /// 3. That path is longer than the recorded path to v by drop_tolerance at most, since otherwise v would have cut c,
  ///    which step 1 excludes. But it need not be the recorded one. Paths whose lengths differ by one part in 10^12 may
  ///    come from directions that differ by 10^-6 radians, because a chord past a corner saves only the square of the
  ///    angle. Behind the recorded path, v then emits nothing into the part where y lies: the angle there falls short
  ///    of pi.
  ///
  /// Therefore v emits windows behind every path that ties with the recorded one up to the tolerance of cuts. Each of
  /// these paths has a sector behind it, and only what the sectors of the others leave out is emitted.
  bool note_tie(std::int32_t v, const VertexRecord& path, double length, bool replaces);
  /// Whether lengths of paths to a vertex are so close that both count as shortest.
  bool both_shortest(double a, double b) const { return std::abs(a - b) <= tie_tolerance * a + edge_rounding_; }

  const SearchMesh& mesh_;
  std::vector<Distance> distances_;  ///< separate from the records, because every window reads them
  std::vector<VertexRecord> records_;
  std::vector<TiedArrival> ties_;
  std::uint32_t epoch_ = 0;
  double relative_error_ = 0;
  double edge_rounding_ = 0;  ///< edge_rounding times the longest edge
  std::int64_t reached_count_ = 0;
};

}  // namespace supple::surface
