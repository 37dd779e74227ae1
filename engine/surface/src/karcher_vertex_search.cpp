#include "karcher_vertex_search.h"

#include <algorithm>

#include "supple/surface/vertex_cone.h"

namespace supple::surface {
namespace {

/// Points closer than this, relative to the mean edge, differ by rounding alone.
constexpr double point_rounding = 1e-13;

}  // namespace

std::vector<numerics::NonsmoothCandidate<KarcherState>> KarcherVertexSearch::candidates(
    const KarcherState& current, const std::vector<KarcherState>& trials, double reach) const {
  using Candidate = numerics::NonsmoothCandidate<KarcherState>;
  const Eigen::Vector3d here = position(mesh_, current.point());
  const std::int32_t current_vertex = vertex_of(mesh_, current.point());
  std::vector<Candidate> candidates;
  const auto add_corners = [&](FaceId face) {
    for (const std::int32_t vertex : mesh_.faces()[index(face)]) {
      const double distance = (mesh_.positions()[vertex] - here).norm();
      if (distance > reach || vertex == current_vertex) continue;
      if (std::ranges::find(candidates, vertex, &Candidate::id) != candidates.end()) continue;
      if (!VertexCone(mesh_, vertex).bends_paths()) continue;
      candidates.push_back({KarcherState(mesh_, vertex_point(mesh_, VertexId{vertex})), vertex, distance,
                            distance <= point_rounding * mesh_.mean_edge_length()});
    }
  };
  for (const KarcherState& trial : trials) add_corners(trial.point().face);
  add_corners(current.point().face);
  return candidates;
}

}  // namespace supple::surface
