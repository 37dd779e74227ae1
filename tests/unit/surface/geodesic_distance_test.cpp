// Exact distances where they are known in closed form, and the laws that any distance obeys.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "supple/base/error.h"
#include "supple/surface/exponential_map.h"
#include "supple/surface/geodesic_solver.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using Eigen::Vector3d;
using testing::share;

/// The vertex nearest to a place.
SurfacePoint vertex_at(const TriangleMesh& mesh, const Vector3d& place) {
  std::int32_t best = 0;
  for (std::int32_t v = 1; v < mesh.vertex_count(); ++v) {
    if ((mesh.positions()[v] - place).norm() < (mesh.positions()[best] - place).norm()) best = v;
  }
  return vertex_point(mesh, VertexId(best));
}

TEST(GeodesicDistance, OnAFlatGridIsTheStraightLineFromAndToInteriorsEdgesAndVertices) {
  RandomStream stream("flat", 1);
  RandomStream jitter("jitter", 2);
  for (const auto& mesh : {share(testing::flat_grid(9, 7)), share(testing::jittered_grid(9, 7, jitter))}) {
    const GeodesicSolver solver(mesh);
    const auto draw = [&](int kind) {
      return kind == 0   ? testing::random_point(*mesh, stream)
             : kind == 1 ? testing::random_edge_point(*mesh, stream)
                         : testing::random_vertex_point(*mesh, stream);
    };
    for (int i = 0; i < 900; ++i) {
      const SurfacePoint a = draw(i % 3);
      const SurfacePoint b = draw(i / 3 % 3);
      const double exact = (position(*mesh, a) - position(*mesh, b)).norm();
      EXPECT_NEAR(solver.distance(a, b), exact, 1e-13 * 12) << "case " << i;
      FieldOptions options;
      options.keep_windows = true;
      if (i % 50 == 0) {
        const GeodesicField field = solver.field({&a, 1}, options);
        for (int k = 0; k < 60; ++k) {
          const SurfacePoint c = draw(k % 3);
          EXPECT_NEAR(field.distance(c), (position(*mesh, a) - position(*mesh, c)).norm(), 1e-13 * 12);
        }
      }
    }
  }
}

TEST(GeodesicDistance, OnTheUnitCubeTakesTheBestUnfolding) {
  for (const int n : {1, 2, 5}) {
    const auto mesh = share(testing::cube(n));
    const GeodesicSolver solver(mesh);
    const SurfacePoint corner = vertex_at(*mesh, {0, 0, 0});
    EXPECT_NEAR(solver.distance(corner, vertex_at(*mesh, {1, 1, 1})), std::sqrt(5.0), 1e-13) << n;
    EXPECT_NEAR(solver.distance(corner, vertex_at(*mesh, {1, 1, 0})), std::sqrt(2.0), 1e-13) << n;
    EXPECT_NEAR(solver.distance(corner, vertex_at(*mesh, {0, 0, 1})), 1.0, 1e-13) << n;
  }
  const auto mesh = share(testing::cube(2));
  const GeodesicSolver solver(mesh);
  const SurfacePoint bottom = vertex_at(*mesh, {0.5, 0.5, 0});
  EXPECT_NEAR(solver.distance(bottom, vertex_at(*mesh, {0.5, 0.5, 1})), 2.0, 1e-13);
  EXPECT_NEAR(solver.distance(bottom, vertex_at(*mesh, {0.5, 0, 0.5})), 1.0, 1e-13);
}

