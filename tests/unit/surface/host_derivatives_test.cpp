// Derivatives of a path's length by its ends and by the vertices of its surface, against exact geodesics of surfaces
// that have moved.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <memory>
#include <set>
#include <vector>

#include "supple/surface/geodesic_derivatives.h"
#include "supple/surface/geodesic_solver.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using testing::share;

/// Two ends on a surface, and a motion of everything: of both ends' barycentric coordinates and of all vertices.
struct HostScene {
  std::shared_ptr<const TriangleMesh> mesh;
  SurfacePoint from, to;
};
struct HostMotion {
  Vector3d from, to;
  std::vector<Vector3d> vertices;
};

HostScene moved(const HostScene& scene, const HostMotion& motion, double step) {
  std::vector<Vector3d> positions = scene.mesh->positions();
  for (std::size_t v = 0; v < positions.size(); ++v) positions[v] += step * motion.vertices[v];
  return {share(scene.mesh->with_positions(std::move(positions))),
          {scene.from.face, scene.from.barycentric + step * motion.from},
          {scene.to.face, scene.to.barycentric + step * motion.to}};
}

Geodesic solved(const HostScene& scene, int derivatives = 0) {
  return GeodesicSolver(scene.mesh).geodesic(scene.from, scene.to, {.derivatives = derivatives, .path = true});
}

Vector3d random_vector(RandomStream& stream) {
  return {stream.uniform(-1, 1), stream.uniform(-1, 1), stream.uniform(-1, 1)};
}

HostMotion random_motion(const HostScene& scene, RandomStream& stream) {
  HostMotion motion;
  for (Vector3d* end : {&motion.from, &motion.to}) {
    *end = random_vector(stream);
    *end -= Vector3d::Constant(end->mean());
  }
  const double size = scene.mesh->mean_edge_length();
  for (std::int32_t v = 0; v < scene.mesh->vertex_count(); ++v) {
    motion.vertices.push_back(size * random_vector(stream));
  }
  return motion;
}

/// The motion's values for the variables of the derivatives.
VectorXd values(const HostDerivatives& derivatives, const HostMotion& motion) {
  VectorXd result(derivatives.gradient.size());
  result << motion.from, motion.to, VectorXd::Zero(result.size() - 6);
  for (std::size_t k = 0; k < derivatives.vertices.size(); ++k) {
    result.segment<3>(6 + 3 * static_cast<Eigen::Index>(k)) = motion.vertices[derivatives.vertices[k]];
  }
  return result;
}

/// The gradient as a vector over both ends and all vertices.
VectorXd spread(const HostScene& scene, const HostDerivatives& derivatives) {
  VectorXd result = VectorXd::Zero(6 + 3 * scene.mesh->vertex_count());
  result.head<6>() = derivatives.gradient.head<6>();
  for (std::size_t k = 0; k < derivatives.vertices.size(); ++k) {
    result.segment<3>(6 + 3 * derivatives.vertices[k]) =
        derivatives.gradient.segment<3>(6 + 3 * static_cast<Eigen::Index>(k));
  }
  return result;
}

/// Takes from a vector of barycentric derivatives what sums to zero at each end: the rest has no meaning.
VectorXd on_surface(VectorXd vector) {
  for (int end = 0; end < 2; ++end) {
    vector.segment<3>(3 * end) -= Vector3d::Constant(vector.segment<3>(3 * end).mean());
  }
  return vector;
}

/// The edges that a path crosses and the vertices that it passes.
std::vector<std::int32_t> crossed(const TriangleMesh& mesh, const Geodesic& geodesic) {
  std::vector<std::int32_t> edges;
  for (std::size_t k = 1; k + 1 < geodesic.path.size(); ++k) {
    const PathPoint& p = geodesic.path[k];
    const std::int32_t h = 3 * index(p.point.face) + side_of(p.point);
    edges.push_back(p.vertex != VertexId::none ? -1 - index(p.vertex) : std::max(h, mesh.twin(h)));
  }
  return edges;
}

