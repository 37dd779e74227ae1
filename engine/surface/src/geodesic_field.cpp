#include "supple/surface/geodesic_field.h"

#include "field_data.h"
#include "supple/base/error.h"

namespace supple::surface {

SearchTarget GeodesicField::Data::query(const SurfacePoint& point) const {
  if (!kept) throw Error("field.not_kept", "The field was computed without what point queries need.");
  SearchTarget target = make_target(*mesh, point);
  if (arrive_near_vertex(*mesh, sources, target)) return target;
  const std::int32_t face = index(point.face);
  const auto offer_windows = [&](std::int32_t h) {
    for (std::int32_t i = first[h]; i < first[h + 1]; ++i) offer_window(*mesh, sources, target, h, windows[i]);
  };
  const TriangleMesh& m = *mesh->mesh;
  if (target.vertex >= 0) {
    const std::int32_t start = m.outgoing(target.vertex);
    std::int32_t h = start;
    do {
      offer_windows(TriangleMesh::next(h));
      h = m.rotate(h);
    } while (h >= 0 && h != start);
  } else {
    for (std::size_t i = 0; i < sources.size(); ++i) offer_direct(*mesh, target, sources[i], static_cast<int>(i));
    for (int side = 0; side < 3; ++side) offer_windows(3 * face + side);
  }
  for (int corner = 0; corner < 3; ++corner) {
    const std::int32_t v = m.faces()[face][corner];
    offer_vertex(*mesh, target, corner, distances[v], records[v]);
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

double GeodesicField::relative_error_bound() const { return data_->relative_error_bound; }

std::int64_t GeodesicField::window_count() const { return data_->window_count; }

std::int64_t GeodesicField::memory_bytes() const {
  return static_cast<std::int64_t>(
      sizeof(Data) + data_->distances.capacity() * sizeof(double) + data_->records.capacity() * sizeof(VertexRecord) +
      data_->windows.capacity() * sizeof(Window) + data_->trails.capacity() * sizeof(Trail) +
      data_->first.capacity() * sizeof(std::int32_t));
}

}  // namespace supple::surface
