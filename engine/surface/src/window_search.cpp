#include "window_search.h"

#include <numbers>

namespace supple::surface {
namespace {

/// Bucket width over mean edge length. Wider buckets gather larger batches and waste more work out of order.
constexpr double kFieldBucket = 0.5;
constexpr double kGoalBucket = 0.25;
/// The search goes on past the best known length by this much, relative, so that ties are seen.
constexpr double kTieTolerance = 1e-9;
/// An apex this far outside a window, relative to the edge, still takes the path by the window's end: windows on both
/// sides of a vertex meet there only up to rounding.
constexpr double kApexTolerance = 1e-9;
/// Neighbouring windows that overlap by less, relative to the edge, only touch up to rounding: not worth trimming.
constexpr double kTouching = 1e-9;
/// How many queue entries ahead memory is asked for.
constexpr std::size_t kPrefetchFar = 6;
constexpr std::size_t kPrefetchNear = 2;
/// A ray to the apex that leaves its window by less, relative to the edge, is straight up to rounding.
constexpr double kStraight = 1e-13;
/// Smallest relative improvement of a vertex: less is rounding.
constexpr double kImprovement = 4e-16;
/// Batches between looks at the cancellation flag (well under a millisecond).
constexpr std::int64_t kBatchesPerCheckpoint = 2048;

}  // namespace

WindowSearch::WindowSearch(const SearchMesh& mesh) : mesh_(&mesh) {
  const auto halfedges = static_cast<std::size_t>(mesh.mesh->halfedge_count());
  halfedges_.resize(halfedges, HalfedgeRecord{-1, -1, 0, BucketQueue::kNotQueued});
  distances_.resize(static_cast<std::size_t>(mesh.mesh->vertex_count()), Distance{kInfinity, 0});
  vertices_.resize(distances_.size());
  faces_.resize(static_cast<std::size_t>(mesh.mesh->face_count()), FaceRecord{0, -1});
}

inline WindowSearch::HalfedgeRecord& WindowSearch::halfedge_record(std::int32_t h) {
  HalfedgeRecord& record = halfedges_[h];
  if (record.epoch != epoch_) record = {-1, -1, epoch_, BucketQueue::kNotQueued};
  return record;
}

VertexRecord& WindowSearch::vertex_record(std::int32_t v) {
  VertexRecord& record = vertices_[v];
  if (distances_[v].epoch != epoch_) {
    distances_[v] = {kInfinity, epoch_};
    ++vertices_reached_;
    record = {0,
              0,
              0,
              -1,
              -1,
              -1,
              -1,
              BucketQueue::kNotQueued,
              mesh_->pins(v),
              mesh_->pins(v) && settings_.relative_error > 0};
  }
  return record;
}

inline std::int32_t WindowSearch::allocate() {
  ++windows_created_;
  if (free_ >= 0) {
    const std::int32_t i = free_;
    free_ = pool_[i].next;
    return i;
  }
  pool_.emplace_back();
  return static_cast<std::int32_t>(pool_.size()) - 1;
}

void WindowSearch::release(std::int32_t window) {
  pool_[window].halfedge = -1;
  pool_[window].next = free_;
  free_ = window;
}

void WindowSearch::hook(std::int32_t face, std::int32_t target) {
  FaceRecord& record = faces_[face];
  if (record.epoch != epoch_) record = {epoch_, -1};
  hooks_.push_back({target, record.hook});
  record.hook = static_cast<std::int32_t>(hooks_.size()) - 1;
}

void WindowSearch::start(std::span<const SurfacePoint> sources, std::span<SearchTarget> targets,
                         const SearchSettings& settings) {
  if (++epoch_ == 0) {
    // The counter has wrapped: records of 2^32 searches ago would look current.
    for (HalfedgeRecord& r : halfedges_) r.epoch = 0;
    for (Distance& d : distances_) d.epoch = 0;
    for (FaceRecord& r : faces_) r.epoch = 0;
    epoch_ = 1;
  }
  pool_.clear();
  free_ = -1;
  hooks_.clear();
  windows_created_ = 0;
  batches_ = 0;
  vertices_reached_ = 0;
  sources_.assign(sources.begin(), sources.end());
  targets_ = targets;
  settings_ = settings;
  bound_ = settings.limit;
  uncertain_ = 0;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const SearchTarget& target = targets[i];
    if (target.vertex < 0) {
      hook(index(target.point.face), static_cast<std::int32_t>(i));
    } else {
      const std::int32_t first = mesh_->mesh->outgoing(target.vertex);
      std::int32_t h = first;
      do {
        hook(TriangleMesh::face_of(h), static_cast<std::int32_t>(i));
        h = mesh_->mesh->rotate(h);
      } while (h >= 0 && h != first);
    }
  }
  double first_key = 0;
  if (settings.goal_directed) {
    goal_ = targets[0].position;
    first_key = (position(*mesh_->mesh, sources_[0]) - goal_).norm();
    if (!settings.landmark.empty()) {
      for (const std::int32_t v : mesh_->mesh->faces()[index(sources_[0].face)]) {
        const double away = (mesh_->mesh->positions()[v] - position(*mesh_->mesh, sources_[0])).norm();
        first_key = std::max(first_key, to_goal(v) - away);
      }
    }
  }
  queue_.start(first_key, mesh_->mesh->mean_edge_length() * (settings.goal_directed ? kGoalBucket : kFieldBucket));
}

