#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "supple/base/random.h"
#include "supple/surface/mesh_repair.h"
#include "supple/surface/mesh_report.h"
#include "support/expect_error.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using testing::expect_error;

TriangleSoup soup_of(const TriangleMesh& mesh) { return {mesh.positions(), mesh.faces(), {}}; }

std::vector<std::string> made_by(const RepairOutcome& outcome) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < repair_names.size(); ++i)
    if (outcome.made(static_cast<Repair>(i))) names.emplace_back(repair_names[i]);
  return names;
}

/// A closed tube of `columns` x `rows` cells whose last column is the first one again, computed anew: moved by less
/// than `noise` in each coordinate. Open at both ends.
TriangleSoup tube_with_seam(std::int32_t columns, std::int32_t rows, double noise, RandomStream& stream) {
  TriangleSoup soup;
  for (std::int32_t i = 0; i <= columns; ++i) {
    for (std::int32_t j = 0; j <= rows; ++j) {
      const double angle = 2 * std::numbers::pi * (i % columns) / columns;
      Eigen::Vector3d p(std::cos(angle), std::sin(angle), 0.4 * j);
      if (i == columns)
        for (int k = 0; k < 3; ++k) p[k] += stream.uniform(-noise, noise);
      soup.positions.push_back(p);
      const std::int32_t a = i * (rows + 1) + j, b = a + rows + 1;
      if (i == columns || j == rows) continue;
      soup.faces.push_back({a, b, b + 1});
      soup.faces.push_back({a, b + 1, a + 1});
    }
  }
  return soup;
}

TEST(MeshCracks, ASeamThatDiffersInItsLastDigitsIsToldWithItsNumberAndClosed) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomStream stream("seams", seed);
    const double noise = std::pow(10, stream.uniform(-16, -6));
    SCOPED_TRACE("seed " + std::to_string(seed) + ", noise " + std::to_string(std::log10(noise)));
    TriangleSoup soup = tube_with_seam(12, 5, noise, stream);
    const auto warnings = crack_warnings(build_with_advice(soup));
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find(" 6 vertices "), std::string::npos) << warnings[0];
    EXPECT_NE(warnings[0].find("repair=weld "), std::string::npos) << warnings[0];
    const RepairOutcome outcome = repair_automatically(soup);
    EXPECT_EQ(made_by(outcome), std::vector<std::string>{"weld"});
    EXPECT_EQ(outcome.welded_vertices, 6);
    EXPECT_LE(outcome.weld_distance, 2 * noise * std::sqrt(3));
    const MeshReport r = report(build_with_advice(soup));
    EXPECT_EQ(r.boundary_loops, 2);
    EXPECT_EQ(r.vertices, 72);
    EXPECT_TRUE(crack_warnings(build_with_advice(soup)).empty());
  }
}

TEST(MeshCracks, ASeamOfEqualCoordinatesIsToldToo) {
  RandomStream stream("seams", 0);
  const auto warnings = crack_warnings(build_with_advice(tube_with_seam(12, 5, 0, stream)));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0],
            "The surface is open along cracks: 6 vertices have the coordinates of earlier ones; uploaded with "
            "repair=weld they are joined.");
}

TEST(MeshCracks, OneCornerThatIsOffIsJoinedAtWhateverScaleAndPlace) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomStream stream("corners", seed);
    const double scale = std::pow(10, stream.uniform(-6, 6));
    SCOPED_TRACE("seed " + std::to_string(seed));
    const TriangleMesh mesh = testing::icosphere(2);
    TriangleSoup soup = soup_of(mesh);
    for (auto& p : soup.positions) p = scale * (p + Eigen::Vector3d(stream.uniform(0, 1e-9), 3, -2));
    // Some faces, no two of which touch, get one corner of their own.
    std::vector<bool> touched(soup.positions.size(), false);
    std::int64_t off = 0;
    for (Triangle& face : soup.faces) {
      if (std::any_of(face.begin(), face.end(), [&](std::int32_t v) { return touched[v]; })) continue;
      for (const std::int32_t v : face) touched[v] = true;
      const Eigen::Vector3d p = soup.positions[face[1]];
      soup.positions.emplace_back(p + scale * 1e-7 * Eigen::Vector3d(stream.uniform(-1, 1), stream.uniform(-1, 1), 1));
      touched.push_back(true);
      face[1] = static_cast<std::int32_t>(soup.positions.size()) - 1;
      ++off;
    }
    ASSERT_GT(off, 10);
    const RepairOutcome outcome = repair_automatically(soup);
    EXPECT_EQ(made_by(outcome), std::vector<std::string>{"weld"});
    EXPECT_EQ(outcome.welded_vertices, off);
    const MeshReport r = report(build_with_advice(soup));
    EXPECT_EQ(r.boundary_loops, 0);
    EXPECT_EQ(r.vertices, mesh.vertex_count());
  }
}

