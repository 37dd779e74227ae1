#include "window_search.h"

#include "supple/base/stop_pace.h"

namespace supple::surface {
namespace {

/// Widths of the queue's buckets, in mean edge lengths. Wider buckets gather larger batches, but waste more work. A
/// search for a pair has narrower ones, because it processes the whole bucket with the target's distance.
constexpr double field_bucket_width = 0.5;
constexpr double goal_bucket_width = 0.03;
/// Numbers of queue entries by which the two stages of prefetching are ahead.
constexpr std::size_t prefetch_far = 6;
constexpr std::size_t prefetch_near = 2;
/// Minimum relative improvement of a vertex's distance; less is rounding.
constexpr double kImprovement = 4e-16;
/// A vertex whose distance improves by this relative amount emits its windows again, because the excess length of the
/// earlier ones has to stay well below kDropTolerance.
constexpr double min_reemission_improvement = 1e-13;
/// Batches between two checks for a stop request. They take well under a millisecond.
constexpr std::int64_t batches_per_checkpoint = 2048;
/// Upper bound of the bytes that a buffer allocates for each window that a search has created.
constexpr std::size_t max_bytes_per_window = 4 * sizeof(Window);

}  // namespace

WindowSearch::WindowSearch(const SearchMesh& mesh) : mesh_(&mesh) {
  const auto halfedges = static_cast<std::size_t>(mesh.mesh->halfedge_count());
  halfedges_.resize(halfedges, HalfedgeRecord{-1, 0, 0, BucketQueue::kNotQueued});
  distances_.resize(static_cast<std::size_t>(mesh.mesh->vertex_count()), Distance{kInfinity, 0});
  vertices_.resize(distances_.size());
  faces_.resize(static_cast<std::size_t>(mesh.mesh->face_count()), FaceRecord{0, -1});
}

VertexRecord& WindowSearch::vertex_record(std::int32_t v) {
  VertexRecord& record = vertices_[v];
  if (distances_[v].epoch != epoch_) {
    distances_[v] = {kInfinity, epoch_};
    ++vertices_reached_;
    record = VertexRecord{};
    record.emits = mesh_->pins(v);
    record.emits_all_around = record.emits && settings_.relative_error > 0;
  }
  return record;
}

void WindowSearch::release(std::int32_t window) {
  pool_[window].link = first_free_;
  first_free_ = window;
}

void WindowSearch::register_target(std::int32_t face, std::int32_t target) {
  FaceRecord& record = faces_[face];
  if (record.epoch != epoch_) record = {epoch_, -1};
  target_links_.push_back({target, record.first_link});
  record.first_link = static_cast<std::int32_t>(target_links_.size()) - 1;
}

void WindowSearch::start(std::span<const SurfacePoint> sources, std::span<SearchTarget> targets,
                         const SearchSettings& settings) {
  if (++epoch_ == 0) {
    // The counter has wrapped around: records of 2^32 searches ago would seem current.
    for (HalfedgeRecord& r : halfedges_) r.epoch = 0;
    for (Distance& d : distances_) d.epoch = 0;
    for (FaceRecord& r : faces_) r.epoch = 0;
    epoch_ = 1;
  }
  pool_.clear();
  first_free_ = -1;
  trails_.clear();
  target_links_.clear();
  ties_.clear();
  windows_created_ = 0;
  batches_ = 0;
  vertices_reached_ = 0;
  sources_.assign(sources.begin(), sources.end());
  targets_ = targets;
  settings_ = settings;
  records_trails_ = settings.keep_windows || !targets.empty();
  max_key_ = settings.limit;
  edge_rounding_ = kEdgeRounding * mesh_->longest_edge;
  near_vertices_ = mesh_->has_needles;
  for (const SurfacePoint& source : sources_) {
    near_vertices_ = near_vertices_ || (corner_of(source) < 0 && source.barycentric.maxCoeff() > 1 - short_side_ratio);
  }
  plain_ = !settings.goal_directed && settings.relative_error == 0 && settings.limit == kInfinity && !near_vertices_;
  first_uncertain_ = 0;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const SearchTarget& target = targets[i];
    if (target.vertex < 0) {
      register_target(index(target.point.face), static_cast<std::int32_t>(i));
    } else {
      const std::int32_t first = mesh_->mesh->outgoing(target.vertex);
      std::int32_t h = first;
      do {
        register_target(TriangleMesh::face_of(h), static_cast<std::int32_t>(i));
        h = mesh_->mesh->rotate(h);
      } while (h >= 0 && h != first);
    }
  }
  double first_key = 0;
  if (settings.goal_directed) {
    const SurfacePoint& goal = targets[0].point;
    const std::int32_t goal_corner = nearest_corner(*mesh_->mesh, goal);
    goal_corner_ = mesh_->mesh->positions()[goal_corner];
    goal_offset_ = offset_from(*mesh_->mesh, goal, goal_corner);
    const std::int32_t source_corner = nearest_corner(*mesh_->mesh, sources_[0]);
    const Eigen::Vector3d source_offset = offset_from(*mesh_->mesh, sources_[0], source_corner);
    first_key = (vector_to_goal(source_corner) - source_offset).norm();
    if (!settings.landmark.empty()) {
      for (const std::int32_t v : mesh_->mesh->faces()[index(sources_[0].face)]) {
        const double source_to_corner = offset_from(*mesh_->mesh, sources_[0], v).norm();
        first_key = std::max(first_key, min_distance_to_goal(v) - source_to_corner);
      }
    }
  }
  for (std::size_t v = 0; v < settings.known_distances.size(); ++v) {
    if (!(settings.known_distances[v] < kInfinity)) continue;
    vertex_record(static_cast<std::int32_t>(v)).origin = -1 - static_cast<std::int32_t>(sources.size());
    distances_[v].value = settings.known_distances[v];
  }
  queue_.start(first_key,
               mesh_->mesh->mean_edge_length() * (settings.goal_directed ? goal_bucket_width : field_bucket_width));
}