TEST(GeodesicDistance, OnConesFollowsPlaneTrigonometryOrPassesTheApex) {
  // At polar angles a and b of a cone of total angle T, the development has the angle min(|a-b|, T-|a-b|) between the
  // points; from pi on the path goes through the apex.
  for (const double total : {1.0, 3.0, 5.5, 6.9, 9.0}) {
    const int sectors = 12;
    const auto mesh = share(testing::cone(sectors, total, 4));
    const GeodesicSolver solver(mesh);
    const double sector = total / sectors;
    RandomStream stream("cone", static_cast<std::uint64_t>(100 * total));
    const auto rim = [&](std::int32_t v) { return (mesh->positions()[v] - mesh->positions()[0]).norm(); };
    // Vertices of the first ray and of the others, by their slant distance to the apex and their order.
    for (int i = 0; i < 400; ++i) {
      const std::int32_t a = 1 + stream.below(mesh->vertex_count() - 1);
      const std::int32_t b = 1 + stream.below(mesh->vertex_count() - 1);
      // The apex's fan gives each ray's polar angle: walk from the apex along the ray by the exponential map.
      const double ra = rim(a);
      const double rb = rim(b);
      const double to_apex_a = solver.distance(vertex_point(*mesh, VertexId(a)), vertex_point(*mesh, VertexId(0)));
      EXPECT_NEAR(to_apex_a, ra, 1e-13);
      const double d = solver.distance(vertex_point(*mesh, VertexId(a)), vertex_point(*mesh, VertexId(b)));
      bool matches = false;
      for (int k = 0; k <= sectors / 2; ++k) {
        const double angle = k * sector;
        const double exact =
            angle >= std::numbers::pi ? ra + rb : std::sqrt(ra * ra + rb * rb - 2 * ra * rb * std::cos(angle));
        matches = matches || std::abs(d - exact) < 1e-12;
      }
      EXPECT_TRUE(matches) << "total " << total << " vertices " << a << " " << b << " distance " << d;
    }
  }
}

TEST(GeodesicDistance, BendsRoundTheInnerCornerOfAnL) {
  const auto mesh = share(testing::l_shape(4));
  const GeodesicSolver solver(mesh);
  RandomStream stream("l", 3);
  int bent = 0;
  for (int i = 0; i < 400; ++i) {
    const SurfacePoint a = testing::random_point(*mesh, stream);
    const SurfacePoint b = testing::random_point(*mesh, stream);
    const Vector3d p = position(*mesh, a);
    const Vector3d q = position(*mesh, b);
    const Vector3d corner(1, 1, 0);
    // The straight line is blocked if it passes through (1, 2]^2: if at the corner's height it is beyond the corner.
    const Vector3d& low = p.x() < q.x() ? p : q;
    const Vector3d& high = p.x() < q.x() ? q : p;
    const double area = (high - low).x() * (corner - low).y() - (high - low).y() * (corner - low).x();
    const bool blocked = (p.x() - 1) * (q.x() - 1) < 0 && (p.y() - 1) * (q.y() - 1) < 0 && low.y() > 1 && area < 0;
    const double exact = blocked ? (p - corner).norm() + (q - corner).norm() : (p - q).norm();
    const Geodesic g = solver.geodesic(a, b);
    EXPECT_NEAR(g.distance, exact, 1e-12) << "case " << i;
    EXPECT_EQ(g.pinned_at.size(), blocked ? 1u : 0u);
    bent += blocked;
  }
  EXPECT_GT(bent, 20);
}

TEST(GeodesicDistance, IsSymmetricAndObeysTheTriangleInequality) {
  for (const auto& mesh : {share(testing::genus3()), share(testing::saddle(12)), share(testing::sliver_sphere()),
                           share(testing::bumpy_cube(10)), share(testing::slit_annulus())}) {
    const GeodesicSolver solver(mesh);
    RandomStream stream("metric", 4);
    for (int i = 0; i < 100; ++i) {
      const SurfacePoint a = testing::random_point(*mesh, stream);
      const SurfacePoint b = testing::random_edge_point(*mesh, stream);
      const SurfacePoint c = i % 2 ? testing::random_vertex_point(*mesh, stream) : testing::random_point(*mesh, stream);
      const double ab = solver.distance(a, b);
      EXPECT_NEAR(ab, solver.distance(b, a), 1e-12 * ab);
      EXPECT_LE(ab, (solver.distance(a, c) + solver.distance(c, b)) * (1 + 1e-12));
      EXPECT_GE(ab, (position(*mesh, a) - position(*mesh, b)).norm() * (1 - 1e-12));
    }
  }
}

