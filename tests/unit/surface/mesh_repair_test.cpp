#include "supple/surface/mesh_repair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "supple/base/random.h"
#include "supple/surface/mesh_report.h"
#include "support/expect_error.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using testing::expect_error;
using Indices = std::vector<std::int32_t>;

RepairOptions asking(std::initializer_list<Repair> repairs, double weld_tolerance = 1e-6) {
  RepairOptions options;
  for (const Repair repair : repairs) options.ask(repair);
  options.weld_tolerance = weld_tolerance;
  return options;
}

const RepairOptions everything =
    asking({Repair::weld, Repair::drop_degenerate, Repair::drop_duplicates, Repair::split_non_manifold});

std::vector<Indices> vertex_map(const RepairOutcome& outcome) {
  std::vector<Indices> map;
  for (std::size_t v = 0; v + 1 < outcome.vertex_starts.size(); ++v) {
    const auto vertices = outcome.vertices_of(v);
    map.emplace_back(vertices.begin(), vertices.end());
  }
  return map;
}

TriangleMesh built(const TriangleSoup& soup) { return TriangleMesh::build(soup.positions, soup.faces); }

/// Every triangle of the mesh with three vertices of its own, as STL files have them.
TriangleSoup in_single_triangles(const TriangleMesh& mesh) {
  TriangleSoup soup;
  for (const Triangle& face : mesh.faces()) {
    const auto first = static_cast<std::int32_t>(soup.positions.size());
    for (const std::int32_t v : face) soup.positions.push_back(mesh.positions()[v]);
    soup.faces.push_back({first, first + 1, first + 2});
  }
  return soup;
}

/// What every outcome promises: each corner of a face that is left is one of the places of the vertex it was given.
void expect_maps_fit(const TriangleSoup& given, const TriangleSoup& repaired, const RepairOutcome& outcome) {
  ASSERT_EQ(outcome.vertex_starts.size(), given.positions.size() + 1);
  ASSERT_EQ(outcome.new_faces.size(), given.faces.size());
  std::vector<int> met(repaired.faces.size(), 0);
  for (std::size_t f = 0; f < given.faces.size(); ++f) {
    const std::int32_t to = outcome.new_faces[f];
    if (to < 0) continue;
    ++met[to];
    for (int i = 0; i < 3; ++i) {
      const auto places = outcome.vertices_of(given.faces[f][i]);
      ASSERT_EQ(std::count(places.begin(), places.end(), repaired.faces[to][i]), 1) << f;
      ASSERT_LE((repaired.positions[repaired.faces[to][i]] - given.positions[given.faces[f][i]]).norm(),
                outcome.weld_distance);
    }
  }
  EXPECT_TRUE(std::all_of(met.begin(), met.end(), [](int count) { return count == 1; }));
}

TEST(MeshRepair, ASoundMeshStaysAsItIsWhateverIsAsked) {
  for (const TriangleMesh& mesh : {testing::torus(12, 8), testing::open_hemisphere(), testing::two_components()}) {
    TriangleSoup soup{mesh.positions(), mesh.faces(), {}};
    const RepairOutcome outcome = repair_mesh(soup, everything);
    EXPECT_EQ(soup.positions, mesh.positions());
    EXPECT_EQ(soup.faces, mesh.faces());
    EXPECT_TRUE(soup.warnings.empty());
    Indices same(mesh.face_count());
    std::iota(same.begin(), same.end(), 0);
    EXPECT_EQ(outcome.new_faces, same);
    same.resize(mesh.vertex_count());
    std::iota(same.begin(), same.end(), 0);
    EXPECT_EQ(outcome.new_vertices, same);
  }
}

TEST(MeshRepair, WeldingJoinsSingleTrianglesToTheMeshTheyCameFrom) {
  const TriangleMesh mesh = testing::icosphere(3);
  const TriangleSoup given = in_single_triangles(mesh);
  TriangleSoup soup = given;
  RandomStream stream("welding", 1);
  for (auto& p : soup.positions) {
    for (int i = 0; i < 3; ++i) p[i] += stream.uniform(-1e-7, 1e-7);
  }
  const TriangleSoup moved = soup;
  const RepairOutcome outcome = repair_mesh(soup, asking({Repair::weld}));
  expect_maps_fit(moved, soup, outcome);
  EXPECT_EQ(outcome.welded_vertices, 3 * mesh.face_count() - mesh.vertex_count());
  EXPECT_NEAR(outcome.weld_distance, 1e-6 * 2 * std::sqrt(3), 1e-8);
  const MeshReport r = report(built(soup));
  EXPECT_EQ(r.vertices, mesh.vertex_count());
  EXPECT_EQ(r.boundary_loops, 0);
  EXPECT_EQ(r.genus, 0);
  EXPECT_EQ(soup.warnings, std::vector<std::string>{std::to_string(outcome.welded_vertices) +
                                                    " vertices were welded to an earlier one."});
}