void WindowSearch::update_by_corners(SearchTarget& target) {
  const Triangle& corners = mesh_->mesh->faces()[index(target.point.face)];
  for (int i = 0; i < 3; ++i) {
    const double d = distance(corners[i]);
    if (d < kInfinity) update_by_vertex(*mesh_, target, i, d, vertices_[corners[i]]);
  }
}

double WindowSearch::max_useful_key(double length) const {
  return length * (1 + kTieTolerance) + kEdgeRounding * mesh_->longest_edge;
}

bool WindowSearch::all_certain() {
  if (targets_.empty()) return false;
  const double min_queued_key = queue_.min_key();
  while (first_uncertain_ < targets_.size()) {
    SearchTarget& target = targets_[first_uncertain_];
    if (target.best.length > min_queued_key || settings_.goal_directed) {
      update_by_corners(target);
    }
    const double max_key = max_useful_key(target.best.length);
    if (settings_.goal_directed) max_key_ = std::min(max_key_, max_key);
    if (max_key > min_queued_key) return false;
    ++first_uncertain_;
  }
  return true;
}

void WindowSearch::run(std::span<const SurfacePoint> sources, std::span<SearchTarget> targets,
                       const SearchSettings& settings, const Execution& execution) {
  cancellation_ = &execution.cancellation;
  start(sources, targets, settings);
  StopPace pace(execution.cancellation);
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    pace.look();
    emit_from_source(static_cast<std::int32_t>(i));
  }
  std::int32_t item = 0;
  BucketQueue::Bucket bucket = 0;
  BucketQueue::Bucket last_checked_bucket = -1;
  while (queue_.pop(item, bucket)) {
    if (bucket != last_checked_bucket || settings_.goal_directed) {
      last_checked_bucket = bucket;
      if (all_certain() || queue_.min_key() > max_key_) break;
    }
    prefetch();
    if (item >= 0) {
      HalfedgeRecord& record = halfedges_[item];
      if (record.queued != bucket) continue;
      record.queued = BucketQueue::kNotQueued;
      process(item);
      if (++batches_ % batches_per_checkpoint == 0) {
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
    update_by_corners(target);
  }
}

void WindowSearch::report_progress(const Execution& execution) const {
  // A search with targets may end early, so that its progress is not known.
  if (!execution.progress || !targets_.empty()) return;
  execution.progress->report(static_cast<double>(vertices_reached_) / static_cast<double>(vertices_.size()), "search");
}

void WindowSearch::prefetch() const {
  // The addresses for the second stage are in the memory that the first stage fetches.
  constexpr std::int32_t none = std::numeric_limits<std::int32_t>::max();
  const std::int32_t far = queue_.upcoming(prefetch_far, none);
  const std::int32_t near = queue_.upcoming(prefetch_near, none);
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

void WindowSearch::take_logged_windows(std::vector<VertexRecord>& records, LargeVector<Window>& windows,
                                       std::vector<std::int32_t>& first) {
  // The windows are sorted by halfedge. Each entry of `first` begins as the end of its halfedge's windows and is
  // counted down to their beginning, so that the last window comes first.
  first.resize(halfedges_.size() + 1);
  std::int32_t end = 0;
  for (std::size_t h = 0; h < halfedges_.size(); ++h) {
    if (halfedges_[h].epoch == epoch_) end += halfedges_[h].logged;
    first[h] = end;
  }
  first[halfedges_.size()] = end;
  const double to_length = 1 + settings_.relative_error;
  windows.resize(logged_.size());
  logged_.drain(max_retained_buffer_bytes, [&](const Window& window) {
    Window& copy = windows[--first[window.link]];
    copy = window;
    copy.sigma *= to_length;
  });
  records.resize(vertices_.size());
  for (std::size_t v = 0; v < vertices_.size(); ++v) records[v] = vertex_record(static_cast<std::int32_t>(v));
}

void WindowSearch::give_back_memory() {
  if (static_cast<std::size_t>(windows_created_) * max_bytes_per_window <= max_retained_buffer_bytes &&
      logged_.size() == 0)
    return;
  if (pool_.capacity() * sizeof(Window) > max_retained_buffer_bytes) LargeVector<Window>().swap(pool_);
  if (trails_.capacity() * sizeof(Trail) > max_retained_buffer_bytes) std::vector<Trail>().swap(trails_);
  logged_.drain(max_retained_buffer_bytes, [](const Window&) {});
  queue_.give_back_memory(max_retained_buffer_bytes);
}

std::size_t WindowSearch::buffer_bytes() const {
  return pool_.capacity() * sizeof(Window) + trails_.capacity() * sizeof(Trail) + logged_.memory_bytes() +
         queue_.memory_bytes();
}

std::size_t WindowSearch::memory_bytes() const {
  return buffer_bytes() + halfedges_.capacity() * sizeof(HalfedgeRecord) + distances_.capacity() * sizeof(Distance) +
         vertices_.capacity() * sizeof(VertexRecord) + faces_.capacity() * sizeof(FaceRecord);
}

void WindowSearch::queue_halfedge(std::int32_t h, HalfedgeRecord& record, double key) {
  const BucketQueue::Bucket bucket = queue_.bucket_of(key);
  if (record.queued <= bucket) return;
  record.queued = bucket;
  queue_.push(h, bucket);
}

void WindowSearch::queue_vertex(std::int32_t v, VertexRecord& record) {
  double key = distances_[v].value;
  if (settings_.goal_directed) key += std::max(min_distance_to_goal(v), vector_to_goal(v).norm());
  if (key > max_key_) return;
  const BucketQueue::Bucket bucket = queue_.bucket_of(key);
  if (record.queued <= bucket) return;
  record.queued = bucket;
  queue_.push(~v, bucket);
}

bool WindowSearch::improve_vertex(std::int32_t v, double distance, double sigma, double source_x, double depth,
                                  std::int32_t halfedge, Trail trail, std::int32_t origin, std::int32_t along,
                                  double crossing, bool straight) {
  VertexRecord& record = vertex_record(v);
  double& current = distances_[v].value;
  const bool improves = distance < current * (1 - kImprovement);
  const bool ties = distance < current * (1 + kDropTolerance) && distance > current * (1 - kDropTolerance);
  bool replaces = improves;
  if (ties && current > 0) {
    // Among paths of equal length, the one whose last segment is longest is recorded, so that a vertex on a straight
    // path does not seem to pin it.
    const bool straighter = along < 0 && straight && (record.along >= 0 || sigma < record.sigma * (1 - kDropTolerance));
    replaces = straighter || (improves && along >= 0 && record.along >= 0);
  }
  bool must_emit = false;
  if (record.emits && !record.emits_all_around && both_shortest(distance, current)) {
    const VertexRecord path{.sigma = sigma, .source_x = source_x, .depth = depth, .halfedge = halfedge, .along = along};
    must_emit = note_tie(v, path, distance, replaces);
    if (distance < current * (1 - min_reemission_improvement)) {
      record.emitted = false;
      for (std::int32_t i = record.ties; i >= 0; i = ties_[i].next) ties_[i].emitted = false;
      must_emit = true;
    }
  } else if (improves) {
    record.emitted = false;
    record.ties = -1;
    must_emit = record.emits && replaces;
  }
  if (!replaces) {
    if (improves) current = distance;
    if (must_emit) queue_vertex(v, record);
    return false;
  }
  current = std::min(current, distance);
  record.sigma = sigma;
  record.source_x = source_x;
  record.depth = depth;
  record.crossing = crossing;
  record.trail = trail;
  record.halfedge = halfedge;
  record.origin = origin;
  record.along = along;
  if (improves && record.emits_all_around) make_pseudo_source(v);
  if (must_emit) queue_vertex(v, record);
  return improves;
}

bool WindowSearch::note_tie(std::int32_t v, const VertexRecord& path, double length, bool replaces) {
  VertexRecord& record = vertices_[v];
  const bool is_source = record.halfedge < 0 && record.along < 0;
  if (is_source) return false;
  if (path.along >= 0 ? path.along == record.along
                      : path.halfedge == record.halfedge &&
                            std::abs(path.source_x - record.source_x) + std::abs(path.depth - record.depth) <=
                                kSectorTolerance * path.depth) {
    return false;
  }
  const double total = mesh_->mesh->vertex_angle(v);
  const double full_turn = mesh_->mesh->is_boundary(v) ? kInfinity : total;
  const auto apart = [&](double a, double b) {
    const double turn = std::abs(a - b);
    return std::min(turn, full_turn - turn) > kSectorTolerance;
  };
  const double recorded = arrival_angle(*mesh_, record, v);
  const double angle = arrival_angle(*mesh_, path, v);
  if (!apart(angle, recorded)) return false;
  const double noted = replaces ? recorded : angle;
  bool is_noted = false;
  for (std::int32_t i = record.ties; i >= 0; i = ties_[i].next) is_noted = is_noted || !apart(ties_[i].angle, noted);
  if (!is_noted) {
    ties_.push_back({noted, replaces ? distances_[v].value : length, replaces && record.emitted, record.ties});
    record.ties = static_cast<std::int32_t>(ties_.size()) - 1;
  }
  if (replaces) record.emitted = false;
  return replaces || (!is_noted && within_drop_tolerance(length, distances_[v].value));
}

void WindowSearch::make_pseudo_source(std::int32_t v) {
  VertexRecord& record = vertices_[v];
  const double weight = length_of_path(v) / (1 + settings_.relative_error);
  record.emits_all_around = record.emits = true;
  record.sigma = distances_[v].value = weight;
}

}  // namespace supple::surface
