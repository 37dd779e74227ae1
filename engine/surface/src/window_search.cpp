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
    record = {0, 0, -1, -1, -1, -1, BucketQueue::kNotQueued, mesh_->pins(v)};
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
    if (item >= 0) {
      HalfedgeRecord& record = halfedges_[item];
      if (record.queued != bucket) continue;
      record.queued = BucketQueue::kNotQueued;
      process(item);
      if (++batches_ % kBatchesPerCheckpoint == 0) execution.cancellation.throw_if_requested();
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

void WindowSearch::move_into(std::vector<VertexRecord>& records, std::vector<Window>& windows,
                             std::vector<std::int32_t>& first) {
  records.resize(vertices_.size());
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    records[v] = vertex_record(static_cast<std::int32_t>(v));
  }
  first.resize(halfedges_.size());
  for (std::size_t h = 0; h < halfedges_.size(); ++h) {
    first[h] = halfedges_[h].epoch == epoch_ ? halfedges_[h].kept : -1;
  }
  pool_.shrink_to_fit();
  windows = std::move(pool_);
  pool_ = {};
}

void WindowSearch::queue_halfedge(std::int32_t h, HalfedgeRecord& record, double key) {
  const BucketQueue::Bucket bucket = queue_.bucket_of(key);
  if (record.queued <= bucket) return;
  record.queued = bucket;
  queue_.push(h, bucket);
}

void WindowSearch::queue_vertex(std::int32_t v, VertexRecord& record) {
  double key = distances_[v].value;
  if (settings_.goal_directed) key += (mesh_->mesh->positions()[v] - goal_).norm();
  if (key > bound_) return;
  const BucketQueue::Bucket bucket = queue_.bucket_of(key);
  if (record.queued <= bucket) return;
  record.queued = bucket;
  queue_.push(~v, bucket);
}

bool WindowSearch::improve_vertex(std::int32_t v, double distance, double source_x, double depth,
                                  std::int32_t halfedge, std::int32_t window, std::int32_t origin,
                                  std::int32_t along) {
  VertexRecord& record = vertex_record(v);
  double& known = distances_[v].value;
  if (!(distance < known * (1 - kImprovement))) return false;
  known = distance;
  record.source_x = source_x;
  record.depth = depth;
  record.halfedge = halfedge;
  record.window = window;
  record.origin = origin;
  record.along = along;
  if (record.emits) queue_vertex(v, record);
  return true;
}

inline VertexBounds WindowSearch::bounds(const Window& window, const EdgeFrame& frame, double shrink) const {
  const double tail = distance(frame.tail);
  const double head = distance(frame.head);
  return {(tail * (1 + kDropTolerance) - window.sigma) * shrink, (head * (1 + kDropTolerance) - window.sigma) * shrink};
}

bool WindowSearch::cut_within_error(Window& window, const EdgeFrame& frame) {
  const Cut result = cut(window, bounds(window, frame, 1 / (1 + settings_.relative_error)), frame.length);
  for (const auto& [by, v] : {std::pair{result.by_tail, frame.tail}, std::pair{result.by_head, frame.head}}) {
    if (!by) continue;
    VertexRecord& record = vertex_record(v);
    if (record.emits) continue;
    record.emits = true;
    queue_vertex(v, record);
  }
  return !result.dead;
}

inline void WindowSearch::admit(Window& window, const EdgeFrame& frame, const Eigen::Vector2d& goal, double& key) {
  if (!(window.b1 - window.b0 > kLeastWidth * frame.length)) return;
  window.r0 = radius(window, window.b0);
  window.r1 = radius(window, window.b1);
  if (cut(window, bounds(window, frame, 1), frame.length).dead) return;
  if (settings_.relative_error > 0 && !cut_within_error(window, frame)) return;
  double window_key = 0;
  if (settings_.goal_directed) {
    double crossing = 0;
    window_key = length_to(window, goal.x(), goal.y(), crossing);
  } else {
    window_key = least_length(window);
  }
  if (window_key > bound_) return;
  key = std::min(key, window_key);
  const std::int32_t h = window.halfedge;
  const std::int32_t i = allocate();
  HalfedgeRecord& record = halfedge_record(h);
  // Field by field: a copy of the whole struct would read back in wide loads what narrow stores have just written.
  Window& slot = pool_[i];
  slot.b0 = window.b0;
  slot.b1 = window.b1;
  slot.source_x = window.source_x;
  slot.depth = window.depth;
  slot.r0 = window.r0;
  slot.r1 = window.r1;
  slot.sigma = window.sigma;
  slot.parent = window.parent;
  slot.next = record.pending;
  slot.origin = window.origin;
  slot.halfedge = h;
  record.pending = i;
}

Eigen::Vector2d WindowSearch::goal_in_frame(std::int32_t tail, std::int32_t head, double length) const {
  const Eigen::Vector3d& origin = mesh_->mesh->positions()[tail];
  const Eigen::Vector3d edge = mesh_->mesh->positions()[head] - origin;
  const Eigen::Vector3d relative = goal_ - origin;
  const double along = relative.dot(edge) / length;
  return {along, std::sqrt(std::max(0.0, relative.squaredNorm() - along * along))};
}

void WindowSearch::admit_first(Window& window) {
  const EdgeFrame& frame = mesh_->frames[window.halfedge];
  Eigen::Vector2d goal = Eigen::Vector2d::Zero();
  if (settings_.goal_directed) goal = goal_in_frame(frame.tail, frame.head, frame.length);
  double key = kInfinity;
  admit(window, frame, goal, key);
  if (key < kInfinity) queue_halfedge(window.halfedge, halfedges_[window.halfedge], key);
}