/// Compares gradient and Hessian along the motion with fourth-order finite differences: central ones, or ones to one
/// side for ends that can move to one side only. Returns false where the path changes its strip on the way, or other
/// vertices come to hold it.
bool expect_host_derivatives(const HostScene& scene, const HostMotion& motion, bool central, double h,
                             double tolerance) {
  const std::vector<double> steps = central ? std::vector{-2., -1., 1., 2.} : std::vector{0., 1., 2., 3., 4.};
  const std::vector<double> weights =
      central ? std::vector{1 / 12., -8 / 12., 8 / 12., -1 / 12.} : std::vector{-25 / 12., 4., -3., 16 / 12., -3 / 12.};
  const Geodesic geodesic = solved(scene);
  const HostDerivatives derivatives = host_derivatives(*scene.mesh, geodesic.path);
  EXPECT_NEAR(derivatives.length, geodesic.distance, 1e-11 * geodesic.distance);
  double first = 0;
  VectorXd second = VectorXd::Zero(6 + 3 * scene.mesh->vertex_count());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const HostScene at = moved(scene, motion, steps[i] * h);
    const Geodesic g = solved(at);
    if (central && crossed(*at.mesh, g) != crossed(*scene.mesh, geodesic)) return false;
    if (g.pinned_at != geodesic.pinned_at) return false;
    first += weights[i] * g.distance / h;
    second += weights[i] / h * spread(at, host_derivatives(*at.mesh, g.path, 1));
  }
  const VectorXd along = values(derivatives, motion);
  const double size = scene.mesh->mean_edge_length();
  EXPECT_NEAR(derivatives.gradient.dot(along), first, tolerance * size);
  // The largest entry of a row tells how fast its gradient turns.
  HostDerivatives change = derivatives;
  change.gradient = derivatives.hessian * along;
  const VectorXd difference = on_surface(spread(scene, change)) - on_surface(second);
  const double largest = derivatives.hessian.cwiseAbs().maxCoeff() * along.norm();
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), tolerance * (1 + largest));
  EXPECT_LT((derivatives.hessian - derivatives.hessian.transpose()).norm(), 1e-13 * derivatives.hessian.norm());
  return true;
}

bool is_away_from_faults(const HostScene& scene, double margin) {
  const Geodesic g = solved(scene);
  const double size = scene.mesh->mean_edge_length();
  if (g.unreachable || g.competing_excess < margin * size || g.distance < 0.3 * size) return false;
  for (std::size_t k = 1; k + 1 < g.path.size(); ++k) {
    if (g.path[k].vertex == VertexId::none && g.path[k].point.barycentric.maxCoeff() > 1 - margin) return false;
  }
  return true;
}

std::vector<std::shared_ptr<const TriangleMesh>> hosts() {
  return {share(testing::icosphere(2)),
          share(testing::torus(16, 8)),
          share(testing::genus3(1)),
          share(testing::saddle(6)),
          share(testing::cube(3)),
          share(testing::l_shape(2)),
          share(testing::bumpy_cube(4, 1.5, 0.1))};
}

TEST(HostDerivatives, AgreeWithFiniteDifferencesOnSurfacesThatMove) {
  RandomStream stream("host_derivatives", 1);
  std::size_t longest = 0;
  for (const auto& mesh : hosts()) {
    int checked = 0;
    for (int i = 0; i < 30; ++i) {
      const HostScene scene{mesh, testing::random_point(*mesh, stream), testing::random_point(*mesh, stream)};
      if (std::min(scene.from.barycentric.minCoeff(), scene.to.barycentric.minCoeff()) < 1e-2) continue;
      if (!is_away_from_faults(scene, 1e-2)) continue;
      checked += expect_host_derivatives(scene, random_motion(scene, stream), true, 3e-4, 1e-6);
      longest = std::max(longest, solved(scene).path.size());
    }
    EXPECT_GT(checked, 8);
  }
  EXPECT_GT(longest, 15u);
}

TEST(HostDerivatives, AgreeWithFiniteDifferencesInEveryVariable) {
  RandomStream stream("host_derivatives", 2);
  for (const auto& mesh : {share(testing::torus(10, 6)), share(testing::saddle(4))}) {
    for (int checked = 0; checked < 2;) {
      const HostScene scene{mesh, testing::random_point(*mesh, stream), testing::random_point(*mesh, stream)};
      if (std::min(scene.from.barycentric.minCoeff(), scene.to.barycentric.minCoeff()) < 1e-2) continue;
      if (!is_away_from_faults(scene, 1e-2) || solved(scene).path.size() < 6) continue;
      ++checked;
      const HostDerivatives derivatives = host_derivatives(*mesh, solved(scene).path);
      for (std::size_t k = 0; k < derivatives.vertices.size(); ++k) {
        for (int axis = 0; axis < 3; ++axis) {
          HostMotion motion{Vector3d::Zero(), Vector3d::Zero(), {}};
          motion.vertices.assign(mesh->vertex_count(), Vector3d::Zero());
          motion.vertices[derivatives.vertices[k]][axis] = mesh->mean_edge_length();
          EXPECT_TRUE(expect_host_derivatives(scene, motion, true, 3e-4, 1e-7));
        }
      }
    }
  }
}

