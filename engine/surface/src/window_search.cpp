#include "window_search.h"

#include "supple/base/stop_pace.h"

namespace supple::surface {
namespace {

/// Bucket width over mean edge length. Wider buckets gather larger batches and waste more work out of order; a search
/// for a pair goes through the whole bucket that the target's distance lies in.
constexpr double kFieldBucket = 0.5;
constexpr double kGoalBucket = 0.03;
/// How many queue entries ahead memory is asked for.
constexpr std::size_t kPrefetchFar = 6;
constexpr std::size_t kPrefetchNear = 2;
/// Smallest relative improvement of a vertex: less is rounding.
constexpr double kImprovement = 4e-16;
/// A vertex that improves by this much, relative, sends its windows again: what they are too long by has to stay well
/// below kDropTolerance.
constexpr double kSentAgain = 1e-13;
/// Batches between looks at the cancellation flag (well under a millisecond).
constexpr std::int64_t kBatchesPerCheckpoint = 2048;
/// No buffer holds more than this for each window that a search has made, spare room included.
constexpr std::size_t kBytesPerWindow = 4 * sizeof(Window);

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
    record.everywhere = record.emits && settings_.relative_error > 0;
  }
  return record;
}

void WindowSearch::release(std::int32_t window) {
  pool_[window].link = free_;
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
  trails_.clear();
  hooks_.clear();
  ties_.clear();
  windows_created_ = 0;
  batches_ = 0;
  vertices_reached_ = 0;
  sources_.assign(sources.begin(), sources.end());
  targets_ = targets;
  settings_ = settings;
  follows_paths_ = settings.keep_windows || !targets.empty();
  bound_ = settings.limit;
  edge_rounding_ = kEdgeRounding * mesh_->longest_edge;
  close_ = mesh_->has_needles;
  for (const SurfacePoint& source : sources_) {
    close_ = close_ || (corner_of(source) < 0 && source.barycentric.maxCoeff() > 1 - kShortSide);
  }
  plain_ = !settings.goal_directed && settings.relative_error == 0 && settings.limit == kInfinity && !close_;
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
    const SurfacePoint& goal = targets[0].point;
    const std::int32_t goal_corner = nearest_corner(*mesh_->mesh, goal);
    goal_corner_ = mesh_->mesh->positions()[goal_corner];
    goal_offset_ = offset_from(*mesh_->mesh, goal, goal_corner);
    const std::int32_t source_corner = nearest_corner(*mesh_->mesh, sources_[0]);
    const Eigen::Vector3d source_offset = offset_from(*mesh_->mesh, sources_[0], source_corner);
    first_key = (goal_from(source_corner) - source_offset).norm();
    if (!settings.landmark.empty()) {
      for (const std::int32_t v : mesh_->mesh->faces()[index(sources_[0].face)]) {
        const double away = offset_from(*mesh_->mesh, sources_[0], v).norm();
        first_key = std::max(first_key, to_goal(v) - away);
      }
    }
  }
  for (std::size_t v = 0; v < settings.known.size(); ++v) {
    if (!(settings.known[v] < kInfinity)) continue;
    vertex_record(static_cast<std::int32_t>(v)).origin = -1 - static_cast<std::int32_t>(sources.size());
    distances_[v].value = settings.known[v];
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

double WindowSearch::beyond(double length) const {
  return length * (1 + kTieTolerance) + kEdgeRounding * mesh_->longest_edge;
}

bool WindowSearch::settled() {
  if (targets_.empty()) return false;
  const double certain = queue_.least_key();
  while (uncertain_ < targets_.size()) {
    SearchTarget& target = targets_[uncertain_];
    if (target.best.length > certain || settings_.goal_directed) {
      offer_corners(target);
    }
    const double enough = beyond(target.best.length);
    if (settings_.goal_directed) bound_ = std::min(bound_, enough);
    if (enough > certain) return false;
    ++uncertain_;
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

void WindowSearch::take_kept(std::vector<VertexRecord>& records, LargeVector<Window>& windows,
                             std::vector<std::int32_t>& first) {
  // Sorted by halfedge: each place begins as the end of its halfedge's windows and is counted down to their beginning,
  // so that the last window comes first.
  first.resize(halfedges_.size() + 1);
  std::int32_t end = 0;
  for (std::size_t h = 0; h < halfedges_.size(); ++h) {
    if (halfedges_[h].epoch == epoch_) end += halfedges_[h].kept;
    first[h] = end;
  }
  first[halfedges_.size()] = end;
  const double to_length = 1 + settings_.relative_error;
  windows.resize(kept_.size());
  kept_.drain(kMostKept, [&](const Window& window) {
    Window& copy = windows[--first[window.link]];
    copy = window;
    copy.sigma *= to_length;
  });
  records.resize(vertices_.size());
  for (std::size_t v = 0; v < vertices_.size(); ++v) records[v] = vertex_record(static_cast<std::int32_t>(v));
}

void WindowSearch::give_back_memory() {
  if (static_cast<std::size_t>(windows_created_) * kBytesPerWindow <= kMostKept && kept_.size() == 0) return;
  if (pool_.capacity() * sizeof(Window) > kMostKept) LargeVector<Window>().swap(pool_);
  if (trails_.capacity() * sizeof(Trail) > kMostKept) std::vector<Trail>().swap(trails_);
  kept_.drain(kMostKept, [](const Window&) {});
  queue_.give_back_memory(kMostKept);
}

std::size_t WindowSearch::buffer_bytes() const {
  return pool_.capacity() * sizeof(Window) + trails_.capacity() * sizeof(Trail) + kept_.memory_bytes() +
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
  if (settings_.goal_directed) key += std::max(to_goal(v), goal_from(v).norm());
  if (key > bound_) return;
  const BucketQueue::Bucket bucket = queue_.bucket_of(key);
  if (record.queued <= bucket) return;
  record.queued = bucket;
  queue_.push(~v, bucket);
}

bool WindowSearch::improve_vertex(std::int32_t v, double distance, double sigma, double source_x, double depth,
                                  std::int32_t halfedge, Trail trail, std::int32_t origin, std::int32_t along,
                                  double crossing, bool straight) {
  VertexRecord& record = vertex_record(v);
  double& known = distances_[v].value;
  const bool improves = distance < known * (1 - kImprovement);
  const bool ties = distance < known * (1 + kDropTolerance) && distance > known * (1 - kDropTolerance);
  bool replaces = improves;
  if (ties && known > 0) {
    // Of ways of equal length the one that has been straight for longest is kept: a vertex on it then does not seem to
    // pin the path.
    const bool straighter = along < 0 && straight && (record.along >= 0 || sigma < record.sigma * (1 - kDropTolerance));
    replaces = straighter || (improves && along >= 0 && record.along >= 0);
  }
  bool to_send = false;
  if (record.emits && !record.everywhere && both_shortest(distance, known)) {
    const VertexRecord path{.sigma = sigma, .source_x = source_x, .depth = depth, .halfedge = halfedge, .along = along};
    to_send = note_tie(v, path, distance, replaces);
    if (distance < known * (1 - kSentAgain)) {
      record.sent = false;
      for (std::int32_t i = record.ties; i >= 0; i = ties_[i].next) ties_[i].sent = false;
      to_send = true;
    }
  } else if (improves) {
    record.sent = false;
    record.ties = -1;
    to_send = record.emits && replaces;
  }
  if (!replaces) {
    if (improves) known = distance;
    if (to_send) queue_vertex(v, record);
    return false;
  }
  known = std::min(known, distance);
  record.sigma = sigma;
  record.source_x = source_x;
  record.depth = depth;
  record.crossing = crossing;
  record.trail = trail;
  record.halfedge = halfedge;
  record.origin = origin;
  record.along = along;
  if (improves && record.everywhere) become_source(v);
  if (to_send) queue_vertex(v, record);
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
  const double whole = mesh_->mesh->is_boundary(v) ? kInfinity : total;
  const auto apart = [&](double a, double b) {
    const double turn = std::abs(a - b);
    return std::min(turn, whole - turn) > kSectorTolerance;
  };
  const double recorded = arrival_angle(*mesh_, record, v);
  const double angle = arrival_angle(*mesh_, path, v);
  if (!apart(angle, recorded)) return false;
  const double noted = replaces ? recorded : angle;
  bool known = false;
  for (std::int32_t i = record.ties; i >= 0; i = ties_[i].next) known = known || !apart(ties_[i].angle, noted);
  if (!known) {
    ties_.push_back({noted, replaces ? distances_[v].value : length, replaces && record.sent, record.ties});
    record.ties = static_cast<std::int32_t>(ties_.size()) - 1;
  }
  if (replaces) record.sent = false;
  return replaces || (!known && within_cut(length, distances_[v].value));
}

void WindowSearch::become_source(std::int32_t v) {
  VertexRecord& record = vertices_[v];
  const double weight = length_of_path(v) / (1 + settings_.relative_error);
  record.everywhere = record.emits = true;
  record.sigma = distances_[v].value = weight;
}

}  // namespace supple::surface
