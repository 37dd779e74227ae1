#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "search_front.h"
#include "window_propagation.h"

namespace supple::surface {

/// Maximum bytes that an ended search retains of each buffer that grows with its work: pending windows, trails, logged
/// windows, queue. Searches of a few milliseconds, of which there are many, need less and therefore allocate nothing.
inline constexpr std::size_t max_retained_buffer_bytes = std::size_t{4} << 20;

/// One continuous Dijkstra search [Mitchell1987] with all its state, which can be used again.
///
/// The queue holds halfedges and vertices, never single windows. When a halfedge is popped, all windows that are
/// pending at it are trimmed to their lower envelope and propagated through its face at once. When a saddle or boundary
/// vertex is popped, it emits windows into the angles to which a shortest path may turn. The order decides only how
/// much work is wasted: windows that improve on earlier ones may come at any time.
class WindowSearch {
 public:
  explicit WindowSearch(const SearchMesh& mesh) : front_(mesh), propagation_(front_) {}
  WindowSearch(const WindowSearch&) = delete;
  WindowSearch& operator=(const WindowSearch&) = delete;

  void run(std::span<const SurfacePoint> sources, std::span<SearchTarget> targets, const SearchSettings& settings,
           const Execution& execution);

  const SearchMesh& mesh() const { return *front_.mesh; }
  double distance(std::int32_t vertex) const { return front_.vertices.distance(vertex); }
  double length_of_path(std::int32_t vertex) const { return front_.vertices.length_of_path(vertex); }
  /// One record for each vertex. Those that the search did not reach are out of date.
  const VertexRecord* records() const { return front_.vertices.records(); }
  /// The full trails to which the trails of windows and records refer.
  std::span<const Trail> trails() const { return front_.trails; }
  /// The tied arrivals to which records refer.
  std::span<const TiedArrival> ties() const { return front_.vertices.ties(); }
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
  std::int64_t windows_created() const { return front_.pool.created(); }
  std::int64_t batches() const { return batches_; }
  std::span<const SurfacePoint> sources() const { return front_.sources; }

 private:
  void update_by_corners(SearchTarget& target);
  /// Whether every target is certain: no path that is still to be found can be shorter than its best one.
  bool all_certain();
  /// Largest key that matters for a target whose best known length is given, with allowances for ties and rounding.
  double max_useful_key(double length) const;
  void report_progress(const Execution& execution) const;
  /// Prefetches what the next batches need.
  void prefetch() const;

  SearchFront front_;
  WindowPropagation propagation_;
  std::size_t first_uncertain_ = 0;  ///< the targets before this one are certain
  std::int64_t batches_ = 0;
};

}  // namespace supple::surface
