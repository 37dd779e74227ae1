#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "supple/voronoi/diagram.h"

namespace supple::testing {

/// The diagram without the points at which borders only bend.
inline voronoi::Diagram without_bends(voronoi::Diagram diagram) {
  std::vector<std::int32_t> renamed(diagram.points.size(), -1);
  std::vector<voronoi::DiagramPoint> kept;
  for (std::size_t i = 0; i < renamed.size(); ++i) {
    if (diagram.points[i].kind == voronoi::DiagramPoint::Kind::inner) continue;
    renamed[i] = static_cast<std::int32_t>(kept.size());
    kept.push_back(diagram.points[i]);
  }
  diagram.points = std::move(kept);
  const auto rename = [&](std::vector<std::int32_t>& points) {
    std::vector<std::int32_t> left;
    for (const std::int32_t point : points)
      if (renamed[static_cast<std::size_t>(point)] >= 0) left.push_back(renamed[static_cast<std::size_t>(point)]);
    points = std::move(left);
  };
  for (voronoi::DiagramVertex& vertex : diagram.vertices)
    vertex.point = renamed[static_cast<std::size_t>(vertex.point)];
  for (voronoi::DiagramEdge& edge : diagram.edges) rename(edge.points);
  for (voronoi::DiagramCell& cell : diagram.cells)
    for (std::vector<std::int32_t>& border : cell.boundary) rename(border);
  return diagram;
}

/// Expects that two diagrams are the same up to rounding: they have the same points, vertices, edges and cells in the
/// same order, positions agree within `tolerance`, and areas within 1e-12 of the total area. Rounding moves the inner
/// points of a border, at which it bends, along it by about 1e-7 of a face. It also decides whether a cell's part of a
/// face is one piece or two, so that only the sites of pieces are compared.
inline void expect_same_diagram(const voronoi::Diagram& found, const voronoi::Diagram& wanted, double tolerance) {
  ASSERT_EQ(found.points.size(), wanted.points.size());
  for (std::size_t i = 0; i < wanted.points.size(); ++i) {
    EXPECT_EQ(found.points[i].kind, wanted.points[i].kind);
    const double own = wanted.points[i].kind == voronoi::DiagramPoint::Kind::inner ? 1e6 * tolerance : tolerance;
    EXPECT_LE((found.points[i].position - wanted.points[i].position).norm(), own);
    EXPECT_NEAR(found.points[i].distance, wanted.points[i].distance, own);
  }
  ASSERT_EQ(found.vertices.size(), wanted.vertices.size());
  for (std::size_t i = 0; i < wanted.vertices.size(); ++i) {
    EXPECT_EQ(found.vertices[i].point, wanted.vertices[i].point);
    EXPECT_EQ(found.vertices[i].sites, wanted.vertices[i].sites);
  }
  ASSERT_EQ(found.edges.size(), wanted.edges.size());
  for (std::size_t i = 0; i < wanted.edges.size(); ++i) {
    EXPECT_EQ(found.edges[i].sites, wanted.edges[i].sites);
    EXPECT_EQ(found.edges[i].points, wanted.edges[i].points);
    EXPECT_NEAR(found.edges[i].length, wanted.edges[i].length, tolerance);
  }
  double area = wanted.unreached_area;
  for (const voronoi::DiagramCell& cell : wanted.cells) area += cell.area;
  ASSERT_EQ(found.cells.size(), wanted.cells.size());
  for (std::size_t i = 0; i < wanted.cells.size(); ++i) {
    EXPECT_NEAR(found.cells[i].area, wanted.cells[i].area, 1e-12 * area);
    EXPECT_EQ(found.cells[i].boundary, wanted.cells[i].boundary);
    EXPECT_EQ(found.cells[i].vertices, wanted.cells[i].vertices);
    EXPECT_EQ(found.cells[i].neighbours, wanted.cells[i].neighbours);
  }
  EXPECT_NEAR(found.unreached_area, wanted.unreached_area, 1e-12 * area);
  EXPECT_EQ(found.dual, wanted.dual);
  EXPECT_EQ(found.vertex_sites, wanted.vertex_sites);
  EXPECT_EQ(found.face_sites, wanted.face_sites);
  const auto parts = [](const voronoi::Diagram& diagram) {
    std::set<std::pair<std::int32_t, std::int32_t>> result;
    for (const voronoi::DiagramPiece& piece : diagram.pieces) result.emplace(piece.face, piece.site);
    return result;
  };
  EXPECT_EQ(parts(found), parts(wanted));
  EXPECT_EQ(found.warnings, wanted.warnings);
  const auto expect_same_pull = [&](const voronoi::SiteDistanceGradient& one,
                                    const voronoi::SiteDistanceGradient& other) {
    EXPECT_EQ(one.site, other.site);
    EXPECT_NEAR(one.distance, other.distance, tolerance);
    EXPECT_LE((one.by_place - other.by_place).norm(), 1e-9);
    EXPECT_LE((one.by_site - other.by_site).norm(), 1e-9);
  };
  ASSERT_EQ(found.vertex_gradients.size(), wanted.vertex_gradients.size());
  for (std::size_t i = 0; i < wanted.vertex_gradients.size(); ++i)
    expect_same_pull(found.vertex_gradients[i], wanted.vertex_gradients[i]);
  ASSERT_EQ(found.border_samples.size(), wanted.border_samples.size());
  for (std::size_t i = 0; i < wanted.border_samples.size(); ++i) {
    for (std::size_t side = 0; side < 2; ++side)
      EXPECT_EQ(found.border_samples[i].gradients[side].site, wanted.border_samples[i].gradients[side].site);
    EXPECT_NEAR(found.border_samples[i].weight, wanted.border_samples[i].weight, tolerance);
  }
  ASSERT_EQ(found.cell_moments.size(), wanted.cell_moments.size());
  for (std::size_t i = 0; i < wanted.cell_moments.size(); ++i) {
    EXPECT_NEAR(found.cell_moments[i].squared_distance, wanted.cell_moments[i].squared_distance, 1e-12 * area * area);
    EXPECT_LE((found.cell_moments[i].gradient - wanted.cell_moments[i].gradient).norm(), 1e-9 * area * std::sqrt(area));
  }
}

}  // namespace supple::testing