TEST(HostDerivatives, AgreeWithFiniteDifferencesWhereVerticesBendThePath) {
  RandomStream stream("host_derivatives", 3);
  for (const auto& mesh :
       {share(testing::cone(12, 8.5, 3)), share(testing::slit_annulus(16, 3)), share(testing::l_shape(3))}) {
    int checked = 0;
    for (int i = 0; i < 200 && checked < 8; ++i) {
      const HostScene scene{mesh, testing::random_point(*mesh, stream), testing::random_point(*mesh, stream)};
      if (std::min(scene.from.barycentric.minCoeff(), scene.to.barycentric.minCoeff()) < 1e-2) continue;
      if (!is_away_from_faults(scene, 1e-2) || solved(scene).pinned_at.empty()) continue;
      checked += expect_host_derivatives(scene, random_motion(scene, stream), true, 1e-4, 1e-6);
    }
    EXPECT_EQ(checked, 8);
  }
}

/// A motion of barycentric coordinates that keeps the end in its face, at least for a while.
Vector3d inward(const SurfacePoint& end, RandomStream& stream) {
  Vector3d motion = Vector3d::Zero();
  for (int i = 0; i < 3; ++i) motion[i] = end.barycentric[i] == 0 ? stream.uniform(0.2, 1) : 0;
  int largest = 0;
  end.barycentric.maxCoeff(&largest);
  motion[largest] = -motion.sum();
  return motion;
}

TEST(HostDerivatives, AtEdgesAndVerticesAreThoseIntoTheFaceThatTheEndNames) {
  RandomStream stream("host_derivatives", 4);
  for (const auto& shape : {share(testing::icosphere(2)), share(testing::torus(16, 8)), share(testing::cube(3)),
                            share(testing::saddle(5))}) {
    // Without its symmetry: about a vertex the faces between unfold the shorter way round, and both are equal there.
    std::vector<Vector3d> positions = shape->positions();
    for (Vector3d& p : positions) p += 0.05 * shape->mean_edge_length() * random_vector(stream);
    const auto mesh = share(shape->with_positions(std::move(positions)));
    int checked = 0, turned = 0;
    for (int i = 0; i < 60; ++i) {
      const HostScene scene{
          mesh, i % 2 ? testing::random_edge_point(*mesh, stream) : testing::random_vertex_point(*mesh, stream),
          i % 3 ? testing::random_edge_point(*mesh, stream) : testing::random_point(*mesh, stream)};
      if (!is_away_from_faults(scene, 2e-2)) continue;
      const auto at_vertex = [](const SurfacePoint& end) {
        return side_of(end) >= 0 && end.barycentric.maxCoeff() > 0.9;
      };
      if (at_vertex(scene.from) || at_vertex(scene.to)) continue;
      HostMotion motion = random_motion(scene, stream);
      motion.from = inward(scene.from, stream);
      motion.to = inward(scene.to, stream);
      // Off its edge, into the face that it names, an end unfolds into the same plane; off a vertex it does not.
      if (corner_of(scene.from) >= 0) motion.from.setZero();
      if (!expect_host_derivatives(scene, motion, false, 2e-4, 1e-5)) continue;
      ++checked;
      const Geodesic g = solved(scene);
      turned += index(g.path[1].point.face) != index(scene.from.face);
    }
    EXPECT_GT(checked, 15);
    EXPECT_GT(turned, 3);
  }
}

TEST(HostDerivatives, OfTheEndsAloneAreThoseOfTheGeodesic) {
  RandomStream stream("host_derivatives", 5);
  auto meshes = hosts();
  meshes.push_back(share(testing::cone(12, 8.5, 3)));
  meshes.push_back(share(testing::sliver_sphere()));
  for (const auto& mesh : meshes) {
    for (int i = 0; i < 40; ++i) {
      const HostScene scene{
          mesh, i % 4 == 1 ? testing::random_edge_point(*mesh, stream) : testing::random_point(*mesh, stream),
          i % 4 == 2 ? testing::random_edge_point(*mesh, stream) : testing::random_point(*mesh, stream)};
      const Geodesic g = solved(scene, 2);
      if (g.unreachable || g.distance < 0.1 * mesh->mean_edge_length()) continue;
      const HostDerivatives derivatives = host_derivatives(*mesh, g.path);
      const double scale = 1 + g.derivatives->hessian.norm();
      EXPECT_LT((derivatives.gradient.head<6>() - g.derivatives->gradient).norm(), 1e-9) << i;
      EXPECT_LT((derivatives.hessian.topLeftCorner<6, 6>() - g.derivatives->hessian).norm(), 1e-9 * scale) << i;
    }
  }
}

