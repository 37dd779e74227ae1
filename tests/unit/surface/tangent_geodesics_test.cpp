#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "supple/surface/geodesic_solver.h"
#include "supple/surface/retraction.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

struct NamedMesh {
  const char* name;
  TriangleMesh mesh;
};

std::vector<NamedMesh> meshes() {
  std::vector<NamedMesh> result;
  result.push_back({"torus", testing::torus(24, 12)});
  result.push_back({"sphere", testing::icosphere(3)});
  result.push_back({"genus3", testing::genus3(3)});
  result.push_back({"bumpy cube", testing::bumpy_cube(12, 2.5, 0.03)});
  result.push_back({"saddle", testing::saddle(12)});
  result.push_back({"needles", testing::needle_cylinder()});
  result.push_back({"slivers", testing::sliver_sphere()});
  result.push_back({"slit", testing::slit_annulus()});
  return result;
}

/// Pairs of points a few edges apart, as the springs of a network are.
std::vector<PointPair> near_pairs(const TriangleMesh& mesh, int count, double reach, std::uint64_t seed) {
  const testing::SurfaceSampler sampler(mesh);
  RandomStream random("near_pairs", seed);
  std::vector<PointPair> pairs;
  for (int i = 0; i < count; ++i) {
    const SurfacePoint from = i % 5 == 1
                                  ? testing::random_edge_point(mesh, random)
                                  : (i % 11 == 3 ? testing::random_vertex_point(mesh, random) : sampler.point(random));
    const double length = reach * mesh.mean_edge_length() * random.uniform();
    const double angle = 6.283185307179586 * random.uniform();
    const Eigen::Vector2d step = length * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    pairs.push_back({from, retract(mesh, from, step, {}).end, nullptr});
  }
  return pairs;
}

void expect_same_as_searches(const GeodesicSolver& solver, const std::vector<PointPair>& pairs,
                             const std::vector<TangentGeodesic>& found, const char* name) {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    SCOPED_TRACE(std::string(name) + ", pair " + std::to_string(i));
    const Geodesic exact = solver.geodesic(pairs[i].from, pairs[i].to, {.derivatives = 2});
    const double edge = solver.mesh().mean_edge_length();
    ASSERT_NEAR(found[i].distance, exact.distance, 1e-12 * edge + 1e-11 * exact.distance);
    ASSERT_EQ(found[i].coincident(), !exact.derivatives.has_value());
    if (found[i].coincident() || !exact.unique || exact.competing_excess < 1e-7 * edge) continue;
    Eigen::Vector4d gradient;
    gradient << -found[i].from_direction, found[i].to_direction;
    const double rounding = 1e-9 + 1e-14 * edge / exact.distance;
    EXPECT_LT((gradient - exact.derivatives->tangent_gradient).norm(), rounding);
    EXPECT_EQ(found[i].pinned, !exact.pinned_at.empty());
    EXPECT_LT((found[i].hessian() - exact.derivatives->tangent_hessian).norm(),
              rounding * exact.derivatives->tangent_hessian.norm());
  }
}

TEST(TangentGeodesics, GoOnStraightWhereTheirEndsMoveALittle) {
  int compared = 0, pinned = 0;
  for (const auto& [name, mesh] : meshes()) {
    const GeodesicSolver solver(testing::share(mesh));
    const double edge = mesh.mean_edge_length();
    RandomStream random("moved ends", 1);
    for (const PointPair& pair : near_pairs(mesh, 200, 9, 1)) {
      TangentGeodesic before, after;
      solver.tangent_geodesics({&pair, 1}, {&before, 1}, false);
      if (before.distance < 0.1 * edge || std::min(before.first_length, before.last_length) < 0.1 * edge) continue;
      Eigen::Vector4d step;
      for (double& own : step) own = 1e-4 * edge * random.uniform(-1, 1);
      const Retraction from = retract(mesh, pair.from, step.head<2>(), {});
      const Retraction to = retract(mesh, pair.to, step.tail<2>(), {});
      if (!from.isometric || !to.isometric) continue;
      const PointPair moved{from.end, to.end};
      solver.tangent_geodesics({&moved, 1}, {&after, 1}, false);
      // Other pieces, behind a vertex or across a cut locus, are not the same ones continued.
      if (!before.unique || before.pinned != after.pinned || before.strip.count != after.strip.count ||
          before.strip.halfedges != after.strip.halfedges ||
          std::abs(before.first_length - after.first_length) > 1e-3 * edge ||
          std::abs(before.last_length - after.last_length) > 1e-3 * edge)
        continue;
      SCOPED_TRACE(name);
      const TangentGeodesic continued = before.extrapolated(step);
      const TangentGeodesic turned = after.in_frames_before(from.turn, to.turn);
      // Two pins may be others, a path along an edge may have no strip: those differ in second order.
      const double rounding = before.strip.known() || before.pinned ? 1e-10 : 1e-4;
      EXPECT_NEAR(continued.distance, after.distance, rounding * edge);
      EXPECT_LT((continued.gradient() - turned.gradient()).norm(), 1e-8 + (before.strip.known() ? 0 : 1e-3));
      EXPECT_NEAR(continued.first_length, after.first_length, 1e-3 * edge);
      ++compared;
      pinned += before.pinned;
    }
  }
  EXPECT_GT(compared, 200);
  EXPECT_GT(pinned, 5);
}

