#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

#include "file_makers.h"
#include "polygon.h"
#include "solid_files.h"
#include "solid_patch.h"
#include "triangulation.h"

namespace supple::tiling {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is little-endian");

using Vertex = Eigen::Vector3f;

class StlWriter {
 public:
  explicit StlWriter(const std::string& title) : content_(header_bytes + sizeof(std::uint32_t), '\0') {
    std::memcpy(content_.data(), title.data(), std::min(title.size(), header_bytes - 1));
  }

  void add(const Vertex& a, const Vertex& b, const Vertex& c) {
    const Vertex normal = (b - a).cross(c - a).normalized();
    for (const Vertex& v : {normal, a, b, c}) {
      content_.append(reinterpret_cast<const char*>(v.data()), 3 * sizeof(float));
    }
    content_.append(2, '\0');  // the attribute, unused
    ++triangles_;
  }

  std::string finish() {
    std::memcpy(content_.data() + header_bytes, &triangles_, sizeof triangles_);
    return std::move(content_);
  }

 private:
  static constexpr std::size_t header_bytes = 80;
  std::string content_;
  std::uint32_t triangles_ = 0;
};

}  // namespace

meshing::PlanarMesh caps_of(const std::vector<Face>& faces) {
  // Caps need no fine triangles; their corners are those of the walls.
  Bounds bounds;
  for (const Face& face : faces) bounds.include(face[0]);
  const double size = 2 * (bounds.upper - bounds.lower).norm();
  return triangulate(faces, [size](const Eigen::Vector2d&) { return size; });
}

std::string stl_of(const std::vector<Face>& faces, const meshing::PlanarMesh& caps, double thickness,
                   const std::string& title) {
  const auto height = static_cast<float>(thickness);
  const auto at = [](const Eigen::Vector2d& p, float z) {
    return Vertex(static_cast<float>(p.x()), static_cast<float>(p.y()), z);
  };
  StlWriter writer(title);
  for (const auto& [a, b, c] : caps.triangles) {
    const auto &p = caps.points[a], &q = caps.points[b], &r = caps.points[c];
    writer.add(at(p, height), at(q, height), at(r, height));
    writer.add(at(p, 0), at(r, 0), at(q, 0));
  }
  for (const Face& face : faces) {
    for (const Polygon& polygon : face) {
      for (std::size_t k = 0; k < polygon.size(); ++k) {
        // The material lies on the left of a side.
        const Eigen::Vector2d &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
        writer.add(at(p, 0), at(q, 0), at(q, height));
        writer.add(at(p, 0), at(q, height), at(p, height));
      }
    }
  }
  return writer.finish();
}

std::string make_stl(const Structure& structure, const ExportOptions& options) {
  const std::vector<Face> faces = solid_patch(structure, options);
  return stl_of(faces, caps_of(faces), options.height, "Supple structure, millimetres");
}

}  // namespace supple::tiling