// Motions of the whole do no work, and what they do to the gradient is known: exact checks, at the hardest paths too.
TEST(HostDerivatives, ExertNoForceAndNoMomentAndScaleWithTheSurface) {
  RandomStream stream("host_derivatives", 6);
  auto meshes = hosts();
  meshes.push_back(share(testing::cone(12, 8.5, 3)));
  meshes.push_back(share(testing::sliver_sphere(12, 4)));
  meshes.push_back(share(testing::needle_cylinder()));
  for (const auto& mesh : meshes) {
    for (int i = 0; i < 60; ++i) {
      const HostScene scene{
          mesh,
          i % 4 == 1   ? testing::random_edge_point(*mesh, stream)
          : i % 4 == 3 ? testing::random_vertex_point(*mesh, stream)
                       : testing::random_point(*mesh, stream),
          i % 4 == 2 ? testing::random_edge_point(*mesh, stream) : testing::random_point(*mesh, stream)};
      const Geodesic g = solved(scene);
      if (g.unreachable || g.distance < 1e-2 * mesh->mean_edge_length()) continue;
      const HostDerivatives d = host_derivatives(*mesh, g.path);
      const Eigen::Index n = d.gradient.size();
      const Vector3d axis = random_vector(stream);
      MatrixXd shift = MatrixXd::Zero(n, 3);
      VectorXd turn = VectorXd::Zero(n), turned = VectorXd::Zero(n), growth = VectorXd::Zero(n),
               grown = VectorXd::Zero(n);
      for (std::size_t k = 0; k < d.vertices.size(); ++k) {
        const Eigen::Index at = 6 + 3 * static_cast<Eigen::Index>(k);
        shift.block<3, 3>(at, 0).setIdentity();
        const Vector3d position = mesh->positions()[d.vertices[k]];
        turn.segment<3>(at) = axis.cross(position);
        turned.segment<3>(at) = axis.cross(Vector3d(d.gradient.segment<3>(at)));
        growth.segment<3>(at) = position;
      }
      grown.head<6>() = d.gradient.head<6>();
      EXPECT_LT((shift.transpose() * d.gradient).norm(), 1e-11);
      EXPECT_LT(std::abs(turn.dot(d.gradient)), 1e-11);
      EXPECT_NEAR(growth.dot(d.gradient), d.length, 1e-11);
      const double scale = 1e-12 * (1 + d.hessian.cwiseAbs().maxCoeff());
      EXPECT_LT((d.hessian * shift).cwiseAbs().maxCoeff(), scale) << i;
      EXPECT_LT((d.hessian * turn - turned).cwiseAbs().maxCoeff(), 10 * scale) << i;
      EXPECT_LT((d.hessian * growth - grown).cwiseAbs().maxCoeff(), 10 * scale) << i;
    }
  }
}

// In the plane the vertices between say nothing about a length, wherever the path runs: through them, along edges.
TEST(HostDerivatives, OfThePlaneIgnoreVerticesThatThePathPasses) {
  const auto mesh = share(testing::flat_grid(6, 5));
  const GeodesicSolver solver(mesh);
  const auto at = [&](double x, double y) {
    for (std::int32_t f = 0; f < mesh->face_count(); ++f) {
      const Triangle& t = mesh->faces()[f];
      Eigen::Matrix3d corners;
      for (int i = 0; i < 3; ++i) corners.col(i) = mesh->positions()[t[i]] + Vector3d::UnitZ();
      const Vector3d b = corners.inverse() * Vector3d(x, y, 1);
      if (b.minCoeff() > -1e-12) {
        const Vector3d exact = (b.array().abs() < 1e-12).select(0, b);
        return checked_point(*mesh, {FaceId(f), exact});
      }
    }
    return SurfacePoint{};
  };
  struct Pair {
    double ax, ay, bx, by;
  };
  for (const auto& [ax, ay, bx, by] : std::vector<Pair>{{1.5, 2, 4.5, 2},
                                                        {4.5, 2, 1.5, 2},
                                                        {1.25, 1.5, 4.75, 3.25},
                                                        {1.25, 1.25, 3.75, 3.75},
                                                        {1.5, 3.5, 3.5, 1.5},
                                                        {2, 1.25, 2, 3.75},
                                                        {1.2, 2.4, 4.1, 2.7},
                                                        {2, 2, 4, 3}}) {
    const SurfacePoint a = at(ax, ay), b = at(bx, by);
    const Geodesic g = solver.geodesic(a, b, {.derivatives = 2, .path = true});
    ASSERT_NEAR(g.distance, std::hypot(bx - ax, by - ay), 1e-14);
    const HostDerivatives d = host_derivatives(*mesh, g.path);
    EXPECT_LT((d.gradient.head<6>() - g.derivatives->gradient).norm(), 1e-12);
    EXPECT_LT((d.hessian.topLeftCorner<6, 6>() - g.derivatives->hessian).norm(), 1e-12);
    std::set<std::int32_t> of_ends;
    for (const SurfacePoint& end : {a, b}) {
      for (const std::int32_t v : mesh->faces()[index(end.face)]) of_ends.insert(v);
    }
    int between = 0;
    for (std::size_t k = 0; k < d.vertices.size(); ++k) {
      if (of_ends.count(d.vertices[k]) > 0) continue;
      ++between;
      const Eigen::Index row = 6 + 3 * static_cast<Eigen::Index>(k);
      EXPECT_LT(d.gradient.segment<2>(row).norm(), 1e-12);
      MatrixXd rows = d.hessian.middleRows(row, 2);
      for (Eigen::Index c = 8; c < rows.cols(); c += 3) EXPECT_LT(rows.col(c).norm(), 1e-12);  // by heights
      EXPECT_LT(rows.norm(), 1e-12) << ax << " " << ay << " vertex " << d.vertices[k];
    }
    EXPECT_GT(between, 0);
  }
}

