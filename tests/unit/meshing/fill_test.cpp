#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>
#include <string>
#include <vector>

#include "supple/base/error.h"
#include "supple/base/random.h"
#include "supple/meshing/tetrahedral_mesh.h"
#include "support/expect_error.h"
#include "support/shapes.h"

namespace supple::meshing {
namespace {

using surface::TriangleMesh;
using testing::expect_cancelled;
using testing::expect_error;

TetrahedralMesh fill_mesh(const TriangleMesh& mesh, const FillOptions& options = {}) {
  return fill(mesh.positions(), mesh.faces(), options);
}

/// The volume that a surface encloses, by the divergence theorem.
double enclosed_volume(const std::vector<Eigen::Vector3d>& positions, const std::vector<SurfaceTriangle>& faces) {
  double sum = 0;
  for (const auto& [a, b, c] : faces)
    sum += positions[static_cast<std::size_t>(a)].dot(
        positions[static_cast<std::size_t>(b)].cross(positions[static_cast<std::size_t>(c)]));
  return sum / 6;
}

/// Expects that the surface is unchanged, is the boundary of the tetrahedra, and that these are positive.
void expect_keeps_surface(const TetrahedralMesh& mesh, const std::vector<Eigen::Vector3d>& positions,
                          const std::vector<SurfaceTriangle>& faces) {
  ASSERT_EQ(static_cast<std::size_t>(mesh.surface_vertices), positions.size());
  ASSERT_GE(mesh.nodes.size(), positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) EXPECT_EQ(mesh.nodes[i], positions[i]) << i;
  std::map<SurfaceTriangle, int> tetrahedra_at;
  std::vector<int> uses(mesh.nodes.size(), 0);
  for (const auto& [a, b, c, d] : mesh.tetrahedra) {
    EXPECT_GT(tetrahedron_volume(mesh.nodes[static_cast<std::size_t>(a)], mesh.nodes[static_cast<std::size_t>(b)],
                                 mesh.nodes[static_cast<std::size_t>(c)], mesh.nodes[static_cast<std::size_t>(d)]),
              0);
    for (const std::int32_t node : {a, b, c, d}) ++uses[static_cast<std::size_t>(node)];
    for (SurfaceTriangle face : {SurfaceTriangle{a, b, c}, {a, b, d}, {a, c, d}, {b, c, d}}) {
      std::ranges::sort(face);
      ++tetrahedra_at[face];
    }
  }
  for (SurfaceTriangle face : faces) {
    std::ranges::sort(face);
    EXPECT_EQ(tetrahedra_at[face], 1);
  }
  const auto outer = std::ranges::count_if(tetrahedra_at, [](const auto& entry) { return entry.second == 1; });
  EXPECT_EQ(static_cast<std::size_t>(outer), faces.size());
  for (std::size_t i = positions.size(); i < uses.size(); ++i) EXPECT_GT(uses[i], 0) << "node " << i;
}

void expect_fills(const TriangleMesh& surface, const FillOptions& options = {}) {
  const TetrahedralMesh mesh = fill_mesh(surface, options);
  expect_keeps_surface(mesh, surface.positions(), surface.faces());
  const double volume = enclosed_volume(surface.positions(), surface.faces());
  EXPECT_NEAR(mesh.volume(), volume, 1e-12 * volume);
}

/// An L-shaped prism, 2 long, 2 wide and 1 high.
TriangleMesh thick_l() {
  const std::vector<Eigen::Vector2d> corners = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  std::vector<Eigen::Vector3d> positions;
  for (const double z : {0.0, 1.0})
    for (const Eigen::Vector2d& corner : corners) positions.emplace_back(corner[0], corner[1], z);
  std::vector<SurfaceTriangle> faces = {{0, 2, 1}, {0, 3, 2}, {0, 4, 3}, {0, 5, 4}};
  for (SurfaceTriangle face : std::vector<SurfaceTriangle>(faces)) {
    std::swap(face[0], face[1]);
    for (std::int32_t& corner : face) corner += 6;
    faces.push_back(face);
  }
  for (std::int32_t k = 0; k < 6; ++k) {
    const std::int32_t next = (k + 1) % 6;
    faces.push_back({k, next, next + 6});
    faces.push_back({k, next + 6, k + 6});
  }
  return TriangleMesh::build(positions, faces);
}

/// Appends a scaled mesh to lists of vertices and triangles. If `turned`, its triangles are reversed.
void append(const TriangleMesh& mesh, double scale, bool turned, std::vector<Eigen::Vector3d>& positions,
            std::vector<SurfaceTriangle>& faces) {
  const auto first = static_cast<std::int32_t>(positions.size());
  for (const Eigen::Vector3d& position : mesh.positions()) positions.emplace_back(scale * position);
  for (SurfaceTriangle face : mesh.faces()) {
    if (turned) std::swap(face[0], face[1]);
    for (std::int32_t& corner : face) corner += first;
    faces.push_back(face);
  }
}

TEST(Fill, KeepsTheSurfaceAndFillsItsVolume) {
  expect_fills(testing::icosphere(2));
  expect_fills(testing::cube(4));
  expect_fills(testing::torus(24, 12));
  expect_fills(testing::genus3(2));
  expect_fills(thick_l(), {.element_size = 0.4});
}

TEST(Fill, TwiceTheLengthGivesAnEighthOfTheTetrahedra) {
  const TriangleMesh cube = testing::cube(12);
  const auto coarse = fill_mesh(testing::icosphere(3), {.element_size = 0.14}).tetrahedra.size();
  const auto fine = fill_mesh(testing::icosphere(3), {.element_size = 0.07}).tetrahedra.size();
  EXPECT_NEAR(static_cast<double>(fine) / static_cast<double>(coarse), 8, 2);
  // If the surface is finer than the length that is wanted inside, tetrahedra grow, and faster with a greater grading.
  const auto slow = fill_mesh(cube, {.element_size = 1, .grading = 0.2}).tetrahedra.size();
  const auto fast = fill_mesh(cube, {.element_size = 1, .grading = 1}).tetrahedra.size();
  EXPECT_LT(fast, slow);
  EXPECT_LT(fast, 4000U);
}

TEST(Fill, TheMeanEdgeIsTheLengthWhereNoneIsGiven) {
  const TriangleMesh sphere = testing::icosphere(3);
  const TetrahedralMesh mean = fill_mesh(sphere);
  const TetrahedralMesh same = fill_mesh(sphere, {.element_size = sphere.mean_edge_length()});
  EXPECT_NEAR(static_cast<double>(mean.tetrahedra.size()), static_cast<double>(same.tetrahedra.size()),
              0.02 * static_cast<double>(same.tetrahedra.size()));
}

TEST(Fill, GivesTheSameBitsEveryTime) {
  const TriangleMesh sphere = testing::icosphere(3);
  const TetrahedralMesh first = fill_mesh(sphere, {.element_size = 0.1});
  // These allocations change the addresses that gmsh gets, which must not matter.
  std::vector<std::vector<double>> others;
  for (std::size_t k = 0; k < 2000; ++k) {
    others.emplace_back(k);
    if (k % 3 == 0) others.erase(others.begin());
  }
  fill_mesh(testing::torus(24, 12));
  const TetrahedralMesh second = fill_mesh(sphere, {.element_size = 0.1});
  EXPECT_EQ(first.nodes, second.nodes);
  EXPECT_EQ(first.tetrahedra, second.tetrahedra);
}

TEST(Fill, ASurfaceThatIsTurnedInsideOutGivesTheSameSolid) {
  std::vector<Eigen::Vector3d> positions;
  std::vector<SurfaceTriangle> faces;
  append(testing::icosphere(2), 1, true, positions, faces);
  const TetrahedralMesh mesh = fill(positions, faces);
  expect_keeps_surface(mesh, positions, faces);
  EXPECT_NEAR(mesh.volume(), -enclosed_volume(positions, faces), 1e-12);
}

/// A surface that is moved, turned, scaled and numbered in another way.
struct Copy {
  std::vector<Eigen::Vector3d> positions;
  std::vector<SurfaceTriangle> faces;
  std::vector<std::int32_t> number;  ///< for each given vertex, its number in the copy
  Eigen::Quaterniond turn;
  double scale = 1;
  Eigen::Vector3d shift;

