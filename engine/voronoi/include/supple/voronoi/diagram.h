#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "supple/base/execution.h"
#include "supple/surface/geodesic_solver.h"

namespace supple::voronoi {

/// What distances the diagram is made of.
enum class DiagramMethod {
  exact,    ///< exact geodesic distances
  bounded,  ///< each distance within (1 + relative_error) of exact: fewer windows
  edges     ///< along edges and across pairs of faces: no bound on the error, the cheapest
};

/// The least DiagramOptions::border_deviation, with which an arc has up to a thousand points.
inline constexpr double least_border_deviation = 1e-7;

struct DiagramOptions {
  DiagramMethod method = DiagramMethod::exact;
  /// Of `bounded`: the allowed relative error of every distance, in (0, 1].
  double relative_error = 1e-2;
  /// The largest distance of a border from the straight lines between its points, relative to the mesh's diagonal; from
  /// least_border_deviation to 1.
  double border_deviation = 1e-5;
  // What derivatives need, of `exact` and `bounded` diagrams:
  bool vertex_pulls = false;
  bool border_samples = false;
  bool cell_moments = false;
};

/// The gradient of a place's distance from a site: by the place, in tangent_frame of its face, and by the site's two
/// tangent coordinates, of tangent_frame of its face or, on a vertex, of cone_coordinates.
struct SitePull {
  std::int32_t site = -1;
  double distance = 0;
  Eigen::Vector2d by_place = Eigen::Vector2d::Zero();
  Eigen::Vector2d by_site = Eigen::Vector2d::Zero();
};

/// A point of a border for integrals along it: three for each part of a border within a face (Gauss and Legendre's),
/// and more where it is strongly curved.
struct BorderSample {
  std::array<SitePull, 2> pulls;  ///< of the sites on the left and on the right
  double weight = 0;              ///< length of the border that it stands for
};

/// Integrals over a cell. Where the shortest paths from the site come straight from one image of it, they are exact;
/// what curved borders add is found by quadrature, to some 1e-9 of the whole.
struct CellMoments {
  double squared_distance = 0;  ///< of the squared distance from the site, mesh units to the fourth
  /// Of the distance times its gradient by the site, in the site's tangent coordinates: half the derivative of
  /// squared_distance, because borders, which move too, are as far from the one site as from the other.
  Eigen::Vector2d pull = Eigen::Vector2d::Zero();
};

/// A point of the cells' borders. Borders are arcs of hyperbolas, with bends within faces where two shortest paths lead
/// to one site. Between two successive points of a border it lies in one face, does not bend visibly, and is no farther
/// from the straight line than DiagramOptions::border_deviation.
struct DiagramPoint {
  enum class Kind : std::uint8_t {
    vertex,    ///< a Voronoi vertex: three or more cells meet
    crossing,  ///< a border crosses an edge of the mesh: two cells meet
    inner,     ///< another point of a border within a face: two cells meet
    rim        ///< a vertex of the mesh's boundary, which closes cells there: one cell
  };
  Kind kind = Kind::crossing;
  surface::SurfacePoint point;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double distance = 0;  ///< to each of its sites, mesh units
};

/// A Voronoi vertex.
struct DiagramVertex {
  std::int32_t point = -1;  ///< index into Diagram::points
  std::vector<std::int32_t>
      sites;  ///< three or more, counterclockwise seen from outside; one twice where a cell meets itself
};

/// A Voronoi edge: the border of two cells between two Voronoi vertices, or a border without any, which is closed or
/// ends on the mesh's boundary.
struct DiagramEdge {
  std::array<std::int32_t, 2> sites{-1, -1};  ///< on the left and on the right of the way along `points`
  std::array<std::int32_t, 2> vertices{
      -1, -1};  ///< indices into Diagram::vertices; -1 where it ends at the boundary or is closed
  std::vector<std::int32_t>
      points;         ///< indices into Diagram::points, two or more; of a closed one the first is the last
  double length = 0;  ///< along the border, mesh units
};

/// The points of the surface that are nearer to one site than to any other.
struct DiagramCell {
  double area = 0;  ///< squared mesh units, borders taken as the curves that they are
  /// Closed borders, each a list of indices into Diagram::points with the cell on the left, the first not repeated:
  /// none where the cell is a whole component, several where it has holes or wraps a handle.
  std::vector<std::vector<std::int32_t>> boundary;
  /// Indices into Diagram::vertices, in the order in which the boundary meets them, border by border.
  std::vector<std::int32_t> vertices;
  std::vector<std::int32_t> neighbours;  ///< sites whose cells share a border with this one, ascending
};

/// A cell's part of a face: a polygon in it, whose sides along borders have the borders' points.
struct DiagramPiece {
  std::int32_t site = -1;
  std::int32_t face = -1;
  std::int32_t first_corner = 0;  ///< of its corners in Diagram::corners, counterclockwise
  std::int32_t corner_count = 0;
  double area = 0;  ///< squared mesh units, borders taken as the curves that they are
};

/// A geodesic Voronoi diagram (thesis eq. 3.23, 3.24).
struct Diagram {
  std::vector<surface::SurfacePoint> sites;
  std::vector<DiagramPoint> points;
  std::vector<DiagramVertex> vertices;
  std::vector<DiagramEdge> edges;
  std::vector<DiagramCell> cells;  ///< one for each site
  /// Triangles of sites, counterclockwise: of each Voronoi vertex its sites, more than three as a fan. The intrinsic
  /// Delaunay triangulation where the cells are discs and meet in one border each.
  std::vector<std::array<std::int32_t, 3>> dual;
  /// The site of each vertex of the mesh: the nearest, of several one; -1 where no path leads to one.
  std::vector<std::int32_t> vertex_sites;
  /// Faces that more than one cell has a part of are cut into pieces; all other faces belong to one.
  std::vector<std::int32_t> face_sites;  ///< of each face the site, -1 if it is cut, -2 where no path leads to one
  std::vector<DiagramPiece> pieces;      ///< of cut faces, ascending by face
  std::vector<Eigen::Vector3d> corners;  ///< barycentric coordinates in the piece's face
  /// Of each vertex the pulls of its sites, one vertex after the other; of site -1 where one is not known. Empty unless
  /// asked for.
  std::vector<SitePull> vertex_pulls;
  std::vector<BorderSample> border_samples;  ///< empty unless asked for
  std::vector<CellMoments> cell_moments;     ///< of each cell; empty unless asked for
  double unreached_area = 0;                 ///< of components without a site
  /// What deserves attention, one sentence each: sites in one place, components without a site.
  std::vector<std::string> warnings;
};

/// The diagram of one or more sites. One propagation from all sites at once, in which the windows of each die soon
/// after they have left its cell; then each face is cut along the lower envelope of the distances that reach it, in
/// parallel. Equidistance holds to rounding (1e-12 of the mesh's size; `exact`). Along a segment a site does not take
/// over from another where it is nearer by no more than 1e-13 of the distance.
///
/// Where several sites are in one place, the first has the cell and the others' are empty. Where whole regions are
/// equally near to two sites (behind a saddle vertex that lies on a border), one of them has the region.
///
/// Bills the stages "propagation" and "cells" and the quantities "windows", "cut_faces" and "subdivisions". Throws
/// "voronoi.no_sites", "voronoi.too_many_sites" (more than a million), "voronoi.invalid_option" and what
/// surface::checked_point throws (where = "sites/3").
Diagram diagram(const surface::GeodesicSolver& solver, std::span<const surface::SurfacePoint> sites,
                const DiagramOptions& options = {}, const Execution& execution = {});

/// Random sites, spread evenly over the area. The same seed gives the same sites. Throws "voronoi.no_sites" (count
/// below 1) and "voronoi.too_many_sites".
std::vector<surface::SurfacePoint> random_sites(const surface::TriangleMesh& mesh, std::int64_t count,
                                                std::uint64_t seed = 1);

/// What is asked about a diagram as a design: over all Voronoi edges between two vertices, cells and vertices.
struct DiagramStatistics {
  struct Spread {
    double mean = 0;
    double least = 0;
    double greatest = 0;
    double deviation = 0;  ///< standard deviation
  };
  Spread edge_length;      ///< geodesic distance between the vertices of an edge, mesh units
  Spread planarity;        ///< distance of a cell's vertices from the plane that fits them best, mesh units
  Spread area;             ///< of cells, squared mesh units
  Spread vertex_distance;  ///< distance of a cell's vertices from its site over the mean of the cell, 1 where regular
};
DiagramStatistics statistics(const surface::GeodesicSolver& solver, const Diagram& diagram,
                             const Execution& execution = {});

}  // namespace supple::voronoi
