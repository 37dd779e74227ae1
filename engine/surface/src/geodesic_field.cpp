#include "supple/surface/geodesic_field.h"

#include <array>

#include "field_data.h"
#include "supple/base/error.h"

namespace supple::surface {
namespace {

Error not_kept() { return {"field.not_kept", "The field was computed without what point queries need."}; }

/// Unit direction of a side of a face in `frame`, which is the frame of the face's first side.
Eigen::Vector2d side_direction(const EdgeFrame& frame, int side) {
  if (side == 0) return {1, 0};
  if (side == 1) return Eigen::Vector2d(-frame.right_x(), frame.apex_y) / frame.right_length;
  return Eigen::Vector2d(-frame.apex_x(), -frame.apex_y) / frame.left_length;
}

/// A source that lies in a face or on an edge of it, in the plane of the face.
Eigen::Vector2d planar_source(const GeodesicField::Data& data, std::int32_t face, std::int32_t source) {
  const SurfacePoint& point = data.sources[source];
  Eigen::Vector3d barycentric = point.barycentric;
  if (index(point.face) != face) {
    // The source lies on the common edge, and is given in the other face.
    const int side = side_of(point);
    barycentric = across_side(point, side, data.mesh->mesh->twin(3 * index(point.face) + side));
  }
  return planar_point(data.mesh->frames[3 * face], barycentric, 0);
}

}  // namespace

void GeodesicField::Data::fill_sources_in_faces() {
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const SurfacePoint& source = sources[i];
    if (corner_of(source) >= 0) continue;
    const auto number = static_cast<std::int32_t>(i);
    sources_in_faces.emplace_back(index(source.face), number);
    const int side = side_of(source);
    const std::int32_t across = side < 0 ? -1 : mesh->mesh->twin(3 * index(source.face) + side);
    if (across >= 0) sources_in_faces.emplace_back(TriangleMesh::face_of(across), number);
  }
  std::sort(sources_in_faces.begin(), sources_in_faces.end());
}

void GeodesicField::Data::fill_vertex_sources() {
  vertex_sources.assign(records.size(), -1);
  std::vector<std::int32_t> chain;
  for (std::size_t v = 0; v < records.size(); ++v) {
    // The chain of pseudo-sources, each nearer than the one before, leads to the source or to a vertex whose source is
    // already found.
    std::int32_t at = static_cast<std::int32_t>(v);
    chain.clear();
    while (vertex_sources[at] < 0 && distances[at] < infinity && records[at].origin >= 0) {
      chain.push_back(at);
      at = records[at].origin;
    }
    if (vertex_sources[at] < 0 && distances[at] < infinity) vertex_sources[at] = -1 - records[at].origin;
    for (const std::int32_t passed : chain) vertex_sources[passed] = vertex_sources[at];
  }
}

SearchTarget GeodesicField::Data::query(const SurfacePoint& point) const {
  if (!has_windows) throw not_kept();
  SearchTarget target = make_target(*mesh, point);
  if (arrive_near_vertex(*mesh, sources, target)) return target;
  const std::int32_t face = index(point.face);
  const auto update_by_windows = [&](std::int32_t h) {
    for (std::int32_t i = first[h]; i < first[h + 1]; ++i) update_by_window(*mesh, sources, target, h, windows[i]);
  };
  const TriangleMesh& m = *mesh->mesh;
  if (target.vertex >= 0) {
    const std::int32_t start = m.outgoing(target.vertex);
    std::int32_t h = start;
    do {
      update_by_windows(TriangleMesh::next(h));
      h = m.rotate(h);
    } while (h >= 0 && h != start);
  } else {
    visit_sources(face, [&](std::int32_t i) { update_by_direct_path(*mesh, target, sources[i], i); });
    for (int side = 0; side < 3; ++side) update_by_windows(3 * face + side);
  }
  for (int corner = 0; corner < 3; ++corner) {
    const std::int32_t v = m.faces()[face][corner];
    if (has_known_distance(v)) continue;  // its path comes from a source outside the field
    update_by_vertex(*mesh, target, corner, distances[v], records[v]);
  }
  return target;
}

const std::vector<double>& GeodesicField::vertex_distances() const { return data_->distances; }

double GeodesicField::distance(const SurfacePoint& point) const { return data_->query(point).best.length; }

Geodesic GeodesicField::geodesic(const SurfacePoint& point, const GeodesicOptions& options) const {
  return assemble(data_->state(), data_->query(point), options);
}

int GeodesicField::nearest_source(const SurfacePoint& point) const {
  return source_of(data_->state(), data_->query(point));
}

const std::vector<std::int32_t>& GeodesicField::vertex_sources() const {
  if (data_->vertex_sources.empty()) throw not_kept();
  return data_->vertex_sources;
}

