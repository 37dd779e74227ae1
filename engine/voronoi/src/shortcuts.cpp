#include "supple/voronoi/shortcuts.h"

#include <utility>

#include "supple/numerics/rows.h"
#include "supple/surface/matrices.h"
#include "supple/surface/shortcuts.h"

namespace supple::voronoi {

Diagram diagram(const surface::TriangleMesh& mesh, const std::vector<surface::SurfacePoint>& sites,
                const DiagramOptions& options, const Execution& execution) {
  return diagram(surface::solver_on(mesh, execution), sites, options, execution);
}

Diagram diagram(const Eigen::Ref<const Eigen::MatrixXd>& vertices, const Eigen::Ref<const Eigen::MatrixXi>& faces,
                const Eigen::Ref<const Eigen::MatrixXd>& sites, const DiagramOptions& options) {
  const surface::TriangleMesh mesh = surface::mesh_of(vertices, faces);
  return diagram(mesh, surface::nearest_points(mesh, sites), options);
}

Optimization optimize(const surface::TriangleMesh& mesh, std::vector<surface::SurfacePoint> sites,
                      const OptimizationOptions& options, const Execution& execution) {
  return optimize(surface::solver_on(mesh, execution), std::move(sites), options, execution);
}

Eigen::VectorXd areas_of(const Diagram& diagram) {
  Eigen::VectorXd areas(static_cast<Eigen::Index>(diagram.cells.size()));
  for (std::size_t i = 0; i < diagram.cells.size(); ++i) areas[static_cast<Eigen::Index>(i)] = diagram.cells[i].area;
  return areas;
}

std::vector<Eigen::MatrixXd> boundary_of(const Diagram& diagram, std::size_t site) {
  std::vector<Eigen::MatrixXd> curves;
  for (const std::vector<std::int32_t>& curve : diagram.cells.at(site).boundary) {
    std::vector<Eigen::Vector3d> positions;
    positions.reserve(curve.size());
    for (const std::int32_t point : curve) positions.push_back(diagram.points[point].position);
    curves.push_back(numerics::rows_of(positions));
  }
  return curves;
}

Eigen::MatrixXi dual_faces_of(const Diagram& diagram) { return numerics::rows_of(diagram.dual); }

}  // namespace supple::voronoi
