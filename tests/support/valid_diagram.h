#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <vector>

#include "supple/surface/geodesic_solver.h"
#include "supple/voronoi/diagram.h"
#include "support/shapes.h"

namespace supple::testing {

inline double area_of(const surface::TriangleMesh& mesh, std::int32_t face) {
  const auto& p = mesh.positions();
  const auto& [a, b, c] = mesh.faces()[static_cast<std::size_t>(face)];
  return 0.5 * (p[static_cast<std::size_t>(b)] - p[static_cast<std::size_t>(a)])
                   .cross(p[static_cast<std::size_t>(c)] - p[static_cast<std::size_t>(a)])
                   .norm();
}

inline double area_of(const surface::TriangleMesh& mesh) {
  double area = 0;
  for (std::int32_t face = 0; face < mesh.face_count(); ++face) area += area_of(mesh, face);
  return area;
}

/// The Euler characteristic V - E + F of a mesh whose vertices are all used.
inline int euler_characteristic(const surface::TriangleMesh& mesh) {
  int edges = 0;
  for (std::int32_t h = 0; h < mesh.halfedge_count(); ++h)
    if (mesh.twin(h) < h) ++edges;
  return mesh.vertex_count() - edges + mesh.face_count();
}

/// Moves one of every three sites to a vertex of its face, and another one to an edge.
inline std::vector<surface::SurfacePoint> on_vertices_and_edges(std::vector<surface::SurfacePoint> sites) {
  for (std::size_t i = 0; i < sites.size(); ++i) {
    Eigen::Vector3d& weights = sites[i].barycentric;
    Eigen::Index corner = 0;
    if (i % 3 == 0) {
      weights.maxCoeff(&corner);
      weights = Eigen::Vector3d::Unit(corner);
    } else if (i % 3 == 1) {
      weights.minCoeff(&corner);
      weights[corner] = 0;
      weights /= weights.sum();
    }
  }
  return sites;
}

/// Distances of all sites from any point, with a separate search for each site.
class SiteDistances {
 public:
  SiteDistances(const surface::TriangleMesh& mesh, const std::vector<surface::SurfacePoint>& sites) {
    const surface::GeodesicSolver solver(share(mesh));
    for (const surface::SurfacePoint& site : sites) fields_.push_back(solver.field({&site, 1}, {.keep_windows = true}));
  }
  double from(std::int32_t site, const surface::SurfacePoint& point) const {
    return fields_[static_cast<std::size_t>(site)].distance(point);
  }
  double least(const surface::SurfacePoint& point) const {
    double least = std::numeric_limits<double>::infinity();
    for (const surface::GeodesicField& field : fields_) least = std::min(least, field.distance(point));
    return least;
  }

