#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "supple/surface/triangle_mesh.h"
#include "support/expect_error.h"
#include "support/parametric.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using testing::expect_error;
using testing::places;
using Places = std::vector<std::string>;

const std::vector<Eigen::Vector3d> square = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

TriangleMesh tetrahedron() {
  return TriangleMesh::build({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                             {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}});
}

TEST(MeshBuild, TwinsRunAlongTheSameEdgeInOppositeDirections) {
  for (const TriangleMesh& mesh : {tetrahedron(), testing::torus(), testing::saddle(5), testing::genus3(2)}) {
    for (std::int32_t h = 0; h < mesh.halfedge_count(); ++h) {
      EXPECT_EQ(mesh.head(h), mesh.tail(TriangleMesh::next(h)));
      EXPECT_EQ(TriangleMesh::previous(TriangleMesh::next(h)), h);
      const std::int32_t twin = mesh.twin(h);
      if (twin < 0) continue;
      ASSERT_EQ(mesh.twin(twin), h);
      ASSERT_EQ(mesh.tail(twin), mesh.head(h));
      ASSERT_EQ(mesh.head(twin), mesh.tail(h));
      ASSERT_EQ(mesh.edge_length(twin), mesh.edge_length(h));
    }
  }
}

TEST(MeshBuild, RotatingVisitsEveryFaceAroundAVertexOnce) {
  for (const TriangleMesh& mesh : {testing::torus(12, 8), testing::saddle(4), testing::cone(6, 8.0, 3)}) {
    std::vector<std::set<std::int32_t>> faces(mesh.vertex_count());
    for (std::int32_t h = 0; h < mesh.halfedge_count(); ++h) faces[mesh.tail(h)].insert(h / 3);
    for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
      std::set<std::int32_t> visited;
      double angle = 0;
      std::int32_t h = mesh.outgoing(v);
      if (mesh.is_boundary(v)) {
        EXPECT_EQ(mesh.twin(h), -1);
      }
      do {
        ASSERT_EQ(mesh.tail(h), v);
        ASSERT_TRUE(visited.insert(h / 3).second);
        angle += mesh.corner_angle(h);
        h = mesh.rotate(h);
      } while (h >= 0 && h != mesh.outgoing(v));
      EXPECT_EQ(h < 0, mesh.is_boundary(v));
      EXPECT_EQ(visited, faces[v]);
      EXPECT_DOUBLE_EQ(angle, mesh.vertex_angle(v));
    }
  }
}