void WindowSearch::offer_corners(SearchTarget& target) {
  const Triangle& corners = mesh_->mesh->faces()[index(target.point.face)];
  for (int i = 0; i < 3; ++i) {
    const double d = distance(corners[i]);
    if (d < kInfinity) offer_vertex(*mesh_, target, i, d, vertices_[corners[i]]);
  }
}

bool WindowSearch::settled() {
  if (targets_.empty()) return false;
  const double certain = queue_.least_key();
  while (uncertain_ < targets_.size()) {
    SearchTarget& target = targets_[uncertain_];
    if (target.best.length > certain || settings_.goal_directed) {
      offer_corners(target);
    }
    if (settings_.goal_directed) bound_ = std::min(bound_, target.best.length * (1 + kTieTolerance));
    if (target.best.length * (1 + kTieTolerance) > certain) return false;
    ++uncertain_;
  }
  return true;
}

void WindowSearch::run(std::span<const SurfacePoint> sources, std::span<SearchTarget> targets,
                       const SearchSettings& settings, const Execution& execution) {
  start(sources, targets, settings);
  for (std::size_t i = 0; i < sources_.size(); ++i) emit_from_source(static_cast<std::int32_t>(i));
  std::int32_t item = 0;
  BucketQueue::Bucket bucket = 0;
  BucketQueue::Bucket checked = -1;
  while (queue_.pop(item, bucket)) {
    if (bucket != checked || settings_.goal_directed) {
      checked = bucket;
      if (settled() || queue_.least_key() > bound_) break;
    }
    prefetch();
    if (item >= 0) {
      HalfedgeRecord& record = halfedges_[item];
      if (record.queued != bucket) continue;
      record.queued = BucketQueue::kNotQueued;
      process(item);
      if (++batches_ % kBatchesPerCheckpoint == 0) {
        execution.cancellation.throw_if_requested();
        report_progress(execution);
      }
    } else {
      VertexRecord& record = vertices_[~item];
      if (record.queued != bucket) continue;
      record.queued = BucketQueue::kNotQueued;
      emit_from_vertex(~item);
    }
  }
  for (SearchTarget& target : targets_) {
    offer_corners(target);
  }
}

void WindowSearch::report_progress(const Execution& execution) const {
  // Of a search that may stop early nobody knows the end.
  if (!execution.progress || !targets_.empty()) return;
  execution.progress->report(static_cast<double>(vertices_reached_) / static_cast<double>(vertices_.size()), "search");
}

void WindowSearch::prefetch() const {
  // Two stages, because what the later one fetches is named by what the earlier one has brought.
  constexpr std::int32_t none = std::numeric_limits<std::int32_t>::max();
  const std::int32_t far = queue_.upcoming(kPrefetchFar, none);
  const std::int32_t near = queue_.upcoming(kPrefetchNear, none);
  if (far < 0) {
    __builtin_prefetch(&vertices_[~far]);
    __builtin_prefetch(&mesh_->first_corner[~far]);
  } else if (far != none) {
    __builtin_prefetch(&mesh_->frames[far]);
    __builtin_prefetch(&halfedges_[far]);
  }
  if (near < 0) {
    const FanCorner* fan = mesh_->fan(~near).data();
    __builtin_prefetch(fan);
    __builtin_prefetch(fan + 4);
    if (const std::int32_t h = vertices_[~near].halfedge; h >= 0) __builtin_prefetch(&mesh_->frames[h]);
  } else if (near != none) {
    const EdgeFrame& frame = mesh_->frames[near];
    if (const std::int32_t pending = halfedges_[near].pending; pending >= 0) __builtin_prefetch(&pool_[pending]);
    if (frame.left >= 0) __builtin_prefetch(&halfedges_[frame.left]);
    if (frame.right >= 0) __builtin_prefetch(&halfedges_[frame.right]);
    __builtin_prefetch(&distances_[frame.apex]);
  }
}

