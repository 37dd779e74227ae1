#include "window_search.h"

#include <algorithm>
#include <limits>

#include "supple/base/stop_pace.h"
#include "window_emission.h"

namespace supple::surface {
namespace {

/// Numbers of queue entries by which the two stages of prefetching are ahead.
constexpr std::size_t prefetch_far = 6;
constexpr std::size_t prefetch_near = 2;
/// Batches between two checks for a stop request. They take well under a millisecond.
constexpr std::int64_t batches_per_checkpoint = 2048;
/// Upper bound of the bytes that a buffer allocates for each window that a search has created.
constexpr std::size_t max_bytes_per_window = 4 * sizeof(Window);

}  // namespace

void WindowSearch::update_by_corners(SearchTarget& target) {
  const Triangle& corners = front_.mesh->mesh->faces()[index(target.point.face)];
  for (int i = 0; i < 3; ++i) {
    const double d = distance(corners[i]);
    if (d < infinity) update_by_vertex(*front_.mesh, target, i, d, front_.vertices.reached(corners[i]));
  }
}

double WindowSearch::max_useful_key(double length) const {
  return length * (1 + tie_tolerance) + edge_rounding * front_.mesh->longest_edge;
}

bool WindowSearch::all_certain() {
  if (front_.targets.all().empty()) return false;
  const double min_queued_key = front_.queue.min_key();
  const std::span<SearchTarget> targets = front_.targets.all();
  while (first_uncertain_ < targets.size()) {
    SearchTarget& target = targets[first_uncertain_];
    if (target.best.length > min_queued_key || front_.settings.goal_directed) {
      update_by_corners(target);
    }
    const double max_key = max_useful_key(target.best.length);
    if (front_.settings.goal_directed) front_.max_key = std::min(front_.max_key, max_key);
    if (max_key > min_queued_key) return false;
    ++first_uncertain_;
  }
  return true;
}

void WindowSearch::run(std::span<const SurfacePoint> sources, std::span<SearchTarget> targets,
                       const SearchSettings& settings, const Execution& execution) {
  front_.start(sources, targets, settings);
  first_uncertain_ = 0;
  batches_ = 0;
  StopPace pace(execution.cancellation);
  for (std::size_t i = 0; i < sources.size(); ++i) {
    pace.check();
    emit_from_source(front_, static_cast<std::int32_t>(i));
  }
  std::int32_t item = 0;
  BucketQueue::Bucket bucket = 0;
  BucketQueue::Bucket last_checked_bucket = -1;
  while (front_.queue.pop(item, bucket)) {
    if (bucket != last_checked_bucket || front_.settings.goal_directed) {
      last_checked_bucket = bucket;
      if (all_certain() || front_.queue.min_key() > front_.max_key) break;
    }
    prefetch();
    if (item >= 0) {
      SearchFront::HalfedgeRecord& record = front_.halfedges[item];
      if (record.queued != bucket) continue;
      record.queued = BucketQueue::not_queued;
      propagation_.process(item, execution.cancellation);
      if (++batches_ % batches_per_checkpoint == 0) {
        execution.cancellation.throw_if_requested();
        report_progress(execution);
      }
    } else {
      VertexRecord& record = front_.vertices.reached(~item);
      if (record.queued != bucket) continue;
      record.queued = BucketQueue::not_queued;
      emit_from_vertex(front_, ~item);
    }
  }
  for (SearchTarget& target : targets) update_by_corners(target);
}

void WindowSearch::report_progress(const Execution& execution) const {
  // A search with targets may end early, so that its progress is not known.
  if (!execution.progress || !front_.targets.all().empty()) return;
  execution.progress->report(
      static_cast<double>(front_.vertices.reached_count()) / static_cast<double>(front_.vertices.size()), "search");
}

void WindowSearch::prefetch() const {
  // The addresses for the second stage are in the memory that the first stage fetches.
  constexpr std::int32_t none = std::numeric_limits<std::int32_t>::max();
  const std::int32_t far = front_.queue.upcoming(prefetch_far, none);
  const std::int32_t near = front_.queue.upcoming(prefetch_near, none);
  if (far < 0) {
    front_.vertices.prefetch_record(~far);
    __builtin_prefetch(&front_.mesh->first_corner[~far]);
  } else if (far != none) {
    __builtin_prefetch(&front_.mesh->frames[far]);
    __builtin_prefetch(&front_.halfedges[far]);
  }
  if (near < 0) {
    const FanCorner* fan = front_.mesh->fan(~near).data();
    __builtin_prefetch(fan);
    __builtin_prefetch(fan + 4);
    if (const std::int32_t h = front_.vertices.records()[~near].halfedge; h >= 0)
      __builtin_prefetch(&front_.mesh->frames[h]);
  } else if (near != none) {
    const EdgeFrame& frame = front_.mesh->frames[near];
    if (const std::int32_t pending = front_.halfedges[near].pending; pending >= 0)
      __builtin_prefetch(&front_.pool[pending]);
    if (frame.left >= 0) __builtin_prefetch(&front_.halfedges[frame.left]);
    if (frame.right >= 0) __builtin_prefetch(&front_.halfedges[frame.right]);
    front_.vertices.prefetch_distance(frame.apex);
  }
}

void WindowSearch::take_logged_windows(std::vector<VertexRecord>& records, LargeVector<Window>& windows,
                                       std::vector<std::int32_t>& first) {
  // The windows are sorted by halfedge. Each entry of `first` begins as the end of its halfedge's windows and is
  // counted down to their beginning, so that the last window comes first.
  first.resize(front_.halfedges.size() + 1);
  std::int32_t end = 0;
  for (std::size_t h = 0; h < front_.halfedges.size(); ++h) {
    if (front_.halfedges[h].epoch == front_.epoch) end += front_.halfedges[h].logged;
    first[h] = end;
  }
  first[front_.halfedges.size()] = end;
  const double to_length = 1 + front_.settings.relative_error;
  windows.resize(front_.logged.size());
  front_.logged.drain(max_retained_buffer_bytes, [&](const Window& window) {
    Window& copy = windows[--first[window.link]];
    copy = window;
    copy.sigma *= to_length;
  });
  records.resize(front_.vertices.size());
  for (std::size_t v = 0; v < records.size(); ++v) records[v] = front_.vertices.record(static_cast<std::int32_t>(v));
}

void WindowSearch::give_back_memory() {
  if (static_cast<std::size_t>(windows_created()) * max_bytes_per_window <= max_retained_buffer_bytes &&
      front_.logged.size() == 0)
    return;
  front_.pool.give_back_memory(max_retained_buffer_bytes);
  if (front_.trails.capacity() * sizeof(Trail) > max_retained_buffer_bytes) std::vector<Trail>().swap(front_.trails);
  front_.logged.drain(max_retained_buffer_bytes, [](const Window&) {});
  front_.queue.give_back_memory(max_retained_buffer_bytes);
}

std::size_t WindowSearch::buffer_bytes() const {
  return front_.pool.memory_bytes() + front_.trails.capacity() * sizeof(Trail) + front_.logged.memory_bytes() +
         front_.queue.memory_bytes();
}

std::size_t WindowSearch::memory_bytes() const {
  return buffer_bytes() + front_.halfedges.capacity() * sizeof(SearchFront::HalfedgeRecord) +
         front_.vertices.memory_bytes() + front_.targets.memory_bytes();
}

}  // namespace supple::surface