TEST(MeshBuild, MeasuresLengthsAnglesAndExtent) {
  const TriangleMesh mesh = TriangleMesh::build({{1, 1, 1}, {4, 1, 1}, {1, 5, 1}}, {{0, 1, 2}});
  EXPECT_DOUBLE_EQ(mesh.edge_length(0), 3);
  EXPECT_DOUBLE_EQ(mesh.edge_length(1), 5);
  EXPECT_DOUBLE_EQ(mesh.edge_length(2), 4);
  EXPECT_DOUBLE_EQ(mesh.corner_angle(0), std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(mesh.corner_angle(1), std::atan2(4, 3));
  EXPECT_DOUBLE_EQ(mesh.mean_edge_length(), 4);
  EXPECT_DOUBLE_EQ(mesh.diagonal(), 5);
}

TEST(MeshBuild, AnglesOfSliversKeepTheirDigits) {
  const TriangleMesh mesh = TriangleMesh::build({{0, 0, 0}, {1, 0, 0}, {0.5, 1e-9, 0}}, {{0, 1, 2}});
  EXPECT_NEAR(mesh.corner_angle(0), 2e-9, 1e-23);
  EXPECT_NEAR(mesh.corner_angle(2), std::numbers::pi - 4e-9, 1e-15);
}

TEST(MeshBuild, VertexAnglesShowWhereTheSurfaceIsCurved) {
  EXPECT_NEAR(testing::cube(3).vertex_angle(0), 1.5 * std::numbers::pi, 1e-14);
  EXPECT_NEAR(testing::cone(10, 9.0).vertex_angle(0), 9.0, 1e-13);
  EXPECT_NEAR(testing::cone(7, 4.0).vertex_angle(0), 4.0, 1e-13);
}

TEST(MeshBuild, NumbersComponentsInTheOrderOfTheirFirstFaces) {
  const TriangleMesh mesh = testing::two_components();
  EXPECT_EQ(mesh.component_count(), 2);
  EXPECT_EQ(mesh.component(0), 0);
  EXPECT_EQ(mesh.component(mesh.face_count() - 1), 1);
}

TEST(MeshBuild, TurnsTheFewerFacesUntilNeighboursAgree) {
  testing::Soup soup =
      testing::parametric_grid(4, 4, testing::Wrap::none, [](int i, int j) { return Eigen::Vector3d(i, j, 0); });
  const std::vector<Triangle> right = soup.faces;
  for (const int f : {0, 7, 20}) std::swap(soup.faces[f][0], soup.faces[f][2]);
  const TriangleMesh mesh = std::move(soup).build();
  ASSERT_EQ(mesh.warnings().size(), 1u);
  EXPECT_EQ(mesh.warnings()[0].substr(0, 19), "3 faces were turned");
  for (std::int32_t f = 0; f < mesh.face_count(); ++f) {
    const Eigen::Vector3d a = mesh.positions()[mesh.faces()[f][0]];
    const Eigen::Vector3d u = mesh.positions()[mesh.faces()[f][1]] - a, v = mesh.positions()[mesh.faces()[f][2]] - a;
    EXPECT_GT(u[0] * v[1] - u[1] * v[0], 0) << "face " << f;
    EXPECT_EQ(std::set<std::int32_t>(mesh.faces()[f].begin(), mesh.faces()[f].end()),
              std::set<std::int32_t>(right[f].begin(), right[f].end()));
  }
  for (std::int32_t h = 0; h < mesh.halfedge_count(); ++h) {
    if (mesh.twin(h) >= 0) {
      EXPECT_EQ(mesh.tail(mesh.twin(h)), mesh.head(h));
    }
  }
}

TEST(MeshBuild, WarnsOfUnusedAndOfCoincidentVertices) {
  const TriangleMesh mesh =
      TriangleMesh::build({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {9, 9, 9}, {1, -0.0, 0}}, {{0, 1, 2}});
  ASSERT_EQ(mesh.warnings().size(), 2u);
  EXPECT_EQ(mesh.warnings()[0], "2 vertices belong to no face.");
  EXPECT_EQ(mesh.warnings()[1].substr(0, 12), "1 vertex has");
  EXPECT_EQ(mesh.outgoing(3), -1);
  EXPECT_DOUBLE_EQ(mesh.diagonal(), std::sqrt(2));
}

TEST(MeshBuild, RefusesAMeshWithoutVerticesOrFaces) {
  EXPECT_EQ(places(expect_error("mesh.empty", [] { TriangleMesh::build({}, {}); })), Places{"vertices"});
  EXPECT_EQ(places(expect_error("mesh.empty", [] { TriangleMesh::build(square, {}); })), Places{"faces"});
}

TEST(MeshBuild, NamesVerticesThatAreNotFiniteOrTooLarge) {
  std::vector<Eigen::Vector3d> positions = square;
  positions[1][2] = std::numeric_limits<double>::quiet_NaN();
  positions[3][0] = -std::numeric_limits<double>::infinity();
  const Error error = expect_error("mesh.non_finite", [&] { TriangleMesh::build(positions, {{0, 1, 2}, {0, 2, 3}}); });
  EXPECT_EQ(places(error), (Places{"vertex 1", "vertex 3"}));
  positions = square;
  positions[2][1] = 1e71;
  EXPECT_EQ(places(expect_error("mesh.non_finite",
                                [&] {
                                  TriangleMesh::build(positions, {{0, 1, 2}});
                                })),
            Places{"vertex 2"});
}

TEST(MeshBuild, NamesFacesWhoseVerticesDoNotExist) {
  const Error error = expect_error("mesh.index_out_of_range", [] {
    TriangleMesh::build(square, {{0, 1, 2}, {0, 2, 4}, {-1, 2, 3}});
  });
  EXPECT_EQ(places(error), (Places{"face 1", "face 2"}));
  EXPECT_NE(error.details()[0].message.find("0, 2, 4"), std::string::npos);
}

TEST(MeshBuild, NamesFacesThatRepeatAVertexOrHaveNoArea) {
  const std::vector<Eigen::Vector3d> line = {{0.1, 0.1, 0.1}, {0.2, 0.2, 0.2}, {0.3, 0.3, 0.3}, {0, 1, 0}};
  const Error error = expect_error("mesh.degenerate_face", [&] {
    TriangleMesh::build(line, {{0, 1, 3}, {0, 1, 2}, {1, 1, 3}});
  });
  EXPECT_EQ(places(error), (Places{"face 1", "face 2"}));
}

TEST(MeshBuild, RefusesFacesWhoseHeightIsOnlyRounding) {
  // Corners on a line through the origin, each rounded: the cross product is not exactly zero.
  const Eigen::Vector3d direction(0.1, 0.3, 0.7);
  int nonzero = 0;
  for (const double factor : {3.0, 7.0, 11.0, 13.0}) {
    const std::vector<Eigen::Vector3d> line = {direction, factor * direction, 1.7 * factor * direction};
    nonzero += (line[1] - line[0]).cross(line[2] - line[0]).norm() > 0;
    EXPECT_EQ(places(expect_error("mesh.degenerate_face",
                                  [&] {
                                    TriangleMesh::build(line, {{0, 1, 2}});
                                  })),
              Places{"face 0"});
  }
  EXPECT_GT(nonzero, 0);
}

TEST(MeshBuild, RefusesAreasThatUnderflowAndAcceptsTinyMeshes) {
  const auto triangle = [](double scale) {
    return std::vector<Eigen::Vector3d>{{0, 0, 0}, {scale, 0, 0}, {0, scale, 0}};
  };
  expect_error("mesh.degenerate_face", [&] { TriangleMesh::build(triangle(1e-160), {{0, 1, 2}}); });
  const TriangleMesh tiny = TriangleMesh::build(triangle(1e-60), {{0, 1, 2}});
  EXPECT_NEAR(tiny.corner_angle(0), std::numbers::pi / 2, 1e-15);
  const TriangleMesh large = TriangleMesh::build(triangle(1e69), {{0, 1, 2}});
  EXPECT_DOUBLE_EQ(large.edge_length(1), std::sqrt(2) * 1e69);
}

TEST(MeshBuild, NamesEdgesOfMoreThanTwoFaces) {
  std::vector<Eigen::Vector3d> positions = square;
  positions.push_back({0.5, 0.5, 1});
  const Error error = expect_error("mesh.non_manifold_edge", [&] {
    TriangleMesh::build(positions, {{0, 1, 2}, {0, 2, 3}, {2, 0, 4}});
  });
  EXPECT_EQ(places(error), Places{"edge 0 2"});
  EXPECT_EQ(error.details()[0].message, "is shared by 3 faces");
}

TEST(MeshBuild, NamesVerticesWhereTwoFansMeet) {
  const std::vector<Eigen::Vector3d> bow = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}};
  EXPECT_EQ(places(expect_error("mesh.non_manifold_vertex",
                                [&] {
                                  TriangleMesh::build(bow, {{0, 1, 2}, {0, 3, 4}});
                                })),
            Places{"vertex 0"});
  // Two closed surfaces that touch in vertex 0.
  const TriangleMesh one = tetrahedron();
  std::vector<Eigen::Vector3d> positions = one.positions();
  std::vector<Triangle> faces = one.faces();
  for (int v = 1; v < 4; ++v) positions.push_back(-one.positions()[v]);
  for (const auto& [a, b, c] : one.faces()) {
    faces.push_back({a == 0 ? 0 : a + 3, c == 0 ? 0 : c + 3, b == 0 ? 0 : b + 3});
  }
  EXPECT_EQ(places(expect_error("mesh.non_manifold_vertex", [&] { TriangleMesh::build(positions, faces); })),
            Places{"vertex 0"});
}