void WindowSearch::copy_kept(std::vector<VertexRecord>& records, LargeVector<Window>& windows,
                             std::vector<std::int32_t>& first) {
  // A copy, grouped by halfedge: the pool stays with the search, whose next run then needs no new memory.
  places_.resize(pool_.size());
  first.resize(halfedges_.size() + 1);
  std::int32_t count = 0;
  for (std::size_t h = 0; h < halfedges_.size(); ++h) {
    first[h] = count;
    if (halfedges_[h].epoch != epoch_) continue;
    for (std::int32_t i = halfedges_[h].kept; i >= 0; i = pool_[i].next) places_[i] = count++;
  }
  first[halfedges_.size()] = count;
  const double to_length = 1 + settings_.relative_error;
  windows.reserve(static_cast<std::size_t>(count));
  for (std::size_t h = 0; h < halfedges_.size(); ++h) {
    if (halfedges_[h].epoch != epoch_) continue;
    for (std::int32_t i = halfedges_[h].kept; i >= 0; i = pool_[i].next) {
      Window& copy = windows.emplace_back(pool_[i]);
      copy.sigma *= to_length;
      if (copy.parent >= 0) copy.parent = places_[copy.parent];
    }
  }
  records.resize(vertices_.size());
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    records[v] = vertex_record(static_cast<std::int32_t>(v));
    if (records[v].window >= 0) records[v].window = places_[records[v].window];
  }
}

void WindowSearch::queue_halfedge(std::int32_t h, HalfedgeRecord& record, double key) {
  const BucketQueue::Bucket bucket = queue_.bucket_of(key);
  if (record.queued <= bucket) return;
  record.queued = bucket;
  queue_.push(h, bucket);
}

void WindowSearch::queue_vertex(std::int32_t v, VertexRecord& record) {
  double key = distances_[v].value;
  if (settings_.goal_directed) key += std::max(to_goal(v), (mesh_->mesh->positions()[v] - goal_).norm());
  if (key > bound_) return;
  const BucketQueue::Bucket bucket = queue_.bucket_of(key);
  if (record.queued <= bucket) return;
  record.queued = bucket;
  queue_.push(~v, bucket);
}

bool WindowSearch::improve_vertex(std::int32_t v, double distance, double sigma, double source_x, double depth,
                                  std::int32_t halfedge, std::int32_t window, std::int32_t origin, std::int32_t along,
                                  bool straight) {
  VertexRecord& record = vertex_record(v);
  double& known = distances_[v].value;
  const bool improves = distance < known * (1 - kImprovement);
  const bool ties = distance < known * (1 + kDropTolerance) && distance > known * (1 - kDropTolerance);
  if (ties && known > 0) {
    // Of ways of equal length the one that has been straight for longest is kept: a vertex on it then does not seem to
    // pin the path.
    const bool straighter = along < 0 && straight && (record.along >= 0 || sigma < record.sigma * (1 - kDropTolerance));
    if (!straighter && !(improves && along >= 0 && record.along >= 0)) {
      if (improves) known = distance;
      return false;
    }
  } else if (!improves) {
    return false;
  }
  known = std::min(known, distance);
  record.sigma = sigma;
  record.source_x = source_x;
  record.depth = depth;
  record.halfedge = halfedge;
  record.window = window;
  record.origin = origin;
  record.along = along;
  if (improves && record.everywhere) become_source(v);
  if (improves && record.emits) queue_vertex(v, record);
  return improves;
}

void WindowSearch::become_source(std::int32_t v) {
  VertexRecord& record = vertices_[v];
  const double weight = length_of_path(v) / (1 + settings_.relative_error);
  record.everywhere = record.emits = true;
  record.sigma = distances_[v].value = weight;
}