bool GeodesicField::reaches(FaceId face) const {
  const Data& data = *data_;
  if (data.vertex_sources.empty()) throw not_kept();
  const std::int32_t f = index(face);
  if (data.has_windows && data.first[3 * f + 3] > data.first[3 * f]) return true;
  for (const std::int32_t v : data.mesh->mesh->faces()[f])
    if (data.vertex_sources[v] >= 0 && !data.has_known_distance(v)) return true;
  bool any = false;
  data.visit_sources(f, [&](std::int32_t /*source*/) { any = true; });
  return any;
}

double GeodesicField::relative_error_bound() const { return data_->relative_error_bound; }

std::int64_t GeodesicField::window_count() const { return data_->window_count; }

std::int64_t GeodesicField::memory_bytes() const {
  return static_cast<std::int64_t>(
      sizeof(Data) + data_->distances.capacity() * sizeof(double) + data_->records.capacity() * sizeof(VertexRecord) +
      data_->windows.capacity() * sizeof(Window) + data_->trails.capacity() * sizeof(Trail) +
      data_->ties.capacity() * sizeof(TiedArrival) +
      (data_->first.capacity() + data_->vertex_sources.capacity()) * sizeof(std::int32_t) +
      data_->sources_in_faces.capacity() * sizeof(data_->sources_in_faces[0]));
}

void GeodesicField::arrivals(FaceId face, std::vector<FaceArrival>& arrivals) const {
  const Data& data = *data_;
  if (data.vertex_sources.empty()) throw not_kept();
  arrivals.clear();
  const std::int32_t f = index(face);
  const EdgeFrame& frame = data.mesh->frames[3 * f];
  const std::array<Eigen::Vector2d, 3> corners{Eigen::Vector2d(0, 0), Eigen::Vector2d(frame.length, 0),
                                               Eigen::Vector2d(frame.apex_x(), frame.apex_y)};
  for (int i = 0; i < 3; ++i) {
    const std::int32_t v = data.mesh->mesh->faces()[f][i];
    if (data.vertex_sources[v] < 0) continue;
    arrivals.push_back({.image = corners[i], .sigma = data.distances[v], .source = data.vertex_sources[v]});
  }
  data.visit_sources(
      f, [&](std::int32_t i) { arrivals.push_back({.image = planar_source(data, f, i), .sigma = 0, .source = i}); });
  if (!data.has_windows) return;
  for (int side = 0; side < 3; ++side) {
    const Eigen::Vector2d along = side_direction(frame, side);
    const Eigen::Vector2d across(-along.y(), along.x());
    const Eigen::Vector2d& tail = corners[side];
    for (std::int32_t i = data.first[3 * f + side]; i < data.first[3 * f + side + 1]; ++i) {
      const Window& w = data.windows[i];
      arrivals.push_back({.image = tail + w.source_x * along - w.depth * across,
                          .begin = tail + w.b0 * along,
                          .end = tail + w.b1 * along,
                          .sigma = w.sigma,
                          .source = w.origin < 0 ? -1 - w.origin : data.vertex_sources[w.origin],
                          .everywhere = false});
    }
  }
}

PathStart GeodesicField::start_of_path(FaceId face, std::size_t arrival, const Eigen::Vector2d& place) const {
  const Data& data = *data_;
  if (!data.has_windows) throw not_kept();
  const std::int32_t f = index(face);
  const EdgeFrame& frame = data.mesh->frames[3 * f];
  const std::array<Eigen::Vector2d, 3> corners{Eigen::Vector2d(0, 0), Eigen::Vector2d(frame.length, 0),
                                               Eigen::Vector2d(frame.apex_x(), frame.apex_y)};
  SearchTarget target;
  target.point.face = face;
  for (int side = 0; side < 3; ++side) {
    const Eigen::Vector2d along = side_direction(frame, side);
    const Eigen::Vector2d offset = place - corners[side];
    target.planar[side] = {offset.dot(along), along.x() * offset.y() - along.y() * offset.x()};
  }
  // The order is that of arrivals(): corners that are reached, sources in the face, windows.
  auto remaining = static_cast<std::int32_t>(arrival);
  for (int corner = 0; corner < 3; ++corner) {
    const std::int32_t v = data.mesh->mesh->faces()[f][corner];
    if (data.vertex_sources[v] < 0 || remaining-- != 0) continue;
    target.best.kind = Arrival::Kind::vertex;
    target.best.vertex = v;
    return start_of(data.state(), target);
  }
  data.visit_sources(f, [&](std::int32_t i) {
    if (remaining-- != 0) return;
    target.best.kind = Arrival::Kind::direct;
    target.best.source = i;
    target.best.image = planar_source(data, f, i) - place;
  });
  if (target.best.kind == Arrival::Kind::none) {
    const std::int32_t number = data.first[3 * f] + remaining;
    std::int32_t h = 3 * f;
    while (data.first[h + 1] <= number) ++h;
    const Window& window = data.windows[number];
    target.best.kind = Arrival::Kind::window;
    target.best.halfedge = h;
    target.best.trail = window.trail;
    target.best.origin = window.origin;
  }
  return start_of(data.state(), target);
}

}  // namespace supple::surface
