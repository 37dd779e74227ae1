#include "edge_graph.h"

#include "bucket_queue.h"
#include "vertex_table.h"

namespace supple::surface {
namespace {

constexpr std::int64_t vertices_per_checkpoint = 8192;

}  // namespace

EdgeGraphField edge_graph_field(const SearchMesh& mesh, std::span<const SurfacePoint> sources, double limit,
                                const Execution& execution) {
  const TriangleMesh& m = *mesh.mesh;
  EdgeGraphField field;
  std::vector<double>& distances = field.distances;
  distances.assign(static_cast<std::size_t>(m.vertex_count()), infinity);
  field.vertex_sources.assign(distances.size(), -1);
  std::vector<BucketQueue::Bucket> queued(distances.size(), BucketQueue::not_queued);
  BucketQueue queue;
  // With buckets of half a mean edge, most vertices are settled once. The others are corrected.
  queue.start(0, 0.5 * m.mean_edge_length());
  const auto improve = [&](std::int32_t v, double distance, std::int32_t source) {
    if (!(distance < distances[v]) || distance > limit) return;
    distances[v] = distance;
    field.vertex_sources[v] = source;
    const BucketQueue::Bucket bucket = queue.bucket_of(distance);
    if (queued[v] <= bucket) return;
    queued[v] = bucket;
    queue.push(v, bucket);
  };
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const Eigen::Vector3d p = position(m, sources[i]);
    for (const std::int32_t v : m.faces()[index(sources[i].face)])
      improve(v, (m.positions()[v] - p).norm(), static_cast<std::int32_t>(i));
  }
  std::int32_t v = 0;
  BucketQueue::Bucket bucket = 0;
  std::int64_t settled = 0;
  while (queue.pop(v, bucket)) {
    if (queued[v] != bucket) continue;
    queued[v] = BucketQueue::not_queued;
    if (++settled % vertices_per_checkpoint == 0) execution.cancellation.throw_if_requested();
    const double distance = distances[v];
    const std::int32_t source = field.vertex_sources[v];
    const std::int32_t first = m.outgoing(v);
    std::int32_t corner = first;
    do {
      const std::int32_t opposite = TriangleMesh::next(corner);
      const EdgeFrame& frame = mesh.frames[opposite];  // v is its apex
      improve(frame.tail, distance + frame.left_length, source);
      improve(frame.head, distance + frame.right_length, source);
      if (const std::int32_t across = m.twin(opposite); across >= 0) {
        const EdgeFrame& other = mesh.frames[across];
        const double x = frame.right_x();  // v in the other face's frame is (x, -apex_y)
        const double height = frame.apex_y + other.apex_y;
        const double crossing = x + (other.apex_x() - x) * frame.apex_y / height;
        if (crossing > 0 && crossing < frame.length) {
          improve(other.apex, distance + hypotenuse(other.apex_x() - x, height), source);
        }
      }
      corner = m.rotate(corner);
    } while (corner >= 0 && corner != first);
  }
  return field;
}

}  // namespace supple::surface
