#include "window_propagation.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "supple/base/stop_pace.h"

namespace supple::surface {
namespace {

/// An apex that lies outside a window by at most this fraction of the edge still takes the path by the window's end,
/// because windows on both sides of a vertex meet there only up to rounding.
constexpr double apex_tolerance = 1e-9;
/// Neighbouring windows that overlap by less than this fraction of the edge touch up to rounding, and are not trimmed.
constexpr double touching_tolerance = 1e-9;
/// Maximum number of windows at an edge that are compared each with each.
constexpr std::size_t max_pairwise_batch = 64;
/// A path to the apex is straight up to rounding if it misses its window by less than this fraction of the edge.
constexpr double straight_tolerance = 1e-13;

/// The edge by which a batch of windows enters a face, and the opposite corner. The copy spares reading the frame again
/// after every window that is written.
struct Entrance {
  std::int32_t halfedge, apex;
  double length, apex_x, apex_y;
};

/// One of the two edges by which a batch of windows leaves a face.
struct Exit {
  std::int32_t halfedge;  ///< halfedge at which they arrive in the next face; -1 on the boundary
  double length;
  double ux, uy;                      ///< EdgeFrame::left_direction or right_direction
  double tail, head;                  ///< VertexTable::drop_threshold of its end vertices
  double key;                         ///< least key of the windows that have left by it
  double tail_to_goal, head_to_goal;  ///< lower bounds of its ends' distances to the goal
  Eigen::Vector2d goal;               ///< SearchGoal::in_frame of the edge, in goal-directed searches
  std::int32_t pending;               ///< first pending window of the halfedge; new ones are put before it
};

Exit exit_towards(SearchFront& front, std::int32_t halfedge, std::int32_t tail, std::int32_t head, double length,
                  EdgeFrame::Direction direction) {
  Exit exit{halfedge,
            length,
            direction.x,
            direction.y,
            front.vertices.drop_threshold(tail, length),
            front.vertices.drop_threshold(head, length),
            infinity,
            front.goal.min_distance_by_landmark(tail),
            front.goal.min_distance_by_landmark(head),
            {0, 0},
            -1};
  if (halfedge < 0) return exit;
  exit.pending = front.halfedge(halfedge).pending;
  if (front.settings.goal_directed) exit.goal = front.goal.in_frame(tail, head, length);
  return exit;
}

/// Hands the windows of an exit over to its halfedge, and queues the halfedge.
void queue_exit(SearchFront& front, const Exit& exit) {
  if (!(exit.key < infinity)) return;
  SearchFront::HalfedgeRecord& record = front.halfedges[exit.halfedge];
  record.pending = exit.pending;
  front.queue_halfedge(exit.halfedge, record, exit.key);
}

/// Cuts a window with an allowed error. Vertices that take over a part of it emit windows of their own. Returns whether
/// anything is left.
bool cut_within_error(SearchFront& front, Window& window, std::int32_t halfedge) {
  const EdgeFrame& frame = front.mesh->frames[halfedge];
  const double shrink = (1 + drop_tolerance) / (1 + front.settings.relative_error);
  const auto weight = [&](std::int32_t v) {
    return front.vertices.distance(v) < infinity ? front.vertices.length_of_path(v) * shrink : infinity;
  };
  const Cut result = cut(window, {weight(frame.tail) - window.sigma, weight(frame.head) - window.sigma}, frame.length);
  for (const auto& [by, v] : {std::pair{result.by_tail, frame.tail}, std::pair{result.by_head, frame.head}}) {
    if (!by) continue;
    VertexRecord& record = front.vertices.record(v);
    if (record.emits_all_around) continue;
    front.vertices.make_pseudo_source(v);
    front.queue_vertex(v);
  }
  return !result.empty;
}

/// Lower bound of the length of a path through the window to the goal.
double goal_key(const SearchFront& front, const Window& window, const Exit& exit) {
  double crossing = 0;
  const double straight = length_to(window, exit.goal.x(), exit.goal.y(), crossing);
  if (!front.goal.has_landmark()) return straight;
  // The goal's distance from x on the edge is at least its distance from an end less that of x from the end. Since
  // |S - x| - x decreases and |S - x| + x increases along the edge, each bound is least at one end of the window.
  const double by_tail = length_at(window, window.b1) - window.b1 + exit.tail_to_goal;
  const double by_head = length_at(window, window.b0) + window.b0 + exit.head_to_goal - exit.length;
  return std::max({straight, by_tail, by_head});
}

/// Cuts a new window against the vertices of its edge, and adds what no bound excludes to the exit. A `plain` search
/// has no goal, no allowed error and no limit to test for.
template <bool plain>
[[gnu::always_inline]] inline void admit(SearchFront& front, Window& window, Exit& exit) {
  if (!(window.b1 - window.b0 > min_window_width * exit.length)) return;
  if (cut(window, {exit.tail - window.sigma, exit.head - window.sigma}, exit.length).empty) return;
  if (!plain && front.settings.relative_error > 0 && !cut_within_error(front, window, exit.halfedge)) return;
  if (!plain && front.settings.goal_directed) {
    const double key = goal_key(front, window, exit);
    if (key > front.max_key) return;
    exit.key = std::min(exit.key, key);
  } else {
    const double at = clamped(window.source_x, window.b0, window.b1);
    if (!plain && front.max_key < infinity && farther(window, at, front.max_key - window.sigma)) return;
    // The square root is taken only if it lowers the batch's key.
    const double nearest = squared_radius(window, at);
    const double to_beat = exit.key - window.sigma;
    if (to_beat > 0 && nearest < to_beat * to_beat) exit.key = window.sigma + std::sqrt(nearest);
  }
  const std::int32_t i = front.pool.allocate();
  // The members are copied one by one, because wide loads of what narrow stores have just written would stall.
  Window& slot = front.pool[i];
  slot.b0 = window.b0;
  slot.b1 = window.b1;
  slot.source_x = window.source_x;
  slot.depth = window.depth;
  slot.sigma = window.sigma;
  slot.trail = window.trail;
  slot.link = exit.pending;
  slot.origin = window.origin;
  exit.pending = i;
}

/// Appends a full trail to the list, and returns an empty trail that continues it.
Trail continued(SearchFront& front, Trail trail) {
  if (!front.records_trails) return Trail::start();
  front.trails.push_back(trail);
  return Trail::after(static_cast<std::int32_t>(front.trails.size()) - 1);
}

/// Propagates a window through its face to both exits. With `near_vertices` (see SearchFront), windows overlap at the
/// ends of edges.
template <bool plain, bool near_vertices>
void propagate(SearchFront& front, const Window& w, const Entrance& entrance, Exit& left, Exit& right) {
  const double length = entrance.length;
  const double ax = entrance.apex_x;
  const double ay = entrance.apex_y;
  const double height = w.depth + ay;
  // Negative if the ray through b passes to the left of the apex. It needs no division.
  const auto side_of_apex = [&](double b) { return (b - w.source_x) * height - (ax - w.source_x) * w.depth; };
  const double first = side_of_apex(w.b0);
  const double last = side_of_apex(w.b1);
  const double tolerance = apex_tolerance * length * height;
  if (first <= tolerance && last >= -tolerance) {
    double crossing = 0;
    const double reached = length_to(w, ax, ay, crossing);
    const double rounding = straight_tolerance * length * height;
    if (front.improve_vertex(entrance.apex, reached, w.sigma, w.source_x, w.depth, entrance.halfedge, w.trail, w.origin,
                             -1, crossing, first <= rounding && last >= -rounding)) {
      left.head = front.vertices.drop_threshold(entrance.apex, left.length);
      right.tail = front.vertices.drop_threshold(entrance.apex, right.length);
    }
  }
  Trail trail = w.trail;
  if (trail.full()) trail = continued(front, trail);
  // The direction from a source to a very close end of the edge has lost its digits. Windows on both sides of such a
  // vertex overlap by as much as rounding could leave open.
  const double rounding = near_vertices ? edge_rounding * length : 0;
  if (left.halfedge >= 0 && first < 0) {
    // Distance from the tail at which the ray through b meets the edge from tail to apex.
    const auto meets = [&](double b) { return w.depth * b / (w.depth * left.ux + (w.source_x - b) * left.uy); };
    Window child;
    child.b0 = meets(w.b0);
    const double beyond = near_vertices && w.b1 >= length ? rounding : 0;
    const double end = meets(w.b1 + beyond);
    child.b1 = last + beyond * height < 0 ? std::min(end, left.length) : left.length;
    const WindowSource source = source_across_left({w.source_x, w.depth}, left.ux, left.uy);
    child.source_x = source.x;
    child.depth = source.depth;
    child.sigma = w.sigma;
    child.trail = trail.after_turn(false);
    child.origin = w.origin;
    admit<plain>(front, child, left);
  }
  if (right.halfedge >= 0 && last > 0) {
    // Distance from the head at which the ray through b meets the edge from apex to head.
    const auto meets = [&](double b) {
      return w.depth * (length - b) / (w.depth * right.ux + (b - w.source_x) * right.uy);
    };
    Window child;
    const double before = near_vertices && w.b0 <= 0 ? rounding : 0;
    const double begin = right.length - meets(w.b0 - before);
    child.b0 = first - before * height > 0 ? std::max(0.0, begin) : 0;
    child.b1 = right.length - meets(w.b1);
    const WindowSource source = source_across_right({w.source_x, w.depth}, ax, ay, right.ux, right.uy);
    child.source_x = source.x;
    child.depth = source.depth;
    child.sigma = w.sigma;
    child.trail = trail.after_turn(true);
    child.origin = w.origin;
    admit<plain>(front, child, right);
  }
}

}  // namespace

void SearchFront::admit_first(Window& window, std::int32_t halfedge) {
  const EdgeFrame& frame = mesh->frames[halfedge];
  Exit exit = exit_towards(*this, halfedge, frame.tail, frame.head, frame.length, {1, 0});
  admit<false>(*this, window, exit);
  queue_exit(*this, exit);
}

/// Lists the pending windows of a halfedge; a small batch in the order of their beginnings. They are not cut again:
/// vertices may have improved since, but this hardly ever drops a window.
void WindowPropagation::gather(std::int32_t h) {
  const WindowPool& pool = front_.pool;
  SearchFront::HalfedgeRecord& record = front_.halfedges[h];
  batch_.clear();
  double last = -infinity;
  for (std::int32_t i = record.pending; i >= 0; i = pool[i].link) {
    const double b0 = pool[i].b0;
    batch_.push_back(i);
    if (b0 >= last || batch_.size() > max_pairwise_batch) {
      last = b0;
      continue;
    }
    std::size_t place = batch_.size() - 1;
    while (place > 0 && pool[batch_[place - 1]].b0 > b0) {
      batch_[place] = batch_[place - 1];
      --place;
    }
    batch_[place] = i;
  }
  record.pending = -1;
}

void WindowPropagation::trim_small_batch(double touching) {
  WindowPool& pool = front_.pool;
  for (std::size_t i = 1; i < batch_.size(); ++i) {
    Window& window = pool[batch_[i]];
    for (std::size_t j = i; j-- > 0;) {
      Window& before = pool[batch_[j]];
      if (before.b1 <= before.b0) continue;
      if (before.b1 <= window.b0 + touching) break;
      trim_to_envelope(before, window);
      if (window.b1 <= window.b0) break;
    }
  }
}

/// Sorts the windows of a large batch by their beginnings, and trims each to the part where it is the shortest.
/// Overlaps of at most `touching` stay. O(n log n), even if all windows overlap.
///
/// Windows from sources in one face all begin at the same point. The one whose source is further along the edge gets
/// the later part of an overlap, so that it comes later in the order.
void WindowPropagation::trim_large_batch(double touching, const CancellationToken& cancellation) {
  WindowPool& pool = front_.pool;
  StopPace pace(cancellation);
  sort_stoppably(batch_, cancellation, [&pool](std::int32_t i, std::int32_t j) {
    const Window& a = pool[i];
    const Window& b = pool[j];
    if (a.b0 != b.b0) return a.b0 < b.b0;
    return a.source_x != b.source_x ? a.source_x < b.source_x : i < j;
  });
  const auto is_lost = [&pool](std::int32_t i) { return !(pool[i].b1 > pool[i].b0); };
  remaining_.clear();
  for (const std::int32_t i : batch_) {
    Window& window = pool[i];
    std::size_t compared = remaining_.size();
    while (compared > 0 && !is_lost(i)) {
      pace.check();
      Window& before = pool[remaining_[compared - 1]];
      if (before.b1 <= window.b0 + touching) break;
      trim_to_envelope(before, window);
      --compared;
    }
    remaining_.erase(
        std::remove_if(remaining_.begin() + static_cast<std::ptrdiff_t>(compared), remaining_.end(), is_lost),
        remaining_.end());
    if (!is_lost(i)) remaining_.push_back(i);
  }
}

void WindowPropagation::process(std::int32_t h, const CancellationToken& cancellation) {
  SearchFront& front = front_;
  const EdgeFrame& frame = front.mesh->frames[h];
  gather(h);
  const bool is_large = batch_.size() > max_pairwise_batch;
  const double touching = touching_tolerance * frame.length;
  if (is_large)
    trim_large_batch(touching, cancellation);
  else
    trim_small_batch(touching);
  const double min_width = min_window_width * frame.length;
  Exit left = exit_towards(front, frame.left, frame.tail, frame.apex, frame.left_length, frame.left_direction());
  Exit right = exit_towards(front, frame.right, frame.apex, frame.head, frame.right_length, frame.right_direction());
  const Entrance entrance{h, frame.apex, frame.length, frame.apex_x(), frame.apex_y};
  // Every window has at most two children. With room for all of them, the pool is not reallocated within the loop.
  front.pool.reserve(2 * batch_.size());
  const std::int32_t face = TriangleMesh::face_of(h);
  const bool has_targets = front.targets.are_in(face);
  // The loop runs from the last window to the first, so that the children's lists, which grow at the front, are in
  // order.
  for (std::size_t place = batch_.size(); place-- > 0;) {
    if (is_large && place % max_pairwise_batch == 0) cancellation.throw_if_requested();
    const std::int32_t i = batch_[place];
    const Window& window = front.pool[i];
    if (!(window.b1 - window.b0 > min_width)) {
      front.pool.release(i);
      continue;
    }
    if (has_targets) {
      front.targets.visit(
          face, [&](SearchTarget& target) { update_by_window(*front.mesh, front.sources, target, h, window); });
    }
    if (front.plain) {
      propagate<true, false>(front, window, entrance, left, right);
    } else if (!front.near_vertices) {
      propagate<false, false>(front, window, entrance, left, right);
    } else {
      propagate<false, true>(front, window, entrance, left, right);
    }
    if (front.settings.keep_windows) {
      front.pool[i].link = h;
      front.logged.push(window);
      ++front.halfedges[h].logged;
    }
    front.pool.release(i);
  }
  queue_exit(front, left);
  queue_exit(front, right);
}

}  // namespace supple::surface