TEST(GeodesicDistance, OfPointsATenMillionthOfAnEdgeApartAcrossItIsRelativelyAccurate) {
  for (const auto& mesh : {share(testing::icosphere(3)), share(testing::sliver_sphere()), share(testing::torus())}) {
    const GeodesicSolver solver(mesh);
    RandomStream stream("close", 5);
    for (int i = 0; i < 500; ++i) {
      std::int32_t h = stream.below(mesh->halfedge_count());
      while (mesh->twin(h) < 0) h = stream.below(mesh->halfedge_count());
      const std::int32_t twin = mesh->twin(h);
      // Multiples of 2^-52, so that the third coordinate is exact: otherwise the points themselves are only known to
      // 1e-16 of the edge, a billionth of their distance.
      const auto exact_in_binary = [](double x) { return std::round(x * 0x1p52) * 0x1p-52; };
      const double t = exact_in_binary(stream.uniform(0.1, 0.9));
      const double up = exact_in_binary(1e-7 * stream.uniform(0.1, 1));
      const double shift = exact_in_binary(1e-7 * stream.uniform(-1, 1));
      const auto point = [](std::int32_t halfedge, double along, double height) {
        SurfacePoint p;
        p.face = FaceId(halfedge / 3);
        p.barycentric[(halfedge + 1) % 3] = along;
        p.barycentric[(halfedge + 2) % 3] = height;
        p.barycentric[halfedge % 3] = 1 - (along + height);
        return p;
      };
      const SurfacePoint a = point(h, t, up);
      const SurfacePoint b = point(twin, 1 - t + shift, up);
      // The same in extended precision, in the plane of the two unfolded faces; the edge's coordinate from its head.
      using Wide = long double;
      const Wide length = mesh->edge_length(h);
      const Wide ax = mesh->edge_length(TriangleMesh::previous(h)) * std::cos(Wide(mesh->corner_angle(h)));
      const Wide ay = mesh->edge_length(TriangleMesh::previous(h)) * std::sin(Wide(mesh->corner_angle(h)));
      const Wide bx = mesh->edge_length(TriangleMesh::previous(twin)) * std::cos(Wide(mesh->corner_angle(twin)));
      const Wide by = mesh->edge_length(TriangleMesh::previous(twin)) * std::sin(Wide(mesh->corner_angle(twin)));
      const Wide a_head = a.barycentric[(h + 1) % 3];
      const Wide b_head = b.barycentric[twin % 3];
      const Wide dx = length * (a_head - b_head) + Wide(up) * ax - Wide(up) * (length - bx);
      const Wide dy = Wide(up) * ay + Wide(up) * by;
      const double exact = static_cast<double>(std::sqrt(dx * dx + dy * dy));
      EXPECT_NEAR(solver.distance(a, b), exact, 1e-9 * exact) << "halfedge " << h;
      const GeodesicField field = solver.field({&a, 1}, {.max_distance = 1e-3, .keep_windows = true});
      EXPECT_NEAR(field.distance(b), exact, 1e-9 * exact) << "halfedge " << h;
    }
  }
}

TEST(GeodesicDistance, DoesNotDependOnTheFaceThatAnEdgeOrVertexPointIsWrittenIn) {
  const auto mesh = share(testing::torus(16, 8));
  const GeodesicSolver solver(mesh);
  RandomStream stream("written", 6);
  for (int i = 0; i < 200; ++i) {
    const SurfacePoint other = testing::random_point(*mesh, stream);
    const std::int32_t h = stream.below(mesh->halfedge_count());
    const double t = stream.uniform();
    SurfacePoint here{FaceId(h / 3), Vector3d::Zero()};
    here.barycentric[h % 3] = 1 - t;
    here.barycentric[(h + 1) % 3] = t;
    const std::int32_t twin = mesh->twin(h);
    SurfacePoint there{FaceId(twin / 3), Vector3d::Zero()};
    there.barycentric[twin % 3] = t;
    there.barycentric[(twin + 1) % 3] = 1 - t;
    const double d = solver.distance(here, other);
    EXPECT_NEAR(d, solver.distance(there, other), 1e-13 * d);
    EXPECT_NEAR(d, solver.distance(other, here), 1e-13 * d);
    EXPECT_NEAR(d, solver.distance(other, there), 1e-13 * d);
    EXPECT_EQ(solver.distance(here, here), 0);
  }
}

TEST(GeodesicDistance, BetweenComponentsIsUnreachableAndInfinite) {
  const auto mesh = share(testing::two_components());
  const GeodesicSolver solver(mesh);
  const SurfacePoint a{FaceId(0), {0.2, 0.3, 0.5}};
  const SurfacePoint b{FaceId(mesh->face_count() - 1), {0.2, 0.3, 0.5}};
  const Geodesic g = solver.geodesic(a, b, {.derivatives = 2, .path = true});
  EXPECT_TRUE(g.unreachable);
  EXPECT_TRUE(std::isinf(g.distance));
  EXPECT_TRUE(g.path.empty());
  EXPECT_FALSE(g.derivatives.has_value());
  const SurfacePoint targets[] = {b, a};
  const auto many = solver.geodesics(a, targets);
  EXPECT_TRUE(many[0].unreachable);
  EXPECT_EQ(many[1].distance, 0);
  const GeodesicField field = solver.field({&a, 1}, {.keep_windows = true});
  EXPECT_TRUE(std::isinf(field.distance(b)));
  EXPECT_EQ(field.nearest_source(b), -1);
}