bool WindowSearch::cut_within_error(Window& window) {
  const EdgeFrame& frame = mesh_->frames[window.halfedge];
  const double shrink = (1 + kDropTolerance) / (1 + settings_.relative_error);
  const auto weight = [&](std::int32_t v) { return distance(v) < kInfinity ? length_of_path(v) * shrink : kInfinity; };
  const Cut result = cut(window, {weight(frame.tail) - window.sigma, weight(frame.head) - window.sigma}, frame.length);
  for (const auto& [by, v] : {std::pair{result.by_tail, frame.tail}, std::pair{result.by_head, frame.head}}) {
    if (!by) continue;
    VertexRecord& record = vertex_record(v);
    if (record.everywhere) continue;
    become_source(v);
    queue_vertex(v, record);
  }
  return !result.dead;
}

double WindowSearch::goal_key(const Window& window, const Exit& exit) const {
  double crossing = 0;
  const double straight = length_to(window, exit.goal.x(), exit.goal.y(), crossing);
  if (settings_.landmark.empty()) return straight;
  // From x on the edge the goal is no nearer than from an end less the way to the end. |S - x| - x decreases and
  // |S - x| + x increases along the edge, so each bound is least at one end of the window.
  const double by_tail = length_at(window, window.b1) - window.b1 + exit.tail_to_goal;
  const double by_head = length_at(window, window.b0) + window.b0 + exit.head_to_goal - exit.length;
  return std::max({straight, by_tail, by_head});
}

inline void WindowSearch::admit(Window& window, Exit& exit) {
  if (!(window.b1 - window.b0 > kLeastWidth * exit.length)) return;
  if (cut(window, {exit.tail - window.sigma, exit.head - window.sigma}, exit.length).dead) return;
  if (settings_.relative_error > 0 && !cut_within_error(window)) return;
  if (settings_.goal_directed) {
    const double key = goal_key(window, exit);
    if (key > bound_) return;
    exit.key = std::min(exit.key, key);
  } else {
    const double at = std::clamp(window.source_x, window.b0, window.b1);
    if (bound_ < kInfinity && farther(window, at, bound_ - window.sigma)) return;
    // The root is taken only where it lowers the batch's key.
    const double nearest = squared_radius(window, at);
    const double to_beat = exit.key - window.sigma;
    if (to_beat > 0 && nearest < to_beat * to_beat) exit.key = window.sigma + std::sqrt(nearest);
  }
  const std::int32_t i = allocate();
  HalfedgeRecord& record = halfedge_record(exit.halfedge);
  // Field by field: a copy of the whole struct would read back in wide loads what narrow stores have just written.
  Window& slot = pool_[i];
  slot.b0 = window.b0;
  slot.b1 = window.b1;
  slot.source_x = window.source_x;
  slot.depth = window.depth;
  slot.sigma = window.sigma;
  slot.parent = window.parent;
  slot.next = record.pending;
  slot.origin = window.origin;
  slot.halfedge = exit.halfedge;
  record.pending = i;
}

Eigen::Vector2d WindowSearch::goal_in_frame(std::int32_t tail, std::int32_t head, double length) const {
  const Eigen::Vector3d& origin = mesh_->mesh->positions()[tail];
  const Eigen::Vector3d edge = mesh_->mesh->positions()[head] - origin;
  const Eigen::Vector3d relative = goal_ - origin;
  const double along = relative.dot(edge) / length;
  return {along, std::sqrt(std::max(0.0, relative.squaredNorm() - along * along))};
}

WindowSearch::Exit WindowSearch::exit_towards(std::int32_t halfedge, std::int32_t tail, std::int32_t head,
                                              double length, double ux, double uy) {
  Exit exit{halfedge, length, ux, uy, allowed(tail), allowed(head), kInfinity, to_goal(tail), to_goal(head), {0, 0}};
  if (halfedge >= 0 && settings_.goal_directed) exit.goal = goal_in_frame(tail, head, length);
  return exit;
}

void WindowSearch::admit_first(Window& window) {
  const EdgeFrame& frame = mesh_->frames[window.halfedge];
  Exit exit = exit_towards(window.halfedge, frame.tail, frame.head, frame.length, 1, 0);
  admit(window, exit);
  if (exit.key < kInfinity) queue_halfedge(window.halfedge, halfedges_[window.halfedge], exit.key);
}