 private:
  std::vector<surface::GeodesicField> fields_;
};

/// The sum of the areas of each site's whole faces and pieces, which are polygons.
inline std::vector<double> areas_of_pieces(const surface::TriangleMesh& mesh, const voronoi::Diagram& diagram) {
  std::vector<double> areas(diagram.cells.size(), 0);
  for (std::size_t face = 0; face < diagram.face_sites.size(); ++face)
    if (diagram.face_sites[face] >= 0)
      areas[static_cast<std::size_t>(diagram.face_sites[face])] += area_of(mesh, static_cast<std::int32_t>(face));
  for (const voronoi::DiagramPiece& piece : diagram.pieces) {
    const auto corner = [&](int i) {
      const Eigen::Vector3d& b = diagram.corners[static_cast<std::size_t>(piece.first_corner + i)];
      return Eigen::Vector2d(b[1], b[2]);
    };
    double part = 0;
    for (int i = 2; i < piece.corner_count; ++i) {
      const Eigen::Vector2d a = corner(i - 1) - corner(0);
      const Eigen::Vector2d b = corner(i) - corner(0);
      part += a.x() * b.y() - a.y() * b.x();
    }
    areas[static_cast<std::size_t>(piece.site)] += part * area_of(mesh, piece.face);
  }
  return areas;
}

/// For each cell a bound of the area between its curved borders and the straight lines between their points, by which
/// the areas of polygonal pieces deviate. The sagitta of an arc of length L over a chord C is about
/// sqrt(3 C (L - C) / 8).
inline std::vector<double> areas_beside_chords(const voronoi::Diagram& diagram) {
  std::vector<double> bounds(diagram.cells.size(), 0);
  for (const voronoi::DiagramEdge& edge : diagram.edges) {
    double chords = 0;
    for (std::size_t i = 1; i < edge.points.size(); ++i)
      chords += (diagram.points[static_cast<std::size_t>(edge.points[i])].position -
                 diagram.points[static_cast<std::size_t>(edge.points[i - 1])].position)
                    .norm();
    const double bound = 0.5 * chords * std::sqrt(chords * std::max(edge.length - chords, 0.0));
    for (const std::int32_t site : edge.sites) bounds[static_cast<std::size_t>(site)] += bound;
  }
  return bounds;
}

inline bool is_convex(const voronoi::Diagram& diagram, const voronoi::DiagramPiece& piece) {
  const auto corner = [&](int i) {
    const Eigen::Vector3d& b = diagram.corners[static_cast<std::size_t>(piece.first_corner + i % piece.corner_count)];
    return Eigen::Vector2d(b[1], b[2]);
  };
  for (int i = 0; i < piece.corner_count; ++i) {
    const Eigen::Vector2d a = corner(i + 1) - corner(i);
    const Eigen::Vector2d b = corner(i + 2) - corner(i + 1);
    if (a.x() * b.y() - a.y() * b.x() < -1e-14) return false;
  }
  return true;
}

/// Expects that the site of a whole face, and that of a convex piece of a cell with straight borders, is a nearest site
/// of its centre.
inline void expect_nearest_sites(const surface::TriangleMesh& mesh, const voronoi::Diagram& diagram,
                                 const SiteDistances& distances, double tolerance) {
  const auto expect_at = [&](std::int32_t face, const Eigen::Vector3d& barycentric, std::int32_t site) {
    const surface::SurfacePoint point{FaceId(face), barycentric};
    EXPECT_LE(distances.from(site, point), distances.least(point) + tolerance)
        << "site " << site << " has face " << face << " at " << barycentric.transpose();
  };
  for (std::size_t face = 0; face < diagram.face_sites.size(); ++face)
    if (diagram.face_sites[face] >= 0)
      expect_at(static_cast<std::int32_t>(face), Eigen::Vector3d::Constant(1.0 / 3), diagram.face_sites[face]);
  const std::vector<double> beside = areas_beside_chords(diagram);
  for (const voronoi::DiagramPiece& piece : diagram.pieces) {
    if (beside[static_cast<std::size_t>(piece.site)] > tolerance * mesh.diagonal() || !is_convex(diagram, piece))
      continue;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (int i = 0; i < piece.corner_count; ++i)
      middle += diagram.corners[static_cast<std::size_t>(piece.first_corner + i)] / piece.corner_count;
    expect_at(piece.face, middle, piece.site);
  }
}

/// The distinct places of a diagram's points.
class DiagramPlaces {
 public:
  DiagramPlaces(const voronoi::Diagram& diagram, double same_place) {
    for (const voronoi::DiagramPoint& point : diagram.points) {
      auto same = std::find_if(places_.begin(), places_.end(), [&](const Eigen::Vector3d& place) {
        return (place - point.position).norm() <= same_place;
      });
      number_.push_back(static_cast<std::int32_t>(same - places_.begin()));
      if (same == places_.end()) places_.push_back(point.position);
    }
  }
  std::int32_t of(std::int32_t point) const { return number_[static_cast<std::size_t>(point)]; }
  double length(std::int32_t from, std::int32_t to) const {
    return (places_[static_cast<std::size_t>(to)] - places_[static_cast<std::size_t>(from)]).norm();
  }

 private:
  std::vector<Eigen::Vector3d> places_;
  std::vector<std::int32_t> number_;
};

/// Expects that borders are closed: the loop of the cell on the left of an edge contains each part of it once, and the
/// loop of the cell on the right contains it once in the opposite direction. All other parts of loops are exactly the
/// boundary of the mesh.
inline void expect_closed_loops(const surface::TriangleMesh& mesh, const voronoi::Diagram& diagram, double same_place) {
  using Part = std::array<std::int32_t, 3>;  // site, from, to
  const DiagramPlaces places(diagram, same_place);
  std::multiset<Part> walked;
  for (std::size_t site = 0; site < diagram.cells.size(); ++site) {
    for (const std::vector<std::int32_t>& loop : diagram.cells[site].boundary) {
      int parts = 0;
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const Part part{static_cast<std::int32_t>(site), places.of(loop[i]), places.of(loop[(i + 1) % loop.size()])};
        if (part[1] == part[2]) continue;
        walked.insert(part);
        ++parts;
      }
      EXPECT_GE(parts, 2) << "site " << site << " has a loop of no length";
    }
  }
  const auto expect_walked = [&](const Part& part) {
    const auto found = walked.find(part);
    if (found == walked.end())
      ADD_FAILURE() << "site " << part[0] << " lacks the part from place " << part[1] << " to " << part[2];
    else
      walked.erase(found);
  };
  for (const voronoi::DiagramEdge& edge : diagram.edges) {
    EXPECT_NE(edge.sites[0], edge.sites[1]);
    for (std::size_t i = 1; i < edge.points.size(); ++i) {
      const std::int32_t from = places.of(edge.points[i - 1]);
      const std::int32_t to = places.of(edge.points[i]);
      if (from == to) continue;
      expect_walked({edge.sites[0], from, to});
      expect_walked({edge.sites[1], to, from});
    }
  }
  double left = 0;
  for (const Part& part : walked) left += places.length(part[1], part[2]);
  double boundary = 0;
  for (std::int32_t h = 0; h < mesh.halfedge_count(); ++h)
    if (mesh.twin(h) < 0 && diagram.face_sites[static_cast<std::size_t>(h / 3)] != -2) boundary += mesh.edge_length(h);
  EXPECT_NEAR(left, boundary, 10 * same_place) << "what loops walk besides borders is not the mesh's boundary";
}