TEST(GeodesicDistance, IsTheSameToTheLastBitOnEveryRunAndFromAKnownPath) {
  const auto mesh = share(testing::bumpy_cube(12));
  const GeodesicSolver solver(mesh);
  RandomStream stream("again", 8);
  for (int i = 0; i < 40; ++i) {
    const SurfacePoint a = testing::random_point(*mesh, stream);
    const SurfacePoint b = testing::random_point(*mesh, stream);
    const Geodesic first = solver.geodesic(a, b, {.path = true});
    EXPECT_EQ(first.distance, solver.geodesic(a, b).distance);
    EXPECT_EQ(first.distance, GeodesicSolver(mesh).distance(a, b));
    EXPECT_NEAR(first.distance, solver.geodesic(a, b, {}, {}, {.known_path = &first.path}).distance,
                1e-14 * first.distance);
  }
}

TEST(GeodesicDistance, IsTheSameWithALandmarkAndNeedsFewerWindowsOnAShapeThatWinds) {
  for (const auto& mesh : {share(testing::trefoil_knot(80, 10)), share(testing::spiral_cup(120, 8)),
                           share(testing::genus3(2)), share(testing::l_shape(6))}) {
    const GeodesicSolver solver(mesh);
    RandomStream stream("landmark", 10);
    CostLedger plain;
    CostLedger guided;
    for (int i = 0; i < 30; ++i) {
      const SurfacePoint a = testing::random_point(*mesh, stream);
      const SurfacePoint b = i % 3 ? testing::random_point(*mesh, stream) : testing::random_vertex_point(*mesh, stream);
      const SurfacePoint near = exponential_map(*mesh, b, {0.1, 0.05, 0.02}, {}).end;
      const GeodesicField field = solver.field({&near, 1});
      const PairHints hints{nullptr, &field, solver.distance(near, b)};
      const double d = solver.geodesic(a, b, {}, {.cost = &plain}).distance;
      EXPECT_NEAR(solver.geodesic(a, b, {}, {.cost = &guided}, hints).distance, d, 1e-13 * d);
    }
    EXPECT_LT(guided.quantities()[0].value, plain.quantities()[0].value);
  }
}

TEST(GeodesicDistance, StopsWhenCancelled) {
  const auto mesh = share(testing::icosphere(5));
  const GeodesicSolver solver(mesh);
  Execution execution;
  execution.cancellation.request(StopReason::cancelled);
  const SurfacePoint a{FaceId(0), {0.2, 0.3, 0.5}};
  EXPECT_THROW(solver.field({&a, 1}, {}, execution), Cancelled);
  // The search that was stopped is back in the pool and works again.
  EXPECT_EQ(solver.field({&a, 1}).vertex_distances().size(), static_cast<std::size_t>(mesh->vertex_count()));
}

TEST(GeodesicField, FromSeveralSourcesIsTheLeastOfEach) {
  const auto mesh = share(testing::torus(24, 12));
  const GeodesicSolver solver(mesh);
  RandomStream stream("several", 9);
  std::vector<SurfacePoint> sources;
  for (int i = 0; i < 5; ++i) sources.push_back(testing::random_point(*mesh, stream));
  sources.push_back(testing::random_vertex_point(*mesh, stream));
  sources.push_back(testing::random_edge_point(*mesh, stream));
  const GeodesicField field = solver.field(sources, {.keep_windows = true});
  for (int i = 0; i < 200; ++i) {
    const SurfacePoint p = testing::random_point(*mesh, stream);
    double least = std::numeric_limits<double>::infinity();
    int nearest = -1;
    for (std::size_t k = 0; k < sources.size(); ++k) {
      const double d = solver.distance(sources[k], p);
      if (d < least) {
        least = d;
        nearest = static_cast<int>(k);
      }
    }
    EXPECT_NEAR(field.distance(p), least, 1e-12);
    EXPECT_EQ(field.nearest_source(p), nearest);
  }
}

