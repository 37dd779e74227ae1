#include "supple/voronoi/export.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string>

#include "panels.h"
#include "support/shapes.h"

namespace supple::voronoi {
namespace {

Diagram diagram_of(const surface::TriangleMesh& mesh, int sites) {
  const surface::GeodesicSolver solver(testing::share(mesh));
  return diagram(solver, random_sites(mesh, sites, 3));
}

TEST(VoronoiExport, PanelsOfAPlaneAreItsCells) {
  const surface::TriangleMesh mesh = testing::flat_grid(6, 5);
  const Diagram result = diagram_of(mesh, 20);
  const std::vector<Panel> flat = panels(result);
  ASSERT_EQ(flat.size(), 20U);
  for (const Panel& panel : flat) {
    double doubled = 0;
    for (std::size_t k = 0; k < panel.corners.size(); ++k) {
      const auto& a = panel.corners[k];
      const auto& b = panel.corners[(k + 1) % panel.corners.size()];
      doubled += a.x() * b.y() - a.y() * b.x();
      EXPECT_NEAR((b - a).norm(), panel.border_lengths[k], 1e-9);
      EXPECT_NEAR(panel.deviations[k], 0, 1e-12);
    }
    EXPECT_NEAR(0.5 * doubled, result.cells[static_cast<std::size_t>(panel.site)].area, 1e-9);
  }
}

TEST(VoronoiExport, PanelsOfNeighboursShareNumberedEdges) {
  const Diagram result = diagram_of(testing::icosphere(3), 30);
  std::map<std::int32_t, std::vector<std::int32_t>> panels_of_edges;
  for (const Panel& panel : panels(result)) {
    for (std::size_t k = 0; k < panel.edges.size(); ++k) {
      ASSERT_GE(panel.edges[k], 0);
      panels_of_edges[panel.edges[k]].push_back(panel.site);
      const auto& sites = result.edges[static_cast<std::size_t>(panel.edges[k])].sites;
      EXPECT_EQ(sites[0] + sites[1], panel.site + panel.neighbours[k]);
    }
  }
  EXPECT_EQ(panels_of_edges.size(), result.edges.size());
  for (const auto& [edge, sites] : panels_of_edges) EXPECT_EQ(sites.size(), 2U) << edge;
}

TEST(VoronoiExport, TableHasALineForEveryCorner) {
  const Diagram result = diagram_of(testing::icosphere(2), 12);
  std::size_t corners = 0;
  double angles = 0;
  for (const Panel& panel : panels(result)) corners += panel.corners.size();
  std::istringstream table(write_panels_csv(result));
  std::string line;
  std::getline(table, line);
  EXPECT_EQ(line, "panel,edge,neighbour,length,border_length,angle_degrees,deviation");
  std::size_t lines = 0;
  while (std::getline(table, line)) {
    ++lines;
    std::istringstream fields(line);
    std::string field;
    for (int k = 0; k < 6; ++k) std::getline(fields, field, ',');
    angles += std::stod(field);
  }
  EXPECT_EQ(lines, corners);
  // The angles of a polygon of n corners sum up to (n - 2) 180 degrees.
  EXPECT_NEAR(angles, 180 * (static_cast<double>(corners) - 2 * 12), 1e-6);
}

TEST(VoronoiExport, SheetHasEveryPanelOnce) {
  const Diagram result = diagram_of(testing::icosphere(2), 12);
  const std::string svg = write_panels_svg(result, 100);
  std::size_t paths = 0;
  for (std::size_t at = svg.find("<path"); at != std::string::npos; at = svg.find("<path", at + 1)) ++paths;
  EXPECT_EQ(paths, 12U);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(VoronoiExport, FilesHaveTheWholeSurfaceAndEveryBorder) {
  const surface::TriangleMesh mesh = testing::icosphere(2);
  const Diagram result = diagram_of(mesh, 12);
  std::istringstream file(write_obj(mesh, result));
  std::vector<Eigen::Vector3d> points;
  double area = 0;
  std::size_t lines = 0;
  std::string kind;
  for (std::string text; std::getline(file, text);) {
    std::istringstream fields(text);
    fields >> kind;
    if (kind == "v") {
      Eigen::Vector3d& p = points.emplace_back();
      fields >> p[0] >> p[1] >> p[2];
    } else if (kind == "l") {
      ++lines;
    } else if (kind == "f") {
      std::vector<std::size_t> corners;
      for (std::size_t i = 0; fields >> i;) corners.push_back(i - 1);
      Eigen::Vector3d normal = Eigen::Vector3d::Zero();
      for (std::size_t k = 2; k < corners.size(); ++k)
        normal += (points[corners[k - 1]] - points[corners[0]]).cross(points[corners[k]] - points[corners[0]]);
      area += 0.5 * normal.norm();
    }
  }
  EXPECT_EQ(lines, result.edges.size());
  double total = 0;
  for (const DiagramCell& cell : result.cells) total += cell.area;
  EXPECT_NEAR(area, total, 1e-9);
  const std::string vtu = write_vtu(mesh, result);
  EXPECT_NE(vtu.find("Name=\"site\""), std::string::npos);
  EXPECT_NE(vtu.find("Name=\"area\""), std::string::npos);
}

}  // namespace
}  // namespace supple::voronoi