TEST(TangentGeodesics, AreThoseOfASearchOnEveryShape) {
  for (const auto& [name, mesh] : meshes()) {
    const GeodesicSolver solver(testing::share(mesh));
    for (const double reach : {0.5, 2.0, 6.0}) {
      const auto pairs = near_pairs(mesh, 400, reach, 1);
      std::vector<TangentGeodesic> found(pairs.size());
      const PathCounts counts = solver.tangent_geodesics(pairs, found, false);
      EXPECT_EQ(counts.same_face + counts.unfolded + counts.searched, 400);
      expect_same_as_searches(solver, pairs, found, name);
    }
  }
}

TEST(TangentGeodesics, KeptStripsNeverChangeTheAnswerWhilePointsMove) {
  for (const auto& [name, mesh] : meshes()) {
    const GeodesicSolver solver(testing::share(mesh));
    auto pairs = near_pairs(mesh, 200, 3, 2);
    std::vector<TangentGeodesic> found(pairs.size());
    solver.tangent_geodesics(pairs, found, false);
    RandomStream random("moves", 3);
    for (int step = 0; step < 8; ++step) {
      const double length = (step % 2 == 0 ? 0.05 : 0.7) * mesh.mean_edge_length();
      for (PointPair& pair : pairs) {
        pair.from = retract(mesh, pair.from, length * Eigen::Vector2d(random.normal(), random.normal()), {}).end;
        pair.to = retract(mesh, pair.to, length * Eigen::Vector2d(random.normal(), random.normal()), {}).end;
      }
      solver.tangent_geodesics(pairs, found, true);
      expect_same_as_searches(solver, pairs, found, name);
    }
  }
}

TEST(TangentGeodesics, AStripThatHoldsIsUnfoldedInsteadOfSearched) {
  const TriangleMesh mesh = testing::torus(48, 24);
  const GeodesicSolver solver(testing::share(mesh));
  const auto pairs = near_pairs(mesh, 2000, 2, 4);
  std::vector<TangentGeodesic> found(pairs.size());
  const PathCounts first = solver.tangent_geodesics(pairs, found, false);
  const PathCounts second = solver.tangent_geodesics(pairs, found, true);
  EXPECT_LT(2 * second.searched, first.searched);
  EXPECT_GT(second.unfolded, first.unfolded);
  EXPECT_EQ(first.same_face, second.same_face);
}

TEST(TangentGeodesics, AreAnsweredWhereThereIsNoPathAndNoDistance) {
  const TriangleMesh mesh = testing::two_components();
  const GeodesicSolver solver(testing::share(mesh));
  const SurfacePoint here{FaceId{0}, {0.2, 0.3, 0.5}};
  const SurfacePoint elsewhere{FaceId{mesh.face_count() - 1}, {0.2, 0.3, 0.5}};
  // The same place on an edge, written in its two faces.
  const std::int32_t across = mesh.twin(0);
  SurfacePoint edge{FaceId{0}, {0.25, 0.75, 0}};
  SurfacePoint same{FaceId{TriangleMesh::face_of(across)}, Eigen::Vector3d::Zero()};
  same.barycentric[across % 3] = 0.75;
  same.barycentric[(across + 1) % 3] = 0.25;
  const std::vector<PointPair> pairs = {{here, elsewhere, nullptr}, {here, here, nullptr}, {edge, same, nullptr}};
  std::vector<TangentGeodesic> found(3);
  solver.tangent_geodesics(pairs, found, false);
  EXPECT_TRUE(std::isinf(found[0].distance));
  EXPECT_TRUE(found[1].coincident());
  EXPECT_TRUE(found[2].coincident());
  // Coordinates of the edge's direction in either face differ by the turn.
  const auto& x = mesh.positions();
  const Eigen::Vector3d along = x[mesh.faces()[0][1]] - x[mesh.faces()[0][0]];
  const Eigen::Vector2d in_first = tangent_frame(mesh, FaceId{0}).transpose() * along;
  const Eigen::Vector2d in_second = tangent_frame(mesh, same.face).transpose() * along;
  EXPECT_LT((Eigen::Rotation2Dd(found[2].turn) * in_second - in_first).norm(), 1e-13);
}

}  // namespace
}  // namespace supple::surface