TEST(MeshBuild, RefusesAMoebiusStrip) {
  constexpr int n = 12;
  testing::Soup strip;
  for (int i = 0; i < n; ++i) {
    const double u = 2 * std::numbers::pi * i / n;
    for (const double side : {-0.3, 0.3}) {
      const double r = 1 + side * std::cos(u / 2);
      strip.add({r * std::cos(u), r * std::sin(u), side * std::sin(u / 2)});
    }
  }
  for (int i = 0; i + 1 < n; ++i) strip.add_quad(2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1);
  strip.add_quad(2 * n - 2, 1, 0, 2 * n - 1);
  const Error error = expect_error("mesh.not_orientable", [&] { std::move(strip).build(); });
  ASSERT_FALSE(error.details().empty());
  EXPECT_EQ(error.details()[0].where.substr(0, 5), "edge ");
}

TEST(MeshBuild, DetailsTheFirstTwentyFaultsAndCountsAll) {
  const std::vector<Triangle> faces(50, Triangle{0, 1, 9});
  const Error error = expect_error("mesh.index_out_of_range", [&] { TriangleMesh::build(square, faces); });
  EXPECT_EQ(error.details().size(), 20u);
  EXPECT_EQ(std::string(error.what()).substr(0, 8), "50 faces");
}

