// Triangles one of whose sides is 1e-9 to 1e-12 of the others. Hard: where a corner lies along a side, counted from the
// side's far end, says nothing of the direction of the short side. Expected values come from the surface without them.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "supple/surface/geodesic_solver.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using Eigen::Vector3d;
using testing::share;

/// The same surface with about a third of its faces cut into needles and what is left beside them: edges get a further
/// vertex at `short_side` of their length from one end. The old vertices keep their numbers.
TriangleMesh with_needles(const TriangleMesh& mesh, double short_side, RandomStream& stream) {
  std::vector<Vector3d> positions = mesh.positions();
  std::vector<Triangle> faces;
  std::set<std::int32_t> cut;
  for (int i = 0; i < mesh.face_count(); ++i) {
    const std::int32_t h = stream.below(mesh.halfedge_count()), twin = mesh.twin(h);
    if (twin < 0 || cut.count(h / 3) || cut.count(twin / 3) || stream.below(3) > 0) continue;
    cut.insert({h / 3, twin / 3});
    const auto added = static_cast<std::int32_t>(positions.size());
    positions.emplace_back(positions[mesh.tail(h)] + short_side * (positions[mesh.head(h)] - positions[mesh.tail(h)]));
    for (const std::int32_t side : {h, twin}) {
      const std::int32_t apex = mesh.tail(TriangleMesh::previous(side));
      faces.push_back({mesh.tail(side), added, apex});
      faces.push_back({added, mesh.head(side), apex});
    }
  }
  for (std::int32_t f = 0; f < mesh.face_count(); ++f) {
    if (!cut.count(f)) faces.push_back(mesh.faces()[f]);
  }
  return TriangleMesh::build(std::move(positions), std::move(faces));
}

class Needles : public ::testing::TestWithParam<double> {};

TEST_P(Needles, InThePlaneChangeNoDistance) {
  RandomStream stream("needles_plane", 1);
  for (int round = 0; round < 10; ++round) {
    const auto mesh = share(with_needles(testing::jittered_grid(8, 8, stream), GetParam(), stream));
    const GeodesicSolver solver(mesh);
    double worst = 0;
    for (int i = 0; i < 20; ++i) {
      const SurfacePoint a = i % 2 ? testing::random_point(*mesh, stream) : testing::random_vertex_point(*mesh, stream);
      const GeodesicField field = solver.field({{a}}, {.keep_windows = true});
      const auto compare = [&](double found, const Vector3d& place) {
        const double exact = (place - position(*mesh, a)).norm();
        if (exact > 1e-3) worst = std::isfinite(found) ? std::max(worst, std::abs(found / exact - 1)) : found;
      };
      for (std::int32_t v = 0; v < mesh->vertex_count(); ++v) {
        compare(field.vertex_distances()[v], mesh->positions()[v]);
      }
      for (int k = 0; k < 10; ++k) {
        const SurfacePoint b = testing::random_point(*mesh, stream);
        compare(field.distance(b), position(*mesh, b));
        compare(solver.distance(a, b), position(*mesh, b));
      }
    }
    EXPECT_LT(worst, 1e-12) << round;
  }
}

TEST_P(Needles, OnCurvedSurfacesChangeNoDistance) {
  for (const TriangleMesh& mesh : {testing::icosphere(2), testing::torus(16, 8), testing::saddle(8)}) {
    RandomStream stream("needles_curved", 2);
    const GeodesicSolver plain(share(mesh));
    const GeodesicSolver solver(share(with_needles(mesh, GetParam(), stream)));
    double worst = 0;
    for (int i = 0; i < 20; ++i) {
      const std::int32_t source = stream.below(mesh.vertex_count());
      const auto expected = plain.field({{vertex_point(mesh, VertexId(source))}}).vertex_distances();
      const auto found = solver.field({{vertex_point(solver.mesh(), VertexId(source))}}).vertex_distances();
      for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
        if (v == source) continue;
        worst = std::isfinite(found[v]) ? std::max(worst, std::abs(found[v] / expected[v] - 1)) : found[v];
      }
    }
    EXPECT_LT(worst, 1e-12) << mesh.face_count();
  }
}

INSTANTIATE_TEST_SUITE_P(Of, Needles, ::testing::Values(1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12));

}  // namespace
}  // namespace supple::surface
