#include "supple/voronoi/diagram.h"

#include <algorithm>
#include <array>

#include "planar_face.h"
#include "site_places.h"
#include "supple/base/random.h"
#include "supple/voronoi/moving_diagram.h"

namespace supple::voronoi {

Diagram diagram(const surface::GeodesicSolver& solver, std::span<const surface::SurfacePoint> sites,
                const DiagramOptions& options, const Execution& execution) {
  MovingDiagram moving(solver, options);
  moving.move_to(sites, execution);
  return moving.take_diagram();
}

std::vector<surface::SurfacePoint> random_sites(const surface::TriangleMesh& mesh, std::int64_t count,
                                                std::uint64_t seed) {
  check_site_count(count);
  std::vector<double> areas;
  double total = 0;
  for (std::int32_t face = 0; face < mesh.face_count(); ++face) {
    const std::array<Eigen::Vector2d, 3> corners = planar_corners(mesh, face);
    areas.push_back(total += corners[1].x() * corners[2].y());
  }
  RandomStream random("voronoi_sites", seed);
  std::vector<surface::SurfacePoint> sites;
  sites.reserve(static_cast<std::size_t>(count));
  for (std::int64_t i = 0; i < count; ++i) {
    const auto place = std::upper_bound(areas.begin(), areas.end() - 1, random.uniform() * total);
    double b = random.uniform();
    double c = random.uniform();
    if (b + c > 1) {
      b = 1 - b;
      c = 1 - c;
    }
    sites.push_back({FaceId(static_cast<std::int32_t>(place - areas.begin())), Eigen::Vector3d(1 - b - c, b, c)});
  }
  return sites;
}

}  // namespace supple::voronoi
