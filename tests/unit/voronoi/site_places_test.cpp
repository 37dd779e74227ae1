#include "site_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "supple/base/error.h"
#include "support/shapes.h"

namespace supple::voronoi {
namespace {

using surface::SurfacePoint;
using surface::TriangleMesh;

/// The result by comparing every site with all sites before it.
std::vector<std::int32_t> by_pairs(const TriangleMesh& mesh, const std::vector<SurfacePoint>& sites) {
  std::vector<std::int32_t> first(sites.size());
  for (std::size_t i = 0; i < sites.size(); ++i) {
    first[i] = static_cast<std::int32_t>(i);
    for (std::size_t j = 0; j < i && first[i] == static_cast<std::int32_t>(i); ++j) {
      const double apart = (surface::position(mesh, sites[i]) - surface::position(mesh, sites[j])).norm();
      if (first[j] == static_cast<std::int32_t>(j) && apart <= 1e-13 * mesh.mean_edge_length())
        first[i] = static_cast<std::int32_t>(j);
    }
  }
  return first;
}

TEST(SitePlaces, AreThoseThatComparingAllPairsFinds) {
  const TriangleMesh mesh = testing::flat_grid(4, 4);  // so that many sites have the same x
  std::mt19937 random(7);
  const auto among = [&](int count) { return std::uniform_int_distribution<int>(0, count - 1)(random); };
  for (const int corners : {2, 4, 16, 1024}) {
    std::vector<SurfacePoint> sites;
    for (int i = 0; i < 400; ++i) {
      const double u = among(corners) / static_cast<double>(corners);
      const double v = (1 - u) * among(corners) / corners;
      sites.push_back({FaceId(among(mesh.face_count())), {u, v, 1 - u - v}});
    }
    EXPECT_EQ(first_in_place(mesh, sites, {}), by_pairs(mesh, sites)) << corners;
  }
}

TEST(SitePlaces, OfManySitesInOnePlaceIsTheFirst) {
  const TriangleMesh mesh = testing::flat_grid(2, 2);
  const auto cells_of = [&](double apart) {
    std::vector<SurfacePoint> sites;
    for (int i = 0; i < 100'000; ++i) {
      const double u = 0.2 + apart * i;
      sites.push_back({FaceId(0), {u, 0.3, 0.7 - u}});
    }
    const auto first = first_in_place(mesh, sites, {});
    int cells = 0;
    for (std::size_t i = 0; i < first.size(); ++i) cells += first[i] == static_cast<std::int32_t>(i) ? 1 : 0;
    return cells;
  };
  EXPECT_EQ(cells_of(0), 1);
  EXPECT_EQ(cells_of(1e-12), 100'000);
}

TEST(SitePlaces, OfSheetsThatTouchAreNotOneAndAStopIsHeardAmongMany) {
  const int sheets = 3000;
  std::vector<Eigen::Vector3d> vertices;
  std::vector<surface::Triangle> faces;
  std::vector<SurfacePoint> sites;
  for (int k = 0; k < sheets; ++k) {
    for (const Eigen::Vector3d& corner : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0)})
      vertices.push_back(corner);
    faces.push_back({3 * k, 3 * k + 1, 3 * k + 2});
    sites.push_back({FaceId(k), {0.2, 0.3, 0.5}});
  }
  const TriangleMesh mesh = TriangleMesh::build(vertices, faces);
  const auto first = first_in_place(mesh, sites, {});
  for (std::size_t i = 0; i < first.size(); ++i) ASSERT_EQ(first[i], static_cast<std::int32_t>(i));
  const CancellationToken stopped;
  stopped.request(StopReason::deadline);
  EXPECT_THROW(first_in_place(mesh, sites, stopped), Cancelled);
}

}  // namespace
}  // namespace supple::voronoi