TEST(MeshRepair, WeldingReachesToTheToleranceAndNoFurther) {
  // The faces' diagonal is 5, so 0.01 welds up to 0.05; what no face uses is welded too, but does not count in the box.
  const TriangleSoup given{
      {{0, 0, 0}, {3, 0, 0}, {0, 4, 0}, {0.049, 0, 0}, {0.051, 0, 0}, {100, 0, 0}}, {{0, 1, 2}}, {}};
  TriangleSoup soup = given;
  const RepairOutcome outcome = repair_mesh(soup, asking({Repair::weld}, 0.01));
  EXPECT_DOUBLE_EQ(outcome.weld_distance, 0.05);
  EXPECT_EQ(vertex_map(outcome), (std::vector<Indices>{{0}, {1}, {2}, {0}, {3}, {4}}));
  EXPECT_EQ(soup.positions[0], given.positions[0]);
}

TEST(MeshRepair, AToleranceOfZeroWeldsEqualCoordinatesOnly) {
  TriangleSoup soup{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, 0}, {1e-300, 0, 0}}, {{0, 1, 2}}, {}};
  EXPECT_EQ(vertex_map(repair_mesh(soup, asking({Repair::weld}, 0))), (std::vector<Indices>{{0}, {1}, {2}, {0}, {3}}));
}

TEST(MeshRepair, WeldingTakesTheSameVerticesAsTryingAllPairs) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomStream stream("pairs", seed);
    TriangleSoup soup{{{0, 0, 0}, {1, 0, 0}, {1, 1, 1}}, {{0, 1, 2}}, {}};
    for (int i = 0; i < 500; ++i) {
      // Some in a cloud, some on a line, many of equal coordinates.
      const double x = std::floor(stream.uniform(0, 40)) / 40;
      soup.positions.emplace_back(x, seed % 2 ? stream.uniform(0, 1) : 0.0, seed % 3 ? stream.uniform(0, 0.1) : 0.0);
    }
    const double distance = 0.01 * std::sqrt(3);
    std::vector<Indices> expected;
    Indices kept;
    for (const auto& p : soup.positions) {
      std::size_t near = 0;
      while (near < kept.size() && (soup.positions[kept[near]] - p).norm() > distance) ++near;
      if (near == kept.size()) kept.push_back(static_cast<std::int32_t>(&p - soup.positions.data()));
      expected.push_back({static_cast<std::int32_t>(near)});
    }
    EXPECT_EQ(vertex_map(repair_mesh(soup, asking({Repair::weld}, 0.01))), expected) << seed;
  }
}