/// Expects the number of loops that topology requires: with V vertices in the interior of the surface and E edges that
/// are not closed, the cells' Euler characteristics 2 - 2 handles - loops and V - E add up to that of the surface.
inline void expect_loops_of_topology(const surface::TriangleMesh& mesh, const voronoi::Diagram& diagram) {
  int handles_and_loops = static_cast<int>(diagram.vertices.size());
  for (const voronoi::DiagramEdge& edge : diagram.edges) {
    const bool closed = edge.vertices[0] < 0 && edge.points.front() == edge.points.back();
    if (!closed) --handles_and_loops;
  }
  for (const voronoi::DiagramCell& cell : diagram.cells)
    if (cell.area > 0) handles_and_loops += 2 - static_cast<int>(cell.boundary.size());
  const int twice_handles = handles_and_loops - euler_characteristic(mesh);
  EXPECT_GE(twice_handles, 0) << "more loops than topology allows";
  EXPECT_EQ(twice_handles % 2, 0);
}

/// Expects that points of borders have equal distances from the sites on both sides, and that no other site is nearer.
inline void expect_equidistant(const voronoi::Diagram& diagram, const SiteDistances& distances, double tolerance) {
  for (const voronoi::DiagramPoint& point : diagram.points)
    EXPECT_GE(distances.least(point.point), point.distance - tolerance);
  const auto expect_at = [&](std::int32_t number, std::int32_t site) {
    const voronoi::DiagramPoint& point = diagram.points[static_cast<std::size_t>(number)];
    EXPECT_NEAR(distances.from(site, point.point), point.distance, tolerance)
        << "site " << site << " at " << point.position.transpose();
  };
  for (const voronoi::DiagramEdge& edge : diagram.edges)
    for (const std::int32_t point : edge.points)
      for (const std::int32_t site : edge.sites) expect_at(point, site);
  for (const voronoi::DiagramVertex& vertex : diagram.vertices) {
    EXPECT_GE(vertex.sites.size(), 3U);
    for (const std::int32_t site : vertex.sites) expect_at(vertex.point, site);
  }
}

/// Tolerances of a diagram, relative to the bounding box's diagonal or the total area.
struct DiagramTolerance {
  double distance = 1e-9;
  double area = 1e-12;   ///< for the sum of all cells
  double pieces = 1e-9;  ///< between a cell and its pieces, besides the effect of curved borders
  double place = 1e-9;   ///< distance below which points count as one
};

/// Makes all of the checks above.
inline void expect_valid_diagram(const surface::TriangleMesh& mesh, const voronoi::Diagram& diagram,
                                 const DiagramTolerance& tolerance = {}) {
  const double size = mesh.diagonal();
  const double whole = area_of(mesh);
  double area = diagram.unreached_area;
  for (const voronoi::DiagramCell& cell : diagram.cells) area += cell.area;
  EXPECT_NEAR(area, whole, tolerance.area * whole);
  const std::vector<double> by_pieces = areas_of_pieces(mesh, diagram);
  const std::vector<double> beside = areas_beside_chords(diagram);
  for (std::size_t i = 0; i < by_pieces.size(); ++i)
    EXPECT_NEAR(by_pieces[i], diagram.cells[i].area, tolerance.pieces * whole + beside[i]) << "pieces of site " << i;
  const SiteDistances distances(mesh, diagram.sites);
  expect_nearest_sites(mesh, diagram, distances, tolerance.distance * size);
  expect_equidistant(diagram, distances, tolerance.distance * size);
  expect_closed_loops(mesh, diagram, tolerance.place * size);
  expect_loops_of_topology(mesh, diagram);
}

}  // namespace supple::testing