TEST(MeshCracks, AFaultThatACrackMakesNamesWeldAndNotTheRepairThatCutsApart) {
  const TriangleSoup soup{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1e-7}, {0, 1, 0}}, {{0, 1, 2}, {0, 3, 4}}, {}};
  const Error error = expect_error("mesh.non_manifold_vertex", [&] { build_with_advice(soup); });
  EXPECT_NE(std::string(error.what()).find("repair=weld the mesh is sound"), std::string::npos) << error.what();
  EXPECT_EQ(std::string(error.what()).find("split"), std::string::npos) << error.what();
  TriangleSoup repaired = soup;
  EXPECT_EQ(made_by(repair_automatically(repaired)), std::vector<std::string>{"weld"});
  EXPECT_EQ(report(build_with_advice(repaired)).components, 1);
}

TEST(MeshCracks, ThinWallsAndSheetsAndSmallFeaturesStayAsTheyAre) {
  for (const double thickness : {1e-3, 1e-5, 1e-6, 1e-8}) {
    SCOPED_TRACE(thickness);
    // A closed plate.
    TriangleSoup plate = soup_of(testing::icosphere(3));
    for (auto& p : plate.positions) p[2] *= thickness;
    // Two sheets with the same outline.
    TriangleSoup sheets;
    for (const double z : {0.0, thickness}) {
      const auto first = static_cast<std::int32_t>(sheets.positions.size());
      for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}})
        sheets.positions.emplace_back(x, y, z);
      sheets.faces.push_back({first, first + 1, first + 2});
      sheets.faces.push_back({first, first + 2, first + 3});
    }
    // A slit: narrower than its sides are long, but no crack.
    TriangleSoup slit = soup_of(testing::icosphere(2));
    for (auto& p : slit.positions) p *= thickness;
    const auto first = static_cast<std::int32_t>(slit.positions.size());
    slit.positions.insert(slit.positions.end(), {{5, 0, 0}, {6, 0, 0}, {5, 1, 0}});
    slit.faces.push_back({first, first + 1, first + 2});
    for (const TriangleSoup& given : {plate, sheets, slit}) {
      TriangleSoup soup = given;
      RepairOptions weld;
      weld.ask(Repair::weld);
      EXPECT_EQ(repair_mesh(soup, weld).welded_vertices, 0);
      EXPECT_EQ(soup.positions, given.positions);
      EXPECT_TRUE(crack_warnings(build_with_advice(given)).empty());
    }
  }
}

TEST(MeshCracks, AGapThatIsNotFarBelowTheEdgesThereIsNone) {
  RandomStream stream("gaps", 1);
  TriangleSoup soup = tube_with_seam(12, 5, 0, stream);
  for (std::size_t v = soup.positions.size() - 6; v < soup.positions.size(); ++v) soup.positions[v][1] -= 1e-3;
  EXPECT_TRUE(crack_warnings(build_with_advice(soup)).empty());
  // Far from the origin single precision cannot tell so small a part's corners apart; its edges still can.
  TriangleSoup far = soup;
  for (auto& p : far.positions) p = p * 1e-5 + Eigen::Vector3d(10, 0, 0);
  EXPECT_EQ(repair_automatically(far).welded_vertices, 6);
  // There a gap of a quarter of an edge is as small for single precision, but no crack.
  for (std::size_t v = soup.positions.size() - 6; v < soup.positions.size(); ++v) soup.positions[v][1] -= 0.1;
  for (auto& p : soup.positions) p = p * 1e-5 + Eigen::Vector3d(10, 0, 0);
  EXPECT_EQ(repair_automatically(soup).welded_vertices, 0);
}