TEST(HostDerivatives, OfAnEmptyPathAreZero) {
  const auto mesh = share(testing::icosphere(1));
  const SurfacePoint a{FaceId(3), {0.2, 0.3, 0.5}};
  const HostDerivatives d = host_derivatives(*mesh, solved({mesh, a, a}).path);
  EXPECT_EQ(d.length, 0);
  EXPECT_EQ(d.gradient.norm(), 0);
  EXPECT_EQ(d.hessian.norm(), 0);
}

TEST(ConvexHostHessian, HasNoNegativeCurvatureAndIsTheHessianWhereFlatFacesRise) {
  RandomStream random("convex_host", 1);
  for (const auto& mesh : {share(testing::icosphere(2)), share(testing::genus3(2)), share(testing::saddle(6)),
                           share(testing::trefoil_knot(40, 6))}) {
    for (int trial = 0; trial < 10; ++trial) {
      const HostScene scene{mesh, testing::random_point(*mesh, random), testing::random_point(*mesh, random)};
      const Geodesic path = solved(scene);
      const HostDerivatives exact = host_derivatives(*mesh, path.path);
      const MatrixXd convex = convex_host_hessian(*mesh, path.path, exact.vertices);
      ASSERT_EQ(convex.rows(), exact.hessian.rows());
      EXPECT_LT((convex - convex.transpose()).norm(), 1e-12 * convex.norm());
      const Eigen::SelfAdjointEigenSolver<MatrixXd> modes(convex);
      EXPECT_GT(modes.eigenvalues()[0], -1e-9 * modes.eigenvalues().tail<1>()[0]);
    }
  }
  const auto flat = share(testing::jittered_grid(6, 6, random));
  for (int trial = 0; trial < 10; ++trial) {
    const HostScene scene{flat, testing::random_point(*flat, random), testing::random_point(*flat, random)};
    const Geodesic path = solved(scene);
    if (path.path.size() < 3) continue;
    // Segments so short that they count as longer would make it another one.
    double shortest = path.distance;
    for (std::size_t i = 1; i < path.path.size(); ++i)
      shortest = std::min(shortest, (path.path[i].position - path.path[i - 1].position).norm());
    if (shortest < 2e-3 * path.distance) continue;
    const HostDerivatives exact = host_derivatives(*flat, path.path);
    const MatrixXd convex = convex_host_hessian(*flat, path.path, exact.vertices);
    // Vertices that leave the plane, and points that move across the path.
    for (std::size_t k = 0; k < exact.vertices.size(); ++k) {
      const Eigen::Index row = 6 + 3 * static_cast<Eigen::Index>(k) + 2;
      EXPECT_LT((convex.row(row) - exact.hessian.row(row)).norm(), 1e-6 * (1 + exact.hessian.norm()));
    }
    for (const Eigen::Index end : {0, 3}) {
      const Vector3d motion(1, 1, -2);
      EXPECT_NEAR(motion.dot(convex.block<3, 3>(end, end) * motion),
                  motion.dot(exact.hessian.block<3, 3>(end, end) * motion), 1e-6 * (1 + exact.hessian.norm()));
    }
  }
}

}  // namespace
}  // namespace supple::surface