TEST(GeodesicField, IsTheLeastOfWhatArrivesInAFace) {
  const auto mesh = share(testing::genus3(2));
  const GeodesicSolver solver(mesh);
  RandomStream stream("arrivals", 3);
  std::vector<SurfacePoint> sources;
  for (int i = 0; i < 4; ++i) sources.push_back(testing::random_point(*mesh, stream));
  sources.push_back(testing::random_vertex_point(*mesh, stream));
  sources.push_back(testing::random_edge_point(*mesh, stream));
  const GeodesicField field = solver.field(sources, {.keep_windows = true});
  const GeodesicField edges = solver.field(sources, {.method = FieldMethod::edge_graph});
  std::vector<FaceArrival> arrivals;
  for (std::int32_t f = 0; f < mesh->face_count(); ++f) {
    SurfacePoint p{FaceId(f), {stream.uniform(), stream.uniform(), stream.uniform()}};
    p.barycentric /= p.barycentric.sum();
    const Eigen::Vector2d place =
        tangent_frame(*mesh, p.face).transpose() * (position(*mesh, p) - mesh->positions()[mesh->faces()[f][0]]);
    const auto least = [&](const GeodesicField& of) {
      of.arrivals(p.face, arrivals);
      return *std::min_element(arrivals.begin(), arrivals.end(), [&](const FaceArrival& a, const FaceArrival& b) {
        return a.length_to(place) < b.length_to(place);
      });
    };
    const FaceArrival nearest = least(field);
    EXPECT_NEAR(nearest.length_to(place), field.distance(p), 1e-12);
    EXPECT_EQ(nearest.source, field.nearest_source(p));
    EXPECT_GE(least(edges).length_to(place), field.distance(p) - 1e-12);
  }
  for (std::int32_t v = 0; v < mesh->vertex_count(); ++v) {
    const SurfacePoint p = vertex_point(*mesh, VertexId(v));
    EXPECT_EQ(field.vertex_sources()[v], field.nearest_source(p));
    EXPECT_GE(edges.vertex_sources()[v], 0);
  }
}

TEST(GeodesicField, KnowingOtherDistancesIsRightWhereItsOwnSourcesAreTheNearest) {
  const auto mesh = share(testing::genus3(2));
  const GeodesicSolver solver(mesh);
  RandomStream stream("known", 1);
  std::vector<SurfacePoint> others;
  for (int i = 0; i < 12; ++i) others.push_back(testing::random_point(*mesh, stream));
  const std::vector<SurfacePoint> own{testing::random_point(*mesh, stream),
                                      testing::random_vertex_point(*mesh, stream)};
  std::vector<SurfacePoint> all = own;
  all.insert(all.end(), others.begin(), others.end());
  const std::vector<double> known = solver.field(others).vertex_distances();
  const GeodesicField whole = solver.field(all, {.keep_windows = true});
  const GeodesicField part = solver.field(own, {.keep_windows = true, .known_distances = known});
  EXPECT_LT(part.window_count(), whole.window_count() / 2);
  int of_own = 0;
  for (std::int32_t v = 0; v < mesh->vertex_count(); ++v) {
    EXPECT_NEAR(part.vertex_distances()[v], whole.vertex_distances()[v], 1e-13 * mesh->diagonal());
    EXPECT_EQ(part.vertex_sources()[v], std::min(whole.vertex_sources()[v], 2));
    of_own += part.vertex_sources()[v] < 2 ? 1 : 0;
  }
  EXPECT_GT(of_own, 20);
  int reached = 0;
  std::vector<FaceArrival> arrivals;
  for (std::int32_t face = 0; face < mesh->face_count(); ++face) {
    const SurfacePoint centre{FaceId(face), Vector3d::Constant(1.0 / 3)};
    if (whole.nearest_source(centre) < 2) {
      EXPECT_TRUE(part.reaches(FaceId(face)));
      EXPECT_NEAR(part.distance(centre), whole.distance(centre), 1e-13 * mesh->diagonal());
    }
    if (!part.reaches(FaceId(face))) {
      part.arrivals(FaceId(face), arrivals);
      for (const FaceArrival& arrival : arrivals) EXPECT_EQ(arrival.source, 2);
    }
    reached += part.reaches(FaceId(face)) ? 1 : 0;
  }
  EXPECT_LT(reached, mesh->face_count() / 2);
}

TEST(GeodesicField, WithoutKeptWindowsRefusesPointQueries) {
  const auto mesh = share(testing::icosphere(1));
  const GeodesicSolver solver(mesh);
  const SurfacePoint a{FaceId(0), {0.2, 0.3, 0.5}};
  try {
    solver.field({&a, 1}).distance(a);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "field.not_kept");
  }
}

}  // namespace
}  // namespace supple::surface