TEST(MeshCracks, ASeamThatWouldCloseToAMoebiusStripIsNotRecommended) {
  TriangleSoup soup;
  const std::int32_t columns = 24;
  for (std::int32_t i = 0; i <= columns; ++i) {
    const double angle = 2 * std::numbers::pi * i / columns;
    for (const double side : {-0.3, 0.3}) {
      const double radius = 1 + side * std::cos(angle / 2);
      soup.positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), side * std::sin(angle / 2));
    }
    if (i == columns) break;
    soup.faces.push_back({2 * i, 2 * i + 2, 2 * i + 3});
    soup.faces.push_back({2 * i, 2 * i + 3, 2 * i + 1});
  }
  const auto warnings = crack_warnings(build_with_advice(soup));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("not sound"), std::string::npos) << warnings[0];
  EXPECT_TRUE(made_by(repair_automatically(soup)).empty());
  EXPECT_NO_THROW(build_with_advice(soup));
  // Where there is a fault besides, it is repaired without joining the seam.
  soup.faces.push_back({0, 0, 2});
  EXPECT_EQ(made_by(repair_automatically(soup)), std::vector<std::string>{"drop_degenerate"});
  EXPECT_NO_THROW(build_with_advice(soup));
}

TEST(AutomaticRepair, LeavesASoundMeshAlone) {
  for (const TriangleMesh& mesh : {testing::torus(12, 8), testing::open_hemisphere(), testing::two_components()}) {
    TriangleSoup soup = soup_of(mesh);
    EXPECT_TRUE(made_by(repair_automatically(soup)).empty());
    EXPECT_EQ(soup.positions, mesh.positions());
    EXPECT_EQ(soup.faces, mesh.faces());
  }
}

TEST(AutomaticRepair, MakesNoMoreRepairsThanItTakes) {
  const std::vector<Eigen::Vector3d> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 3e-17}};
  struct Case {
    std::vector<Triangle> faces;
    std::string code;
    std::vector<std::string> made;
  };
  const Case cases[] = {
      {{{0, 1, 2}, {0, 2, 2}, {0, 2, 3}}, "mesh.degenerate_face", {"drop_degenerate"}},
      {{{0, 1, 2}, {2, 1, 0}, {0, 2, 3}}, "mesh.non_manifold_edge", {"drop_duplicates"}},
      {{{0, 1, 2}, {0, 2, 3}, {0, 2, 4}}, "mesh.non_manifold_edge", {"split_non_manifold"}},
      {{{0, 1, 2}, {2, 1, 0}, {0, 2, 3}, {0, 3, 3}, {0, 2, 4}},
       "mesh.degenerate_face",
       {"drop_degenerate", "drop_duplicates", "split_non_manifold"}},
      {{{0, 1, 4}, {0, 5, 2}, {0, 2, 3}, {1, 5, 4}}, "mesh.degenerate_face", {"weld", "drop_degenerate"}},
  };
  for (const Case& c : cases) {
    TriangleSoup soup{square, c.faces, {}};
    const Error error = expect_error(c.code, [&] { build_with_advice(soup); });
    std::string names;
    for (const auto& name : c.made) names += (names.empty() ? "" : ",") + name;
    EXPECT_NE(std::string(error.what()).find("repair=" + names + " the"), std::string::npos) << error.what();
    EXPECT_EQ(made_by(repair_automatically(soup)), c.made);
    EXPECT_NO_THROW(build_with_advice(soup));
  }
}

TEST(AutomaticRepair, WhatNoRepairHelpsIsRefusedWithTheFaultItWasGivenWith) {
  // A Moebius strip of five triangles.
  const TriangleSoup moebius{{{1, 0, 0}, {0.3, 1, 0.2}, {-0.8, 0.6, -0.4}, {-0.8, -0.6, 0.4}, {0.3, -1, -0.2}},
                             {{0, 1, 2}, {1, 2, 3}, {2, 3, 4}, {3, 4, 0}, {4, 0, 1}},
                             {}};
  TriangleSoup soup = moebius;
  const Error error = expect_error("mesh.not_orientable", [&] { repair_automatically(soup); });
  EXPECT_NE(std::string(error.what()).find("no repair removes this fault"), std::string::npos) << error.what();
  expect_error("mesh.not_orientable", [&] { build_with_advice(moebius); });
}

TEST(AutomaticRepair, VerticesThatNoFaceUsesAreNoReasonToRefuse) {
  const double nan = std::nan("");
  TriangleSoup soup{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {nan, 0, 1e300}, {0, 0, INFINITY}}, {{0, 1, 2}}, {}};
  const TriangleMesh mesh = build_with_advice(soup);
  EXPECT_EQ(mesh.positions()[3], Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(mesh.warnings().at(0),
            "2 vertices that no face uses have coordinates that are not finite or too large; they are 0 in the mesh.");
  EXPECT_TRUE(made_by(repair_automatically(soup)).empty());
  soup.positions[1][2] = nan;
  expect_error("mesh.non_finite", [&] { build_with_advice(soup); });
}

}  // namespace
}  // namespace supple::surface
