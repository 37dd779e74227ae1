#include "supple/embedded/shortcuts.h"

#include <array>
#include <utility>

#include "supple/numerics/rows.h"
#include "supple/surface/matrices.h"
#include "supple/surface/shortcuts.h"

namespace supple::embedded {

Network spring_network(std::vector<surface::SurfacePoint> points, const Eigen::Ref<const Eigen::MatrixXi>& springs,
                       double rest_length, std::vector<std::int32_t> fixed_points, double weight) {
  Network network{.points = std::move(points), .springs = {}, .fixed_points = std::move(fixed_points)};
  for (const auto& [from, to] : numerics::groups_of<2>(springs, "springs"))
    network.springs.push_back({from, to, rest_length, weight});
  return network;
}

Relaxation relax(const surface::TriangleMesh& mesh, const Network& network, const RelaxationOptions& options,
                 const Execution& execution) {
  return relax(surface::solver_on(mesh, execution), network, options, execution);
}

Eigen::MatrixXd positions(const surface::TriangleMesh& mesh, const Relaxation& relaxation) {
  if (relaxation.host.vertices.empty()) return surface::positions(mesh, relaxation.points);
  return surface::positions(mesh.with_positions(relaxation.host.vertices), relaxation.points);
}

Eigen::MatrixXd host_vertices(const surface::TriangleMesh& mesh, const Relaxation& relaxation) {
  return relaxation.host.vertices.empty() ? surface::vertices_of(mesh) : numerics::rows_of(relaxation.host.vertices);
}

}  // namespace supple::embedded
