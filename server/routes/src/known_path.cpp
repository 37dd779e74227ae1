#include "known_path.h"

#include <algorithm>

#include "points.h"
#include "supple/base/error.h"

namespace supple::routes {
namespace {

/// Two ends within this distance are the same; fraction of the mesh's diagonal.
constexpr double max_end_distance = 1e-9;

/// The faces that contain the point: one, two for a point on an edge, all faces around a vertex.
std::vector<std::int32_t> faces_of(const surface::TriangleMesh& mesh, const surface::SurfacePoint& point) {
  const auto face = index(point.face);
  std::vector<std::int32_t> faces{face};
  if (const int corner = surface::corner_of(point); corner >= 0) {
    const auto first = mesh.outgoing(mesh.tail(3 * face + corner));
    auto halfedge = first;
    do {
      faces.push_back(surface::TriangleMesh::face_of(halfedge));
      halfedge = mesh.rotate(halfedge);
    } while (halfedge >= 0 && halfedge != first);
  } else if (const int side = surface::side_of(point); side >= 0) {
    if (const auto twin = mesh.twin(3 * face + side); twin >= 0) faces.push_back(surface::TriangleMesh::face_of(twin));
  }
  return faces;
}

bool have_common_face(const surface::TriangleMesh& mesh, const surface::SurfacePoint& a,
                      const surface::SurfacePoint& b) {
  const auto first = faces_of(mesh, a);
  const auto second = faces_of(mesh, b);
  return std::find_first_of(first.begin(), first.end(), second.begin(), second.end()) != first.end();
}

[[noreturn]] void fail(const std::string& pointer, const std::string& message) {
  throw Error("geodesic.known_path", "The known path cannot be used: " + message + ".", {{pointer, message}});
}

}  // namespace

std::vector<surface::PathPoint> checked_path(PointResolver& points_of, const std::vector<json::PointSpec>& path,
                                             const surface::SurfacePoint& from, const surface::SurfacePoint& to,
                                             const std::string& pointer) {
  const surface::TriangleMesh& mesh = points_of.mesh();
  auto points = points_of.resolve(path, pointer);
  const auto is_near = [&](const surface::SurfacePoint& a, const surface::SurfacePoint& b) {
    return (surface::position(mesh, a) - surface::position(mesh, b)).norm() <= max_end_distance * mesh.diagonal();
  };
  const auto last = points.size() - 1;
  if (!is_near(points.front(), from)) fail(pointer + "/0", "it does not begin at the pair's first point");
  if (!is_near(points.back(), to))
    fail(pointer + "/" + std::to_string(last), "it does not end at the pair's second point");
  points.front() = from;
  points.back() = to;
  std::vector<surface::PathPoint> result;
  result.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0 && !have_common_face(mesh, points[i - 1], points[i])) {
      fail(pointer + "/" + std::to_string(i), "no face has both this point and the one before");
    }
    result.push_back({points[i], surface::position(mesh, points[i]), VertexId::none});
  }
  return result;
}

}  // namespace supple::routes