void WindowSearch::process(std::int32_t h) {
  HalfedgeRecord& record = halfedges_[h];
  const EdgeFrame& frame = mesh_->frames[h];
  batch_.clear();
  if (frame.left >= 0) __builtin_prefetch(&mesh_->frames[frame.left]);
  if (frame.right >= 0) __builtin_prefetch(&mesh_->frames[frame.right]);
  __builtin_prefetch(&distances_[frame.apex]);
  for (std::int32_t i = record.pending; i >= 0;) {
    Window& window = pool_[i];
    const std::int32_t next = window.next;
    // The vertices may have come closer since the window was cut.
    if (cut(window, bounds(window, frame, 1), frame.length).dead) {
      release(i);
    } else {
      std::size_t place = batch_.size();
      batch_.push_back(i);
      while (place > 0 && pool_[batch_[place - 1]].b0 > window.b0) {
        batch_[place] = batch_[place - 1];
        --place;
      }
      batch_[place] = i;
    }
    i = next;
  }
  record.pending = -1;
  for (std::size_t i = 1; i < batch_.size(); ++i) {
    Window& window = pool_[batch_[i]];
    for (std::size_t j = i; j-- > 0;) {
      Window& before = pool_[batch_[j]];
      if (before.b1 <= before.b0) continue;
      if (before.b1 <= window.b0) break;
      trim_to_envelope(before, window);
      if (window.b1 <= window.b0) break;
    }
  }
  if (settings_.goal_directed && frame.left >= 0) left_goal_ = goal_in_frame(frame.tail, frame.apex, frame.left_length);
  if (settings_.goal_directed && frame.right >= 0) {
    right_goal_ = goal_in_frame(frame.apex, frame.head, frame.right_length);
  }
  double left_key = kInfinity;
  double right_key = kInfinity;
  const double least_width = kLeastWidth * frame.length;
  // From the last to the first, so that the children's lists, which grow at the front, come out in order.
  for (std::size_t place = batch_.size(); place-- > 0;) {
    const std::int32_t i = batch_[place];
    const Window window = pool_[i];
    if (!(window.b1 - window.b0 > least_width)) {
      release(i);
      continue;
    }
    visit_targets(TriangleMesh::face_of(h),
                  [&](SearchTarget& target) { offer_window(*mesh_, target, h, window, i); });
    propagate(window, i, frame, h, left_key, right_key);
    if (settings_.keep_windows) {
      pool_[i].next = halfedges_[h].kept;
      halfedges_[h].kept = i;
    } else {
      release(i);
    }
  }
  if (left_key < kInfinity) queue_halfedge(frame.left, halfedges_[frame.left], left_key);
  if (right_key < kInfinity) queue_halfedge(frame.right, halfedges_[frame.right], right_key);
}

void WindowSearch::propagate(const Window& w, std::int32_t i, const EdgeFrame& frame, std::int32_t h, double& left_key,
                             double& right_key) {
  const double length = frame.length;
  const double ax = frame.apex_x;
  const double ay = frame.apex_y;
  const double reach = w.depth + ay;
  // Where the ray to the apex crosses the edge.
  const double split = w.source_x + (ax - w.source_x) * (w.depth / reach);
  const double tolerance = kApexTolerance * length;
  if (split >= w.b0 - tolerance && split <= w.b1 + tolerance) {
    double crossing = 0;
    improve_vertex(frame.apex, length_to(w, ax, ay, crossing), w.source_x, w.depth, h, i, w.origin, -1);
  }
  Window child;
  child.sigma = w.sigma;
  child.parent = i;
  child.origin = w.origin;
  if (frame.left >= 0 && w.b0 < split) {
    // Along tail -> apex; a ray through b meets it at the returned distance from the tail.
    const double scale = frame.left_length * w.depth;
    const auto meets = [&](double b) { return scale * b / (w.depth * ax + (w.source_x - b) * ay); };
    child.b0 = w.b0 > 0 ? meets(w.b0) : 0;
    child.b1 = w.b1 < split ? std::min(meets(w.b1), frame.left_length) : frame.left_length;
    child.source_x = (w.source_x * ax - w.depth * ay) / frame.left_length;
    child.depth = std::max(0.0, (w.source_x * ay + w.depth * ax) / frame.left_length);
    child.halfedge = frame.left;
    admit(child, mesh_->frames[frame.left], left_goal_, left_key);
  }
  if (frame.right >= 0 && w.b1 > split) {
    // Along apex -> head, measured from the head.
    const double side_x = length - ax;
    const double scale = frame.right_length * w.depth;
    const auto meets = [&](double b) { return scale * (length - b) / (w.depth * side_x + (b - w.source_x) * ay); };
    child.b0 = w.b0 > split ? std::max(0.0, frame.right_length - meets(w.b0)) : 0;
    child.b1 = w.b1 < length ? frame.right_length - meets(w.b1) : frame.right_length;
    child.source_x = ((w.source_x - ax) * side_x + reach * ay) / frame.right_length;
    child.depth = std::max(0.0, ((ax - w.source_x) * ay + reach * side_x) / frame.right_length);
    child.halfedge = frame.right;
    admit(child, mesh_->frames[frame.right], right_goal_, right_key);
  }
}

}  // namespace supple::surface