void WindowSearch::process(std::int32_t h) {
  HalfedgeRecord& record = halfedges_[h];
  const EdgeFrame& frame = mesh_->frames[h];
  batch_.clear();
  // The vertices may have come closer since these windows were cut; cutting them again hardly ever drops one.
  double last = -kInfinity;
  for (std::int32_t i = record.pending; i >= 0; i = pool_[i].next) {
    const double b0 = pool_[i].b0;
    batch_.push_back(i);
    if (b0 >= last) {
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
  const double least_width = kLeastWidth * frame.length;
  const double touching = kTouching * frame.length;
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
  const double per_left = 1 / frame.left_length;
  const double per_right = 1 / frame.right_length;
  Exit left = exit_towards(frame.left, frame.tail, frame.apex, frame.left_length, frame.apex_x * per_left,
                           frame.apex_y * per_left);
  Exit right = exit_towards(frame.right, frame.apex, frame.head, frame.right_length,
                            (frame.length - frame.apex_x) * per_right, frame.apex_y * per_right);
  const bool has_targets = !targets_.empty() && faces_[TriangleMesh::face_of(h)].epoch == epoch_;
  // From the last to the first, so that the children's lists, which grow at the front, come out in order.
  for (std::size_t place = batch_.size(); place-- > 0;) {
    const std::int32_t i = batch_[place];
    const Window window = pool_[i];
    if (!(window.b1 - window.b0 > least_width)) {
      release(i);
      continue;
    }
    if (has_targets) {
      visit_targets(TriangleMesh::face_of(h),
                    [&](SearchTarget& target) { offer_window(*mesh_, sources_, target, h, window, i); });
    }
    propagate(window, i, frame, h, left, right);
    if (settings_.keep_windows) {
      pool_[i].next = halfedges_[h].kept;
      halfedges_[h].kept = i;
    } else {
      release(i);
    }
  }
  if (left.key < kInfinity) queue_halfedge(frame.left, halfedges_[frame.left], left.key);
  if (right.key < kInfinity) queue_halfedge(frame.right, halfedges_[frame.right], right.key);
}

void WindowSearch::propagate(const Window& w, std::int32_t i, const EdgeFrame& frame, std::int32_t h, Exit& left,
                             Exit& right) {
  const double ax = frame.apex_x;
  const double ay = frame.apex_y;
  const double reach = w.depth + ay;
  // Negative where a ray through b passes left of the apex; no division.
  const auto side_of_apex = [&](double b) { return (b - w.source_x) * reach - (ax - w.source_x) * w.depth; };
  const double first = side_of_apex(w.b0);
  const double last = side_of_apex(w.b1);
  const double tolerance = kApexTolerance * frame.length * reach;
  if (first <= tolerance && last >= -tolerance) {
    double crossing = 0;
    const double rounding = kStraight * frame.length * reach;
    if (improve_vertex(frame.apex, length_to(w, ax, ay, crossing), w.sigma, w.source_x, w.depth, h, i, w.origin, -1,
                       first <= rounding && last >= -rounding)) {
      left.head = right.tail = allowed(frame.apex);
    }
  }
  if (left.halfedge >= 0 && first < 0) {
    // Along tail -> apex; a ray through b meets it at this distance from the tail.
    const auto meets = [&](double b) { return w.depth * b / (w.depth * left.ux + (w.source_x - b) * left.uy); };
    Window child;
    child.b0 = w.b0 > 0 ? meets(w.b0) : 0;
    child.b1 = last < 0 ? std::min(meets(w.b1), left.length) : left.length;
    child.source_x = w.source_x * left.ux - w.depth * left.uy;
    child.depth = std::max(0.0, w.source_x * left.uy + w.depth * left.ux);
    child.sigma = w.sigma;
    child.parent = i;
    child.origin = w.origin;
    child.halfedge = left.halfedge;
    admit(child, left);
  }
  if (right.halfedge >= 0 && last > 0) {
    // Along apex -> head; a ray through b meets it at this distance from the head.
    const auto meets = [&](double b) {
      return w.depth * (frame.length - b) / (w.depth * right.ux + (b - w.source_x) * right.uy);
    };
    Window child;
    child.b0 = first > 0 ? std::max(0.0, right.length - meets(w.b0)) : 0;
    child.b1 = w.b1 < frame.length ? right.length - meets(w.b1) : right.length;
    child.source_x = (w.source_x - ax) * right.ux + reach * right.uy;
    child.depth = std::max(0.0, (ax - w.source_x) * right.uy + reach * right.ux);
    child.sigma = w.sigma;
    child.parent = i;
    child.origin = w.origin;
    child.halfedge = right.halfedge;
    admit(child, right);
  }
}

}  // namespace supple::surface
