#include "designs.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <map>
#include <tuple>

#include "polygon.h"

namespace supple::tiling::testing {
namespace {

struct SideUse {
  int triangle, side;
};

// The triangles at each side. The key is the node at the side's midpoint.
std::map<int, std::vector<SideUse>> uses_of_sides(const PeriodicMesh& mesh) {
  std::map<int, std::vector<SideUse>> uses;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    for (int k = 0; k < 3; ++k) uses[mesh.triangles[t][3 + k]].push_back({t, k});
  }
  return uses;
}

bool within_a_hole(const Structure& structure, const Eigen::Vector2d& point) {
  return windings(structure.tiling, structure.holes, point) > 0;
}

void expect_outline(const PeriodicMesh& mesh, const Structure& structure,
                    const std::map<int, std::vector<SideUse>>& uses) {
  std::size_t once = 0;
  for (const auto& [middle, list] : uses) once += list.size() == 1;
  EXPECT_EQ(mesh.outline.size(), once);
  for (const auto& [triangle, side] : mesh.outline) {
    ASSERT_EQ(uses.at(mesh.triangles[triangle][3 + side]).size(), 1u);
    const Eigen::Vector2d a = mesh.corner(triangle, side), b = mesh.corner(triangle, (side + 1) % 3);
    const Eigen::Vector2d right = Eigen::Vector2d(b.y() - a.y(), a.x() - b.x()).normalized();
    ASSERT_TRUE(within_a_hole(structure, (a + b) / 2 + 1e-5 * right)) << "at " << a.transpose();
    ASSERT_FALSE(within_a_hole(structure, (a + b) / 2 - 1e-5 * right)) << "at " << a.transpose();
  }
}

}  // namespace

std::vector<double> random_parameters(const Family& family, RandomStream& random, double margin) {
  std::vector<double> result;
  for (const auto& [lower, upper, preset] : family.parameters) {
    const double beyond = margin * (upper - lower);
    result.push_back(random.uniform(lower - beyond, upper + beyond));
  }
  return result;
}

int windings(const Tiling& tiling, const std::vector<std::vector<Polygon>>& polygons, const Eigen::Vector2d& point) {
  const Eigen::Matrix2d inverse = tiling.lattice.inverse();
  int winding = 0;
  for (const std::vector<Polygon>& of_tile : polygons) {
    for (const Polygon& copy : of_tile) {
      // The range of translations, in lattice coordinates, that move the point into the bounds of the copy.
      Eigen::Array2d lower = Eigen::Array2d::Constant(INFINITY), upper = -lower;
      for (const Eigen::Vector2d& p : copy) {
        const Eigen::Array2d at = inverse * (p - point);
        lower = lower.min(at);
        upper = upper.max(at);
      }
      const Eigen::Array2i first = lower.ceil().cast<int>();
      for (int i = first[0]; i <= upper[0]; ++i) {
        for (int j = first[1]; j <= upper[1]; ++j) {
          winding += winding_number(copy, point + tiling.lattice * Eigen::Vector2d(i, j));
        }
      }
    }
  }
  return winding;
}

void expect_sound(const PeriodicMesh& mesh, const Structure& structure) {
  ASSERT_EQ(mesh.triangles.size(), mesh.shifts.size());
  double doubled = 0;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    const Eigen::Vector2d a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
    const double here = cross(b - a, c - a);
    ASSERT_GT(here, 0) << "triangle " << t;
    doubled += here;
    ASSERT_NEAR((mesh.corner(t, 3) - (a + b) / 2).norm(), 0, 1e-6);
    ASSERT_NEAR((mesh.corner(t, 4) - (b + c) / 2).norm(), 0, 1e-6);
    ASSERT_NEAR((mesh.corner(t, 5) - (c + a) / 2).norm(), 0, 1e-6);
  }
  EXPECT_NEAR(doubled / 2, structure.solid_area, 1e-6 * structure.cell_area);
  EXPECT_NEAR(mesh.solid_area(), doubled / 2, 1e-9 * doubled);
  EXPECT_NEAR(mesh.cell_area(), structure.cell_area, 1e-9 * structure.cell_area);

  const auto uses = uses_of_sides(mesh);
  for (const auto& [middle, list] : uses) {
    ASSERT_LE(list.size(), 2u);
    if (list.size() == 1) continue;
    // The second triangle, translated to the first one, has the side in the opposite direction.
    const auto& [t, k] = list[0];
    const auto& [u, l] = list[1];
    const Eigen::Vector2d by = mesh.corner(t, 3 + k) - mesh.corner(u, 3 + l);
    ASSERT_NEAR((mesh.corner(t, k) - mesh.corner(u, (l + 1) % 3) - by).norm(), 0, 1e-6);
    ASSERT_EQ(mesh.triangles[t][k], mesh.triangles[u][(l + 1) % 3]);
    ASSERT_EQ(mesh.triangles[t][(k + 1) % 3], mesh.triangles[u][l]);
  }
  expect_outline(mesh, structure, uses);

  // The Euler characteristic of a torus with holes: corners - sides + triangles = -holes.
  std::ptrdiff_t holes = 0;
  for (const auto& of_tile : structure.holes) holes += static_cast<std::ptrdiff_t>(of_tile.size());
  const auto sides = static_cast<std::ptrdiff_t>(uses.size());
  EXPECT_EQ(mesh.nodes.cols() - 2 * sides + static_cast<std::ptrdiff_t>(mesh.triangles.size()), -holes);
}

bool identical(const PeriodicMesh& a, const PeriodicMesh& b) {
  const auto same_side = [](const PeriodicMesh::Side& s, const PeriodicMesh::Side& t) {
    return std::tie(s.triangle, s.side) == std::tie(t.triangle, t.side);
  };
  return a.nodes.cols() == b.nodes.cols() && a.nodes == b.nodes && a.triangles == b.triangles && a.shifts == b.shifts &&
         std::equal(a.outline.begin(), a.outline.end(), b.outline.begin(), b.outline.end(), same_side);
}

}  // namespace supple::tiling::testing
