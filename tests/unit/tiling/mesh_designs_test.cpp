#include <gtest/gtest.h>

#include <set>

#include "designs.h"
#include "supple/base/error.h"
#include "supple/tiling/mesh.h"

namespace supple::tiling {
namespace {

using testing::expect_sound;
using testing::random_parameters;

constexpr double degree = 3.14159265358979 / 180;

std::string text(const std::vector<double>& parameters) {
  std::string result;
  for (const double p : parameters) result += " " + std::to_string(p);
  return result;
}

/// The codes with which designs in and around the box may be refused. Any other code is a bug.
const std::set<std::string> refusals = {"tiling.cell_too_small", "tiling.hole_closed"};

// Meshes the design, or expects that it is refused with one of these codes. Returns whether it was meshed.
bool mesh_or_refuse(const Family& family, const std::vector<double>& parameters, const MeshOptions& options) {
  SCOPED_TRACE(family.id + text(parameters));
  Structure structure;
  try {
    structure = make_structure(family, parameters, 0.1);
  } catch (const Error& error) {
    EXPECT_TRUE(refusals.contains(error.code())) << error.what();
    return false;
  }
  const PeriodicMesh mesh = mesh_structure(structure, options);
  expect_sound(mesh, structure);
  if (options.region == Region::automatic) {
    EXPECT_GT(statistics(mesh).smallest_angle, 2 * degree);
  }
  return true;
}

class EveryFamily : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryFamily, RandomDesignsInAndAroundTheBoxAreMeshedOrRefused) {
  const Family& type = family(GetParam());
  RandomStream random("tiling.designs." + type.id, 3);
  int meshed = 0;
  for (int design = 0; design < 24; ++design) {
    meshed += mesh_or_refuse(type, random_parameters(type, random, 0.1), {.mesh_size = 0.5, .corner_size = 0.3});
  }
  EXPECT_GE(meshed, 12);
}

TEST_P(EveryFamily, RandomDesignsAreMeshedByTilesAndByCellsAlone) {
  const Family& type = family(GetParam());
  RandomStream random("tiling.regions." + type.id, 4);
  for (int design = 0; design < 6; ++design) {
    const auto parameters = random_parameters(type, random);
    mesh_or_refuse(type, parameters, {.mesh_size = 1.0 / 3, .corner_size = 1, .region = Region::tile});
    mesh_or_refuse(type, parameters, {.mesh_size = 1.0 / 3, .corner_size = 1, .region = Region::cell});
  }
}

TEST_P(EveryFamily, CornersOfTheBoxAreMeshedOrRefused) {
  const Family& type = family(GetParam());
  const auto n = type.parameters.size();
  for (unsigned corner = 0; corner < 1u << n; ++corner) {
    std::vector<double> parameters;
    for (std::size_t k = 0; k < n; ++k) {
      parameters.push_back(corner >> k & 1 ? type.parameters[k].upper : type.parameters[k].lower);
    }
    mesh_or_refuse(type, parameters, {.mesh_size = 0.6, .corner_size = 0.5});
  }
}

INSTANTIATE_TEST_SUITE_P(MeshDesigns, EveryFamily,
                         ::testing::Values("IH01", "IH21", "IH22", "IH28", "IH29", "IH50", "IH67", "square"),
                         [](const auto& instance) { return instance.param; });

TEST(MeshDesigns, TheSquareFamilyIsMeshedThroughItsSingularityAndWhereItsHolesClose) {
  for (const double p : {0.0,  1e-12, 1e-9,   1e-6,   1e-3, 0.02,  0.0423,   0.0425,   0.043,     0.05,
                         0.95, 0.957, 0.9575, 0.9577, 0.97, 0.999, 1 - 1e-6, 1 - 1e-9, 1 - 1e-12, 1.0}) {
    EXPECT_TRUE(mesh_or_refuse(family("square"), {p}, {.mesh_size = 0.5})) << p;
    EXPECT_TRUE(mesh_or_refuse(family("square"), {-p}, {.mesh_size = 0.5, .corner_size = 0.2})) << p;
  }
}

TEST(MeshDesigns, TilesWithSpikesInsideABeamGetNoSharpTriangles) {
  // Two sides of the tile are almost parallel and close to each other.
  const Structure structure = make_structure(family("IH01"), std::vector{0.289901, 0.500677, 0.093444, 0.409483});
  EXPECT_LT(statistics(mesh_structure(structure, {.corner_size = 1, .region = Region::tile})).smallest_angle,
            3 * degree);
  EXPECT_GT(statistics(mesh_structure(structure, {.corner_size = 1})).smallest_angle, 20 * degree);
}

TEST(MeshDesigns, TilesThatCrossThemselvesAreMeshedWhateverTheRegion) {
  const std::vector<double> hidden = {0.1802089117, 0.5506587018, 0.09055189846, 0.778137};
  for (const Region region : {Region::automatic, Region::tile, Region::cell}) {
    EXPECT_TRUE(mesh_or_refuse(family("IH01"), hidden, {.mesh_size = 0.5, .region = region}));
  }
}

}  // namespace
}  // namespace supple::tiling