  Eigen::Vector3d at(const Eigen::Vector3d& point) const { return scale * (turn * point) + shift; }
};

template <class List>
void shuffle(List& list, RandomStream& random) {
  for (std::size_t i = list.size(); i > 1; --i)
    std::swap(list[i - 1], list[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
}

Copy copy_of(const std::vector<Eigen::Vector3d>& positions, const std::vector<SurfaceTriangle>& faces, bool is_moved,
             RandomStream& random) {
  Copy copy;
  const auto number = [&] { return random.normal(); };
  copy.turn = Eigen::Quaterniond(number(), number(), number(), number()).normalized();
  copy.scale = std::exp(number());
  copy.shift = Eigen::Vector3d(number(), number(), number());
  if (!is_moved) copy = {{}, {}, {}, Eigen::Quaterniond::Identity(), 1, Eigen::Vector3d::Zero()};
  for (std::size_t i = 0; i < positions.size(); ++i) copy.number.push_back(static_cast<std::int32_t>(i));
  shuffle(copy.number, random);
  copy.positions.resize(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    copy.positions[static_cast<std::size_t>(copy.number[i])] = copy.at(positions[i]);
  for (SurfaceTriangle face : faces) {
    for (std::int32_t& corner : face) corner = copy.number[static_cast<std::size_t>(corner)];
    std::rotate(face.begin(), face.begin() + random.below(3), face.end());
    copy.faces.push_back(face);
  }
  shuffle(copy.faces, random);
  return copy;
}

/// Expects that the filling of the copy is that of the surface, moved like the copy.
void expect_same_filling(const std::vector<Eigen::Vector3d>& positions, const std::vector<SurfaceTriangle>& faces,
                         const Copy& copy) {
  const TetrahedralMesh mesh = fill(positions, faces);
  const TetrahedralMesh other = fill(copy.positions, copy.faces);
  ASSERT_EQ(other.nodes.size(), mesh.nodes.size());
  ASSERT_EQ(other.tetrahedra.size(), mesh.tetrahedra.size());
  double size = 0;
  for (const auto& position : positions) size = std::max(size, (position - positions.front()).norm());
  for (std::size_t i = positions.size(); i < mesh.nodes.size(); ++i)
    EXPECT_LT((other.nodes[i] - copy.at(mesh.nodes[i])).norm(), 1e-8 * copy.scale * size) << "inner node " << i;
  std::size_t differing = 0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
    for (std::size_t k = 0; k < 4; ++k) {
      const std::int32_t node = mesh.tetrahedra[t][k];
      const std::int32_t wanted = node < mesh.surface_vertices ? copy.number[static_cast<std::size_t>(node)] : node;
      differing += other.tetrahedra[t][k] == wanted ? 0 : 1;
    }
  EXPECT_EQ(differing, 0U) << "corners of tetrahedra";
}

std::vector<Eigen::Vector3d> bent(std::vector<Eigen::Vector3d> positions, double size, RandomStream& random) {
  for (auto& position : positions)
    for (double& coordinate : position) coordinate += size * random.normal();
  return positions;
}

TEST(Fill, ASurfaceThatIsMovedTurnedScaledAndRenumberedGetsTheSameTetrahedra) {
  const std::uint64_t seed = 39;
  RandomStream random("filled copies", seed);
  for (const TriangleMesh& mesh : {testing::icosphere(2), testing::cube(3), testing::torus(24, 12), testing::genus3(1)})
    for (int copies = 0; copies < 3; ++copies) {
      const auto positions = bent(mesh.positions(), 0.02 * mesh.mean_edge_length(), random);
      expect_same_filling(positions, mesh.faces(), copy_of(positions, mesh.faces(), true, random));
    }
}

TEST(Fill, ASymmetricSurfaceThatIsRenumberedGetsTheSameTetrahedra) {
  RandomStream random("renumbered surfaces", 40);
  for (const TriangleMesh& mesh : {testing::icosphere(2), testing::cube(3), testing::torus(24, 12)})
    expect_same_filling(mesh.positions(), mesh.faces(), copy_of(mesh.positions(), mesh.faces(), false, random));
}

TEST(Fill, ComponentsAreSolidsOfTheirOwnAndCavitiesInsideOfOthers) {
  for (const bool turned : {false, true}) {
    std::vector<Eigen::Vector3d> positions;
    std::vector<SurfaceTriangle> faces;
    append(testing::icosphere(2), 1, false, positions, faces);
    append(testing::icosphere(1), 0.6, turned, positions, faces);
    append(testing::icosphere(1), 0.3, turned, positions, faces);
    append(testing::icosphere(0), 0.15, turned, positions, faces);
    const TetrahedralMesh mesh = fill(positions, faces);
    expect_keeps_surface(mesh, positions, faces);
    const TriangleMesh outer = testing::icosphere(2);
    const TriangleMesh inner = testing::icosphere(1);
    const double outer_volume = enclosed_volume(outer.positions(), outer.faces());
    const double inner_volume = enclosed_volume(inner.positions(), inner.faces());
    const TriangleMesh innermost = testing::icosphere(0);
    const double innermost_volume = 0.003375 * enclosed_volume(innermost.positions(), innermost.faces());
    EXPECT_NEAR(mesh.volume(), outer_volume - (0.216 - 0.027) * inner_volume - innermost_volume, 1e-12);
  }
  expect_fills(testing::two_components());
}

TEST(Fill, VerticesThatNoTriangleUsesStayNodesOfNoTetrahedron) {
  const TriangleMesh cube = testing::cube(2);
  std::vector<Eigen::Vector3d> positions = cube.positions();
  positions.emplace_back(0.5, 0.5, 0.5);
  positions.emplace_back(7, 7, 7);
  const TetrahedralMesh mesh = fill(positions, cube.faces());
  expect_keeps_surface(mesh, positions, cube.faces());
  EXPECT_NEAR(mesh.volume(), 1, 1e-12);
}

TEST(Fill, AnOpenSurfaceIsRefusedWithItsEdges) {
  const TriangleMesh cube = testing::cube(2);
  std::vector<SurfaceTriangle> faces = cube.faces();
  const SurfaceTriangle missing = faces.back();
  faces.pop_back();
  const Error error = expect_error("solid.open_surface", [&] { fill(cube.positions(), faces); });
  EXPECT_NE(std::string(error.what()).find("3 edges"), std::string::npos) << error.what();
  ASSERT_EQ(error.details().size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [low, high] = std::minmax({missing[k], missing[(k + 1) % 3]});
    const std::string edge = "edge " + std::to_string(low) + " " + std::to_string(high);
    EXPECT_EQ(std::ranges::count(testing::places(error), edge), 1) << edge;
  }
  const TriangleMesh open = testing::open_hemisphere(64, 4);
  EXPECT_EQ(expect_error("solid.open_surface", [&] { fill_mesh(open); }).details().size(), 20U);
  // With this triangle, neighbours have contradicting orientations.
  faces.push_back({missing[1], missing[0], missing[2]});
  expect_error("solid.open_surface", [&] { fill(cube.positions(), faces); });
}

TEST(Fill, ASurfaceThatCrossesItselfOrEnclosesNothingIsRefused) {
  std::vector<Eigen::Vector3d> positions = testing::cube(4).positions();
  const std::vector<SurfaceTriangle> faces = testing::cube(4).faces();
  for (Eigen::Vector3d& position : positions)
    if ((position - Eigen::Vector3d(0.5, 0.5, 1)).norm() < 1e-9) position[2] = -1;
  const Error error = expect_error("solid.not_filled", [&] { fill(positions, faces); });
  EXPECT_EQ(testing::places(error), std::vector<std::string>{"surface"});
  for (Eigen::Vector3d& position : positions) position[2] = 0;
  expect_error("solid.not_filled", [&] { fill(positions, faces); });
  expect_error("solid.not_filled", [&] { fill(positions, std::vector<SurfaceTriangle>{}); });
  // The mesher still works.
  expect_fills(testing::cube(4));
}

TEST(Fill, MoreTetrahedraThanTheLimitAreRefusedBeforeTheyAreMade) {
  const TriangleMesh sphere = testing::icosphere(2);
  const Error foretold = expect_error("solid.too_many_elements", [&] { fill_mesh(sphere, {.element_size = 1e-5}); });
  EXPECT_EQ(testing::places(foretold), std::vector<std::string>{"element_size"});
  EXPECT_NE(foretold.details().front().message.find("limit 2000000"), std::string::npos);
  // The prediction leaves out small triangles on the surface, and slow growth away from them.
  const FillOptions slow{.element_size = 1, .grading = 0.01, .max_tetrahedra = 1000};
  expect_error("solid.too_many_elements", [&] { fill_mesh(testing::cube(16), slow); });
}

TEST(Fill, AStopRequestEndsIt) {
  const TriangleMesh sphere = testing::icosphere(3);
  // The stop request comes when gmsh is about to begin work of minutes.
  struct StopAtTheSecondReport : ProgressSink {
    CancellationToken token;
    int reports = 0;
    void report(double /*fraction*/, std::string_view /*stage*/) override {
      if (++reports == 2) token.request(StopReason::cancelled);
    }
  } stop;
  const Execution execution{.cancellation = stop.token, .progress = &stop};
  const FillOptions long_work{.element_size = 0.015, .max_tetrahedra = 100'000'000};
  const std::clock_t start = std::clock();  // processor time, so that a busy machine makes no difference
  expect_cancelled(StopReason::cancelled, [&] { fill(sphere.positions(), sphere.faces(), long_work, execution); });
  EXPECT_LT(std::clock() - start, 20 * CLOCKS_PER_SEC);
}

TEST(Fill, OptionsOutOfRangeAreTheCallersMistake) {
  const TriangleMesh cube = testing::cube(1);
  EXPECT_THROW(fill_mesh(cube, {.element_size = -1}), std::invalid_argument);
  EXPECT_THROW(fill_mesh(cube, {.element_size = std::nan("")}), std::invalid_argument);
  EXPECT_THROW(fill_mesh(cube, {.grading = 0}), std::invalid_argument);
  EXPECT_THROW(fill(cube.positions(), std::vector<SurfaceTriangle>{{0, 1, 99}}), std::invalid_argument);
}

}  // namespace
}  // namespace supple::meshing