TEST(MeshRepair, DegenerateFacesAreDroppedAndVerticesThatOnlyTheyHadAreRemoved) {
  const TriangleSoup given{{{9, 9, 9}, {0, 0, 0}, {0.5, 0.5, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                           {{1, 3, 3}, {1, 3, 4}, {1, 2, 4}, {1, 4, 5}},
                           {"as read"}};
  expect_error("mesh.degenerate_face", [&] { built(given); });
  TriangleSoup soup = given;
  const RepairOutcome outcome = repair_mesh(soup, asking({Repair::drop_degenerate}));
  expect_maps_fit(given, soup, outcome);
  EXPECT_EQ(outcome.dropped_degenerate_faces, 2);
  EXPECT_EQ(outcome.removed_vertices, 1);
  EXPECT_EQ(outcome.new_faces, (Indices{-1, 0, -1, 1}));
  EXPECT_EQ(vertex_map(outcome), (std::vector<Indices>{{0}, {1}, {}, {2}, {3}, {4}}));
  EXPECT_EQ(report(built(soup)).area, 1);
  EXPECT_EQ(soup.warnings, (std::vector<std::string>{"as read", "2 degenerate faces were dropped.",
                                                     "1 vertex was removed, since all of their faces were dropped."}));
}

TEST(MeshRepair, FacesGivenAgainAreDroppedHoweverTheyAreTurned) {
  const TriangleSoup given{
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {2, 0, 1}, {0, 2, 3}, {0, 2, 1}, {3, 2, 0}}, {}};
  expect_error("mesh.non_manifold_edge", [&] { built(given); });
  TriangleSoup soup = given;
  const RepairOutcome outcome = repair_mesh(soup, asking({Repair::drop_duplicates}));
  expect_maps_fit(given, soup, outcome);
  EXPECT_EQ(outcome.dropped_duplicate_faces, 3);
  EXPECT_EQ(outcome.new_faces, (Indices{0, -1, 1, -1, -1}));
  EXPECT_EQ(soup.faces, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
}

TEST(MeshRepair, AnEdgeOfThreeFacesIsCutIntoThree) {
  const TriangleSoup given{
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}, {}};
  TriangleSoup soup = given;
  const RepairOutcome outcome = repair_mesh(soup, asking({Repair::split_non_manifold}));
  expect_maps_fit(given, soup, outcome);
  EXPECT_EQ(outcome.split_edges, 1);
  EXPECT_EQ(outcome.split_vertices, 2);
  EXPECT_EQ(vertex_map(outcome), (std::vector<Indices>{{0, 6, 7}, {1, 5, 8}, {2}, {3}, {4}}));
  EXPECT_EQ(report(built(soup)).components, 3);
}

TEST(MeshRepair, FansThatMeetInAVertexGetOneEach) {
  // Three tetrahedra with a common tip, whose faces come in turns and not all to the same side.
  TriangleSoup given{{{0, 0, 0}}, {}, {}};
  for (int k = 0; k < 3; ++k) {
    const auto a = static_cast<std::int32_t>(given.positions.size());
    for (int i = 0; i < 3; ++i)
      given.positions.push_back(Eigen::Vector3d::Unit(i) * (i == k ? 2 : 1) + Eigen::Vector3d(k, k, k));
    for (const Triangle& face :
         {Triangle{0, a, a + 1}, Triangle{0, a + 1, a + 2}, Triangle{0, a, a + 2}, Triangle{a, a + 1, a + 2}}) {
      given.faces.insert(given.faces.begin() + k * static_cast<int>(given.faces.size()) / 3, face);
    }
  }
  expect_error("mesh.non_manifold_vertex", [&] { built(given); });
  TriangleSoup soup = given;
  const RepairOutcome outcome = repair_mesh(soup, asking({Repair::split_non_manifold}));
  expect_maps_fit(given, soup, outcome);
  EXPECT_EQ(outcome.split_edges, 0);
  EXPECT_EQ(outcome.split_vertices, 1);
  EXPECT_EQ(vertex_map(outcome)[0], (Indices{0, 10, 11}));
  const MeshReport r = report(built(soup));
  EXPECT_EQ(r.components, 3);
  EXPECT_EQ(r.boundary_loops, 0);
}

TEST(MeshRepair, TwoSpheresThatShareAnEdgeAreTakenApart) {
  // Two tetrahedra on one edge: each is joined around both of its ends, so that both stay closed.
  const TriangleSoup given{{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}},
                           {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}, {0, 1, 4}, {0, 5, 1}, {0, 4, 5}, {1, 5, 4}},
                           {}};
  expect_error("mesh.non_manifold_edge", [&] { built(given); });
  TriangleSoup soup = given;
  const RepairOutcome outcome = repair_mesh(soup, asking({Repair::split_non_manifold}));
  expect_maps_fit(given, soup, outcome);
  EXPECT_EQ(vertex_map(outcome), (std::vector<Indices>{{0, 6}, {1, 7}, {2}, {3}, {4}, {5}}));
  const MeshReport r = report(built(soup));
  EXPECT_EQ(r.components, 2);
  EXPECT_EQ(r.boundary_loops, 0);
}

TEST(MeshRepair, SplittingMakesAManifoldOfAnyTriangles) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    RandomStream stream("any triangles", seed);
    TriangleSoup given;
    const int vertices = 4 + static_cast<int>(seed % 9);
    for (int v = 0; v < vertices; ++v) {
      given.positions.emplace_back(stream.uniform(), stream.uniform(), stream.uniform());
    }
    for (int f = 0; f < 40; ++f) {
      Triangle face;
      for (auto& v : face) v = static_cast<std::int32_t>(stream.uniform(0, vertices));
      given.faces.push_back(face);
    }
    TriangleSoup soup = given;
    const RepairOutcome outcome = repair_mesh(soup, everything);
    expect_maps_fit(given, soup, outcome);
    EXPECT_GT(outcome.dropped_degenerate_faces, 0);
    try {
      built(soup);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), "mesh.not_orientable") << "the one fault that no repair is for";
    }
  }
}

TEST(MeshRepair, RepairsAreMadeInTheirOrderSoThatEachSeesTheOnesBefore) {
  // Welding makes a face degenerate, its drop leaves two equal faces, and one of these goes.
  const TriangleSoup given{
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 0}}, {{0, 1, 2}, {5, 4, 3}, {1, 2, 3}}, {}};
  TriangleSoup soup = given;
  const RepairOutcome outcome = repair_mesh(soup, everything);
  expect_maps_fit(given, soup, outcome);
  EXPECT_EQ(outcome.new_faces, (Indices{0, -1, -1}));
  EXPECT_EQ(outcome.welded_vertices, 3);
  EXPECT_EQ(outcome.removed_vertices, 0);
}

