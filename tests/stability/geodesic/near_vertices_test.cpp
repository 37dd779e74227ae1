// Pairs of points that are both much nearer to one vertex than to anything else of the mesh. Hard: coordinates counted
// from another vertex of a face have lost the digits that such distances are made of. Expected values come from
// unfolding the fan of the vertex in extended precision.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "supple/surface/geodesic_solver.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using Real = long double;
using Vector = Eigen::Matrix<Real, 3, 1>;
using Eigen::Vector3d;
using testing::share;

Real angle_between(const Vector& a, const Vector& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// The faces around a vertex, laid out one beside the other.
class UnfoldedFan {
 public:
  UnfoldedFan(const TriangleMesh& mesh, std::int32_t vertex) : mesh_(mesh), open_(mesh.is_boundary(vertex)) {
    const std::int32_t first = mesh.outgoing(vertex);
    for (std::int32_t h = first; h >= 0;) {
      corners_.push_back(h);
      begins_.push_back(total_);
      total_ += angle_between(edge(h), last_edge(h));
      h = mesh.rotate(h);
      if (h == first) break;
    }
  }

  int corner_count() const { return static_cast<int>(corners_.size()); }
  std::int32_t halfedge(int corner) const { return corners_[corner]; }
  Real total_angle() const { return total_; }

  /// The point of a corner with the given barycentric coordinates of its other two vertices.
  SurfacePoint point(int corner, double head, double apex) const {
    const std::int32_t h = corners_[corner];
    SurfacePoint p{FaceId(TriangleMesh::face_of(h)), {}};
    p.barycentric[h % 3] = 1 - (head + apex);
    p.barycentric[(h + 1) % 3] = head;
    p.barycentric[(h + 2) % 3] = apex;
    return p;
  }

  /// Length of the shortest path near the vertex between two such points.
  double distance(int corner_a, const SurfacePoint& a, int corner_b, const SurfacePoint& b) const {
    const Vector from = offset(corner_a, a), to = offset(corner_b, b);
    if (corner_a == corner_b) return static_cast<double>((from - to).norm());
    const Real turn = std::abs(begins_[corner_a] + angle_between(edge(corners_[corner_a]), from) - begins_[corner_b] -
                               angle_between(edge(corners_[corner_b]), to));
    const Real angle = open_ ? turn : std::min(turn, total_ - turn);
    const Real ra = from.norm(), rb = to.norm();
    if (angle >= std::numbers::pi_v<Real>) return static_cast<double>(ra + rb);
    const Real half = std::sin(angle / 2);
    return static_cast<double>(std::sqrt((ra - rb) * (ra - rb) + 4 * ra * rb * half * half));
  }

 private:
  Vector between(std::int32_t from, std::int32_t to) const {
    return mesh_.positions()[to].cast<Real>() - mesh_.positions()[from].cast<Real>();
  }
  Vector edge(std::int32_t h) const { return between(mesh_.tail(h), mesh_.head(h)); }
  Vector last_edge(std::int32_t h) const { return between(mesh_.tail(h), mesh_.tail(TriangleMesh::previous(h))); }
  Vector offset(int corner, const SurfacePoint& p) const {
    const std::int32_t h = corners_[corner];
    return Real(p.barycentric[(h + 1) % 3]) * edge(h) + Real(p.barycentric[(h + 2) % 3]) * last_edge(h);
  }

  const TriangleMesh& mesh_;
  bool open_;
  std::vector<std::int32_t> corners_;
  std::vector<Real> begins_;  ///< angle at which each corner begins
  Real total_ = 0;
};

struct Surface {
  const char* name;
  std::shared_ptr<const TriangleMesh> mesh;
};

std::vector<Surface> surfaces() {
  RandomStream stream("near_vertices_grid", 1);
  return {{"convex", share(testing::icosphere(3))},
          {"convex and saddle", share(testing::torus(24, 12))},
          {"saddle with a boundary", share(testing::saddle(8))},
          {"flat with a boundary", share(testing::jittered_grid(6, 6, stream))},
          {"sharp tip", share(testing::cone(6, 1.0, 2))},
          {"saddle of 8.5 radians", share(testing::cone(12, 8.5, 2))},
          {"boundary that paths bend round", share(testing::l_shape(2))}};
}

class NearAVertex : public ::testing::TestWithParam<double> {};

TEST_P(NearAVertex, PairsAreAsFarApartAsInTheUnfoldedFan) {
  const double size = GetParam();
  for (const Surface& surface : surfaces()) {
    const TriangleMesh& mesh = *surface.mesh;
    const GeodesicSolver solver(surface.mesh);
    RandomStream stream("near_vertices", 1);
    int wrong = 0;
    double worst = 0;
    const auto compare = [&](double found, double expected) {
      const double error = std::abs(found - expected) / expected;
      wrong += !(error < 1e-9);
      worst = std::isfinite(error) ? std::max(worst, error) : error;
    };
    for (int i = 0; i < 300; ++i) {
      // The first vertex of the cones is their tip, and the corner of the L is its only one of more than pi.
      const std::int32_t vertex = i % 4 == 0 ? 0 : stream.below(mesh.vertex_count());
      const UnfoldedFan fan(mesh, vertex);
      const int corner_a = stream.below(fan.corner_count()), corner_b = stream.below(fan.corner_count());
      // Points with coordinates below 1e-14 count as the vertex.
      const double far = i % 3 == 0 ? std::max(1e-3 * size, 1e-12) : size;
      const SurfacePoint a = fan.point(corner_a, size * stream.uniform(0.02, 0.5), size * stream.uniform(0.02, 0.5));
      const SurfacePoint b = fan.point(corner_b, far * stream.uniform(0.02, 0.5), far * stream.uniform(0.02, 0.5));
      const double expected = fan.distance(corner_a, a, corner_b, b);
      compare(solver.distance(a, b), expected);
      compare(solver.distance(b, a), expected);
      compare(solver.geodesics(a, {{b}})[0].distance, expected);
      if (i % 10 == 0) compare(solver.field({{a}}, {.keep_windows = true}).distance(b), expected);
    }
    EXPECT_EQ(wrong, 0) << surface.name << ": worst relative error " << worst;
  }
}

// The fan of a vertex looks the same at every scale, and a hundredth of an edge away windows find its paths.
TEST_P(NearAVertex, PathsAndDerivativesAreThoseFurtherAwayMadeSmaller) {
  const double shrink = GetParam();
  for (const Surface& surface : surfaces()) {
    const TriangleMesh& mesh = *surface.mesh;
    const GeodesicSolver solver(surface.mesh);
    RandomStream stream("near_vertices_scaled", 2);
    int pinned = 0, straight = 0;
    for (int i = 0; i < 200; ++i) {
      const std::int32_t vertex = i % 4 == 0 ? 0 : stream.below(mesh.vertex_count());
      const UnfoldedFan fan(mesh, vertex);
      const int corner_a = stream.below(fan.corner_count()), corner_b = stream.below(fan.corner_count());
      const auto drawn = [&] { return 0.01 * stream.uniform(0.1, 1); };
      double coordinates[4] = {drawn(), drawn(), drawn(), drawn()};
      // Some ends lie on edges.
      if (i % 5 == 0) coordinates[i % 4] = 0;
      const auto ask = [&](double scale) {
        return solver.geodesic(fan.point(corner_a, scale * coordinates[0], scale * coordinates[1]),
                               fan.point(corner_b, scale * coordinates[2], scale * coordinates[3]),
                               {.derivatives = 2, .path = true});
      };
      const Geodesic large = ask(1), small = ask(shrink);
      // Where two paths are equally long either may be given.
      if (large.competing_excess < 1e-9 * large.distance) continue;
      const std::string where = std::string(surface.name) + ", pair " + std::to_string(i);
      EXPECT_NEAR(small.distance, shrink * large.distance, 1e-9 * small.distance) << where;
      ASSERT_EQ(small.pinned_at, large.pinned_at) << where;
      (small.pinned_at.empty() ? straight : pinned) += 1;
      ASSERT_TRUE(small.derivatives) << where;
      const GeodesicDerivatives &ds = *small.derivatives, &dl = *large.derivatives;
      EXPECT_LT((ds.tangent_gradient - dl.tangent_gradient).norm(), 1e-8) << where;
      EXPECT_LT((shrink * ds.tangent_hessian - dl.tangent_hessian).norm(), 1e-8 * dl.tangent_hessian.norm()) << where;
      ASSERT_EQ(small.path.size(), large.path.size()) << where;
      for (std::size_t k = 0; k < small.path.size(); ++k) {
        EXPECT_EQ(small.path[k].vertex, large.path[k].vertex) << where;
        // In a face of both paths, whichever of an edge's two a crossing is written in.
        const Vector3d at_vertex = mesh.positions()[vertex];
        const Vector3d expected = at_vertex + shrink * (large.path[k].position - at_vertex);
        EXPECT_LT((small.path[k].position - expected).norm(), 1e-9 * shrink + 1e-15 * (1 + at_vertex.norm()))
            << where << ", point " << k;
      }
    }
    EXPECT_GT(straight + pinned, 150) << surface.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Within, NearAVertex, ::testing::Values(1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10));

}  // namespace
}  // namespace supple::surface
