#include "search_front.h"

namespace supple::surface {
namespace {

/// Widths of the queue's buckets, in mean edge lengths. In wider buckets more windows are processed together, but more
/// work is wasted. A search for a pair has narrower ones, because work in its last bucket beyond the target is wasted.
constexpr double field_bucket_width = 0.5;
constexpr double goal_bucket_width = 0.03;

}  // namespace

SearchFront::SearchFront(const SearchMesh& its_mesh) : mesh(&its_mesh), vertices(its_mesh), targets(*its_mesh.mesh) {
  halfedges.resize(static_cast<std::size_t>(mesh->mesh->halfedge_count()),
                   HalfedgeRecord{-1, 0, 0, BucketQueue::not_queued});
}

void SearchFront::start(std::span<const SurfacePoint> from, std::span<SearchTarget> to, const SearchSettings& how) {
  if (++epoch == 0) {
    // The counter has wrapped around: records of 2^32 searches ago would seem current.
    for (HalfedgeRecord& record : halfedges) record.epoch = 0;
    epoch = 1;
  }
  settings = how;
  sources.assign(from.begin(), from.end());
  vertices.start(epoch, settings.relative_error);
  targets.start(epoch, to);
  pool.clear();
  trails.clear();
  records_trails = settings.keep_windows || !to.empty();
  max_key = settings.limit;
  near_vertices = mesh->has_needles;
  for (const SurfacePoint& source : sources) {
    near_vertices = near_vertices || (corner_of(source) < 0 && source.barycentric.maxCoeff() > 1 - short_side_ratio);
  }
  plain = !settings.goal_directed && settings.relative_error == 0 && settings.limit == infinity && !near_vertices;
  double first_key = 0;
  if (settings.goal_directed) {
    goal.start(*mesh, to[0].point, settings.landmark, settings.landmark_distance);
    first_key = goal.min_distance_of(sources[0]);
  } else {
    goal.clear();
  }
  for (std::size_t v = 0; v < settings.known_distances.size(); ++v) {
    if (!(settings.known_distances[v] < infinity)) continue;
    vertices.set_known(static_cast<std::int32_t>(v), settings.known_distances[v],
                       -1 - static_cast<std::int32_t>(sources.size()));
  }
  queue.start(first_key,
              mesh->mesh->mean_edge_length() * (settings.goal_directed ? goal_bucket_width : field_bucket_width));
}

void SearchFront::queue_halfedge(std::int32_t h, HalfedgeRecord& record, double key) {
  const BucketQueue::Bucket bucket = queue.bucket_of(key);
  if (record.queued <= bucket) return;
  record.queued = bucket;
  queue.push(h, bucket);
}

void SearchFront::queue_vertex(std::int32_t v) {
  double key = vertices.distance(v);
  if (settings.goal_directed) key += goal.min_distance(v);
  if (key > max_key) return;
  const BucketQueue::Bucket bucket = queue.bucket_of(key);
  VertexRecord& record = vertices.reached(v);
  if (record.queued <= bucket) return;
  record.queued = bucket;
  queue.push(~v, bucket);
}

}  // namespace supple::surface