TEST(MeshRepair, VerticesThatAreWeldedAndSplitAtOnePlaceKeepTheirOwnFaces) {
  // Many triangles that meet in one point, each with a vertex of its own there: the map must not pair all with all.
  TriangleSoup given;
  const std::int32_t n = 20'000;
  for (std::int32_t i = 0; i < n; ++i) {
    given.positions.insert(given.positions.end(), {{0, 0, 0}, {1, double(i), 0}, {1, double(i), 1}});
    given.faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  TriangleSoup soup = given;
  const RepairOutcome outcome = repair_mesh(soup, asking({Repair::weld, Repair::split_non_manifold}, 0));
  expect_maps_fit(given, soup, outcome);
  EXPECT_EQ(outcome.welded_vertices, n - 1);
  EXPECT_EQ(outcome.split_vertices, 1);
  EXPECT_EQ(outcome.new_vertices.size(), given.positions.size());
}

TEST(MeshRepair, WhatIsNotAskedForIsNotDone) {
  const TriangleSoup given{
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}}, {{0, 1, 2}, {3, 1, 2}, {1, 0, 2}, {1, 1, 0}}, {}};
  TriangleSoup soup = given;
  const RepairOutcome outcome = repair_mesh(soup, RepairOptions{});
  EXPECT_EQ(soup.positions, given.positions);
  EXPECT_EQ(soup.faces, given.faces);
  EXPECT_EQ(outcome.weld_distance, 0);
}

TEST(MeshRepair, FaultsThatNoRepairIsForAreThrownBeforeAnyRepair) {
  const std::vector<Eigen::Vector3d> square = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const auto repaired = [&](std::vector<Eigen::Vector3d> positions, std::vector<Triangle> faces) {
    TriangleSoup soup{std::move(positions), std::move(faces), {}};
    repair_mesh(soup, everything);
  };
  expect_error("mesh.index_out_of_range", [&] { repaired(square, {{0, 1, 4}}); });
  expect_error("mesh.non_finite", [&] { repaired({{0, 0, 0}, {1, 0, 0}, {0, NAN, 0}}, {{0, 1, 2}}); });
  expect_error("mesh.empty", [&] { repaired(square, {}); });
  const Error error = expect_error("mesh.empty", [&] { repaired(square, {{0, 1, 1}, {2, 2, 0}}); });
  EXPECT_STREQ(error.what(), "The repairs leave no face: all are degenerate.");
  TriangleSoup soup{square, {{0, 1, 2}, {0, 2, 2}}, {}};
  expect_error("mesh.degenerate_face", [&] { repair_mesh(soup, asking({Repair::split_non_manifold})); });
}

TEST(MeshRepair, SplitVerticesCountForTheLimit) {
  const TriangleSoup given{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}, {}};
  TriangleSoup soup = given;
  const RepairOptions split = asking({Repair::split_non_manifold});
  const Error error = expect_error("mesh.too_large", [&] { repair_mesh(soup, split, {.vertices = 5, .faces = 2}); });
  ASSERT_EQ(error.details().size(), 1u);
  EXPECT_EQ(error.details()[0].message, "6 vertices after the repairs, the limit is 5");
  soup = given;
  repair_mesh(soup, split, {.vertices = 6, .faces = 2});
  EXPECT_EQ(soup.positions.size(), 6u);
}

TEST(MeshRepair, TheFaultsOfAMeshNameTheRepairThatHelps) {
  const std::vector<Eigen::Vector3d> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}};
  const auto sentence = [&](const std::string& code, std::vector<Triangle> faces) {
    return std::string(expect_error(code, [&] { build_with_advice({points, faces, {}}); }).what());
  };
  EXPECT_EQ(sentence("mesh.degenerate_face", {{0, 1, 2}, {0, 1, 1}}),
            "1 face is degenerate; uploaded with repair=drop_degenerate the mesh is sound.");
  EXPECT_EQ(sentence("mesh.degenerate_face", {{0, 1, 1}}), "1 face is degenerate; no repair removes this fault.");
  EXPECT_EQ(sentence("mesh.non_manifold_edge", {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}),
            "1 edge is shared by more than two faces; uploaded with repair=split_non_manifold the mesh is sound.");
  EXPECT_EQ(sentence("mesh.non_manifold_edge", {{0, 1, 2}, {0, 2, 1}, {0, 1, 4}}),
            "1 edge is shared by more than two faces; uploaded with repair=drop_duplicates the mesh is sound.");
  EXPECT_EQ(sentence("mesh.non_manifold_vertex", {{0, 1, 2}, {0, 3, 4}}),
            "1 vertex joins fans of faces that share no edge; uploaded with repair=split_non_manifold the mesh is "
            "sound.");
}

}  // namespace
}  // namespace supple::surface
