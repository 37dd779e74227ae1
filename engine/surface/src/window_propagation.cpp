// The propagation of windows through a face, which is the inner loop of the search.
#include <Eigen/Geometry>
#include <algorithm>

#include "supple/base/stop_pace.h"
#include "window_search.h"

namespace supple::surface {
namespace {

/// An apex that lies outside a window by at most this fraction of the edge still takes the path by the window's end,
/// because windows on both sides of a vertex meet there only up to rounding.
constexpr double kApexTolerance = 1e-9;
/// A difference of squares has lost too many digits if it is below this fraction of the minuend.
constexpr double cancellation_ratio = 1e-4;
/// Neighbouring windows that overlap by less than this fraction of the edge touch up to rounding, and are not trimmed.
constexpr double touching_tolerance = 1e-9;
/// Maximum number of windows at an edge that are compared each with each.
constexpr std::size_t max_pairwise_batch = 64;
/// A path to the apex is straight up to rounding if it misses its window by less than this fraction of the edge.
constexpr double straight_tolerance = 1e-13;

}  // namespace

bool WindowSearch::cut_within_error(Window& window, std::int32_t halfedge) {
  const EdgeFrame& frame = mesh_->frames[halfedge];
  const double shrink = (1 + kDropTolerance) / (1 + settings_.relative_error);
  const auto weight = [&](std::int32_t v) { return distance(v) < kInfinity ? length_of_path(v) * shrink : kInfinity; };
  const Cut result = cut(window, {weight(frame.tail) - window.sigma, weight(frame.head) - window.sigma}, frame.length);
  for (const auto& [by, v] : {std::pair{result.by_tail, frame.tail}, std::pair{result.by_head, frame.head}}) {
    if (!by) continue;
    VertexRecord& record = vertex_record(v);
    if (record.emits_all_around) continue;
    make_pseudo_source(v);
    queue_vertex(v, record);
  }
  return !result.empty;
}

double WindowSearch::goal_key(const Window& window, const Exit& exit) const {
  double crossing = 0;
  const double straight = length_to(window, exit.goal.x(), exit.goal.y(), crossing);
  if (settings_.landmark.empty()) return straight;
  // The goal's distance from x on the edge is at least its distance from an end less that of x from the end. Since
  // |S - x| - x decreases and |S - x| + x increases along the edge, each bound is least at one end of the window.
  const double by_tail = length_at(window, window.b1) - window.b1 + exit.tail_to_goal;
  const double by_head = length_at(window, window.b0) + window.b0 + exit.head_to_goal - exit.length;
  return std::max({straight, by_tail, by_head});
}

template <bool plain>
inline void WindowSearch::admit(Window& window, Exit& exit) {
  if (!(window.b1 - window.b0 > kLeastWidth * exit.length)) return;
  if (cut(window, {exit.tail - window.sigma, exit.head - window.sigma}, exit.length).empty) return;
  if (!plain && settings_.relative_error > 0 && !cut_within_error(window, exit.halfedge)) return;
  if (!plain && settings_.goal_directed) {
    const double key = goal_key(window, exit);
    if (key > max_key_) return;
    exit.key = std::min(exit.key, key);
  } else {
    const double at = clamped(window.source_x, window.b0, window.b1);
    if (!plain && max_key_ < kInfinity && farther(window, at, max_key_ - window.sigma)) return;
    // The square root is taken only if it lowers the batch's key.
    const double nearest = squared_radius(window, at);
    const double to_beat = exit.key - window.sigma;
    if (to_beat > 0 && nearest < to_beat * to_beat) exit.key = window.sigma + std::sqrt(nearest);
  }
  const std::int32_t i = allocate();
  // The members are copied one by one, because wide loads of what narrow stores have just written would stall.
  Window& slot = pool_[i];
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

Eigen::Vector2d WindowSearch::goal_in_frame(std::int32_t tail, std::int32_t head, double length) const {
  const std::vector<Eigen::Vector3d>& positions = mesh_->mesh->positions();
  const Eigen::Vector3d edge = positions[head] - positions[tail];
  const Eigen::Vector3d relative = vector_to_goal(tail);
  const double along = edge.dot(relative) / length;
  const double squared = relative.squaredNorm();
  const double height = squared - along * along;
  if (height > cancellation_ratio * squared) return {along, std::sqrt(height)};
  // The height of a goal next to the edge's line cancels in the difference of squares, but not in the triangle's area.
  return {along, edge.cross(relative).norm() / length};
}

WindowSearch::Exit WindowSearch::exit_towards(std::int32_t halfedge, std::int32_t tail, std::int32_t head,
                                              double length, EdgeFrame::Direction direction) {
  Exit exit{halfedge,
            length,
            direction.x,
            direction.y,
            drop_threshold(tail, length),
            drop_threshold(head, length),
            kInfinity,
            min_distance_to_goal(tail),
            min_distance_to_goal(head),
            {0, 0},
            -1};
  if (halfedge < 0) return exit;
  exit.pending = halfedge_record(halfedge).pending;
  if (settings_.goal_directed) exit.goal = goal_in_frame(tail, head, length);
  return exit;
}

void WindowSearch::admit_first(Window& window, std::int32_t halfedge) {
  const EdgeFrame& frame = mesh_->frames[halfedge];
  Exit exit = exit_towards(halfedge, frame.tail, frame.head, frame.length, {1, 0});
  admit<false>(window, exit);
  queue_exit(exit);
}

void WindowSearch::queue_exit(const Exit& exit) {
  if (!(exit.key < kInfinity)) return;
  HalfedgeRecord& record = halfedges_[exit.halfedge];
  record.pending = exit.pending;
  queue_halfedge(exit.halfedge, record, exit.key);
}

Trail WindowSearch::continued(Trail trail) {
  if (!records_trails_) return Trail::start();
  trails_.push_back(trail);
  return Trail::after(static_cast<std::int32_t>(trails_.size()) - 1);
}

template <bool plain, bool near_vertices>
void WindowSearch::propagate(const Window& w, const Entrance& entrance, Exit& left, Exit& right) {
  const double length = entrance.length;
  const double ax = entrance.apex_x;
  const double ay = entrance.apex_y;
  const double height = w.depth + ay;
  // Negative if the ray through b passes to the left of the apex. It needs no division.
  const auto side_of_apex = [&](double b) { return (b - w.source_x) * height - (ax - w.source_x) * w.depth; };
  const double first = side_of_apex(w.b0);
  const double last = side_of_apex(w.b1);
  const double tolerance = kApexTolerance * length * height;
  if (first <= tolerance && last >= -tolerance) {
    double crossing = 0;
    const double reached = length_to(w, ax, ay, crossing);
    const double rounding = straight_tolerance * length * height;
    if (improve_vertex(entrance.apex, reached, w.sigma, w.source_x, w.depth, entrance.halfedge, w.trail, w.origin, -1,
                       crossing, first <= rounding && last >= -rounding)) {
      left.head = drop_threshold(entrance.apex, left.length);
      right.tail = drop_threshold(entrance.apex, right.length);
    }
  }
  Trail trail = w.trail;
  if (trail.full()) trail = continued(trail);
  // The direction from a source to a very close end of the edge has lost its digits. Windows on both sides of such a
  // vertex overlap by as much as rounding could leave open.
  const double rounding = near_vertices ? kEdgeRounding * length : 0;
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
    admit<plain>(child, left);
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
    admit<plain>(child, right);
  }
}

// Windows from sources in one face all begin at the same point. The one whose source is further along the edge gets the
// later part of an overlap, so that it comes later in the order.
void WindowSearch::trim_large_batch(double touching) {
  StopPace pace(*cancellation_);
  sort_stoppably(batch_, *cancellation_, [this](std::int32_t i, std::int32_t j) {
    const Window& a = pool_[i];
    const Window& b = pool_[j];
    if (a.b0 != b.b0) return a.b0 < b.b0;
    return a.source_x != b.source_x ? a.source_x < b.source_x : i < j;
  });
  const auto is_lost = [this](std::int32_t i) { return !(pool_[i].b1 > pool_[i].b0); };
  remaining_.clear();
  for (const std::int32_t i : batch_) {
    Window& window = pool_[i];
    std::size_t compared = remaining_.size();
    while (compared > 0 && !is_lost(i)) {
      pace.look();
      Window& before = pool_[remaining_[compared - 1]];
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

void WindowSearch::process(std::int32_t h) {
  HalfedgeRecord& record = halfedges_[h];
  const EdgeFrame& frame = mesh_->frames[h];
  batch_.clear();
  // The windows are not cut again: vertices may have improved since, but this hardly ever drops a window.
  double last = -kInfinity;
  for (std::int32_t i = record.pending; i >= 0; i = pool_[i].link) {
    const double b0 = pool_[i].b0;
    batch_.push_back(i);
    if (b0 >= last || batch_.size() > max_pairwise_batch) {
      last = b0;
      continue;
    }
    std::size_t place = batch_.size() - 1;
    while (place > 0 && pool_[batch_[place - 1]].b0 > b0) {
      batch_[place] = batch_[place - 1];
      --place;
    }
    batch_[place] = i;
  }
  record.pending = -1;
  const bool is_large = batch_.size() > max_pairwise_batch;
  const double touching = touching_tolerance * frame.length;
  if (is_large) {
    trim_large_batch(touching);
  } else {
    for (std::size_t i = 1; i < batch_.size(); ++i) {
      Window& window = pool_[batch_[i]];
      for (std::size_t j = i; j-- > 0;) {
        Window& before = pool_[batch_[j]];
        if (before.b1 <= before.b0) continue;
        if (before.b1 <= window.b0 + touching) break;
        trim_to_envelope(before, window);
        if (window.b1 <= window.b0) break;
      }
    }
  }
  const double min_width = kLeastWidth * frame.length;
  Exit left = exit_towards(frame.left, frame.tail, frame.apex, frame.left_length, frame.left_direction());
  Exit right = exit_towards(frame.right, frame.apex, frame.head, frame.right_length, frame.right_direction());
  const Entrance entrance{h, frame.apex, frame.length, frame.apex_x(), frame.apex_y};
  // Every window has at most two children. With room for all of them, the pool is not reallocated within the loop.
  if (pool_.capacity() < pool_.size() + 2 * batch_.size()) pool_.reserve(2 * pool_.capacity() + 2 * batch_.size());
  const bool has_targets = !targets_.empty() && faces_[TriangleMesh::face_of(h)].epoch == epoch_;
  // The loop runs from the last window to the first, so that the children's lists, which grow at the front, are in
  // order.
  for (std::size_t place = batch_.size(); place-- > 0;) {
    if (is_large && place % max_pairwise_batch == 0) cancellation_->throw_if_requested();
    const std::int32_t i = batch_[place];
    const Window& window = pool_[i];
    if (!(window.b1 - window.b0 > min_width)) {
      release(i);
      continue;
    }
    if (has_targets) {
      visit_targets(TriangleMesh::face_of(h),
                    [&](SearchTarget& target) { update_by_window(*mesh_, sources_, target, h, window); });
    }
    if (plain_) {
      propagate<true, false>(window, entrance, left, right);
    } else if (!near_vertices_) {
      propagate<false, false>(window, entrance, left, right);
    } else {
      propagate<false, true>(window, entrance, left, right);
    }
    if (settings_.keep_windows) {
      pool_[i].link = h;
      logged_.push(window);
      ++halfedges_[h].logged;
    }
    release(i);
  }
  queue_exit(left);
  queue_exit(right);
}

}  // namespace supple::surface