TEST(MeshBuild, FindsTheFanOfAVertexWithManyFaces) {
  const TriangleMesh mesh = testing::cone(5000, 6.0);
  std::int32_t faces = 0;
  for (std::int32_t h = mesh.outgoing(0);; h = mesh.rotate(h)) {
    ++faces;
    if (mesh.rotate(h) == mesh.outgoing(0)) break;
  }
  EXPECT_EQ(faces, 5000);
}

/// A bent and stretched copy of the positions.
std::vector<Eigen::Vector3d> bent(std::vector<Eigen::Vector3d> positions) {
  for (Eigen::Vector3d& p : positions)
    p = {1.3 * p.x(), p.y() + 0.2 * p.x() * p.x(), p.z() + 0.1 * std::sin(3 * p.y())};
  return positions;
}

TEST(MeshWithPositions, EqualsTheMeshThatIsBuiltFromThem) {
  std::vector<TriangleMesh> meshes = {tetrahedron(),       testing::torus(),
                                      testing::saddle(5),  testing::two_components(),
                                      testing::l_shape(2), testing::slit_annulus()};
  // With a face that had to be turned and a vertex that no face uses.
  meshes.push_back(
      TriangleMesh::build({{0, 0, 0}, {1, 0, 0}, {9, 9, 9}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 3}, {0, 4, 3}}));
  for (const TriangleMesh& mesh : meshes) {
    const std::vector<Eigen::Vector3d> positions = bent(mesh.positions());
    const TriangleMesh moved = mesh.with_positions(positions);
    const TriangleMesh built = TriangleMesh::build(positions, mesh.faces());
    ASSERT_EQ(moved.positions(), built.positions());
    ASSERT_EQ(moved.faces(), built.faces());
    for (std::int32_t h = 0; h < built.halfedge_count(); ++h) {
      ASSERT_EQ(moved.twin(h), built.twin(h));
      ASSERT_EQ(moved.edge_length(h), built.edge_length(h));
      ASSERT_EQ(moved.corner_angle(h), built.corner_angle(h));
    }
    for (std::int32_t v = 0; v < built.vertex_count(); ++v) {
      ASSERT_EQ(moved.outgoing(v), built.outgoing(v));
      ASSERT_EQ(moved.is_boundary(v), built.is_boundary(v));
      ASSERT_EQ(moved.vertex_angle(v), built.vertex_angle(v));
    }
    for (std::int32_t f = 0; f < built.face_count(); ++f) ASSERT_EQ(moved.component(f), built.component(f));
    EXPECT_EQ(moved.component_count(), built.component_count());
    EXPECT_EQ(moved.mean_edge_length(), built.mean_edge_length());
    EXPECT_EQ(moved.diagonal(), built.diagonal());
    EXPECT_TRUE(moved.warnings().empty());
  }
}

TEST(MeshWithPositions, RefusesWhatBuildRefuses) {
  const TriangleMesh mesh = testing::torus(6, 4);
  const auto both = [&](const std::string& code, const std::vector<Eigen::Vector3d>& positions) {
    const Error moved = expect_error(code, [&] { mesh.with_positions(positions); });
    const Error built = expect_error(code, [&] { TriangleMesh::build(positions, mesh.faces()); });
    EXPECT_EQ(places(moved), places(built));
    EXPECT_STREQ(moved.what(), built.what());
    return moved;
  };
  std::vector<Eigen::Vector3d> positions = mesh.positions();
  positions[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(places(both("mesh.non_finite", positions)), Places{"vertex 3"});
  positions[3].y() = 1e71;
  EXPECT_EQ(places(both("mesh.non_finite", positions)), Places{"vertex 3"});
  positions = mesh.positions();
  const Triangle& face = mesh.faces()[7];
  positions[face[0]] = positions[face[1]];
  EXPECT_GE(places(both("mesh.degenerate_face", positions)).size(), 1u);
  positions.assign(mesh.vertex_count(), Eigen::Vector3d::Zero());
  EXPECT_EQ(places(both("mesh.degenerate_face", positions)).size(), 20u);
}

TEST(MeshWithPositions, RefusesAnotherNumberOfPositions) {
  const TriangleMesh mesh = tetrahedron();
  for (const int change : {-1, 1}) {
    std::vector<Eigen::Vector3d> positions = mesh.positions();
    positions.resize(positions.size() + change, Eigen::Vector3d::Ones());
    EXPECT_EQ(places(expect_error("mesh.position_count", [&] { mesh.with_positions(positions); })), Places{"vertices"});
  }
  EXPECT_EQ(TriangleMesh().with_positions({}).face_count(), 0);
}

}  // namespace
}  // namespace supple::surface
