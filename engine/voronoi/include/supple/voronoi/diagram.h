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

/// The distances that the diagram is computed from.
enum class DiagramMethod {
  exact,    ///< exact geodesic distances
  bounded,  ///< each distance at most (1 + relative_error) times the exact one, with fewer windows
  edges     ///< paths along edges and across pairs of faces: cheapest, without a bound on the error
};

/// Minimum of DiagramOptions::border_deviation; at this value an arc has up to a thousand points.
inline constexpr double min_border_deviation = 1e-7;

struct DiagramOptions {
  DiagramMethod method = DiagramMethod::exact;
  /// Allowed relative error of every distance for the method `bounded`, in (0, 1].
  double relative_error = 1e-2;
  /// Maximum distance between a border and the polyline through its points, relative to the diagonal of the mesh's
  /// bounding box; from min_border_deviation to 1.
  double border_deviation = 1e-5;
  // Whether the diagram gets the member of the same name, which derivatives need. The method `edges` ignores them.
  bool vertex_gradients = false;
  bool border_samples = false;
  bool cell_moments = false;
};

/// Distance of a point from a site, and its gradients. The gradient by the point is in tangent_frame of the point's
/// face. The gradient by the site is in tangent_frame of the site's face or, for a site on a vertex, in
/// cone_coordinates.
struct SiteDistanceGradient {
  std::int32_t site = -1;
  double distance = 0;
  Eigen::Vector2d by_place = Eigen::Vector2d::Zero();
  Eigen::Vector2d by_site = Eigen::Vector2d::Zero();
};

/// Gauss-Legendre quadrature point on a border. Each part of a border within a face has three of them, and more where
/// it is strongly curved.
struct BorderSample {
  std::array<SiteDistanceGradient, 2> gradients;  ///< distance gradients of the sites on the left and on the right
  double weight = 0;                              ///< quadrature weight: a length, mesh units
};

/// Integrals over a cell. They are exact where the shortest paths come straight from one unfolded image of the site.
/// The contribution of curved borders is found by quadrature, to about 1e-9 of the whole integral.
struct CellMoments {
  double squared_distance = 0;  ///< integral of the squared distance from the site, mesh units to the fourth power
  /// Integral of the distance times its gradient by the site, in the site's tangent coordinates: half the derivative of
  /// squared_distance. Moving borders contribute nothing to it, because a border is equally far from both of its sites.
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
};

/// A point of the cells' borders. Borders consist of arcs of hyperbolas. They have bends within faces, where two
/// shortest paths lead to one of the sites. Between two successive points a border lies in one face, has no visible
/// bend, and is no farther from the straight line than DiagramOptions::border_deviation.
struct DiagramPoint {
  enum class Kind : std::uint8_t {
    vertex,    ///< a Voronoi vertex: three or more cells meet
    crossing,  ///< a border crosses an edge of the mesh: two cells meet
    inner,     ///< another point of a border within a face: two cells meet
    boundary   ///< a vertex of the mesh's boundary, along which a cell closes: one cell
  };
  Kind kind = Kind::crossing;
  surface::SurfacePoint point;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double distance = 0;  ///< equal for all of its sites, mesh units
};

/// A Voronoi vertex.
struct DiagramVertex {
  std::int32_t point = -1;  ///< index into Diagram::points
  /// Three or more, counterclockwise seen from outside. A cell that meets itself there occurs twice.
  std::vector<std::int32_t> sites;
};

/// A Voronoi edge: the border of two cells between two Voronoi vertices. A border without Voronoi vertices is an edge
/// too; it is closed or ends on the mesh's boundary.
struct DiagramEdge {
  std::array<std::int32_t, 2> sites{-1, -1};  ///< on the left and on the right in the direction of `points`
  /// Indices into Diagram::vertices; -1 where the edge ends at the mesh's boundary or is closed.
  std::array<std::int32_t, 2> vertices{-1, -1};
  /// Indices into Diagram::points, two or more; a closed edge repeats its first point at its end.
  std::vector<std::int32_t> points;
  double length = 0;  ///< along the border, mesh units
};

/// The points of the surface that are nearer to one site than to any other.
struct DiagramCell {
  double area = 0;  ///< squared mesh units, within the curved borders
  /// Closed boundary curves, each a list of indices into Diagram::points with the cell on its left; the first point is
  /// not repeated. There is none where the cell is a whole component, and there are several where it has holes or wraps
  /// a handle.
  std::vector<std::vector<std::int32_t>> boundary;
  /// Indices into Diagram::vertices, in the order in which the boundary curves meet them, curve by curve.
  std::vector<std::int32_t> vertices;
  std::vector<std::int32_t> neighbours;  ///< sites whose cells share a border with this one, ascending
};

/// A cell's part of a face, as a polygon. Its sides along borders go through the borders' points.
struct DiagramPiece {
  std::int32_t site = -1;
  std::int32_t face = -1;
  std::int32_t first_corner = 0;  ///< index of its first corner in Diagram::corners; corners are counterclockwise
  std::int32_t corner_count = 0;
  double area = 0;  ///< squared mesh units, within the curved borders
};

/// A geodesic Voronoi diagram [Thesis, eq. 3.23 and 3.24].
struct Diagram {
  std::vector<surface::SurfacePoint> sites;
  std::vector<DiagramPoint> points;
  std::vector<DiagramVertex> vertices;
  std::vector<DiagramEdge> edges;
  std::vector<DiagramCell> cells;  ///< one for each site
  /// Triangles of sites, counterclockwise: one for each Voronoi vertex, or a fan where more than three cells meet. This
  /// is the intrinsic Delaunay triangulation if the cells are discs and any two share at most one border.
  std::vector<std::array<std::int32_t, 3>> dual;
  /// Nearest site of each vertex of the mesh, or one of them if there are several; -1 where no path leads to a site.
  std::vector<std::int32_t> vertex_sites;
  /// Faces that several cells have a part of are cut into pieces. Every other face belongs to one site.
  std::vector<std::int32_t> face_sites;  ///< site of each face; -1 if the face is cut, -2 if no path leads to a site
  std::vector<DiagramPiece> pieces;      ///< pieces of the cut faces, ascending by face
  std::vector<Eigen::Vector3d> corners;  ///< corners of the pieces: barycentric coordinates in their faces
  /// Distance gradients at the Voronoi vertices, one for each entry of DiagramVertex::sites, vertex by vertex. An entry
  /// that is not available has the site -1. Empty unless requested.
  std::vector<SiteDistanceGradient> vertex_gradients;
  std::vector<BorderSample> border_samples;  ///< empty unless requested
  std::vector<CellMoments> cell_moments;     ///< for each cell; empty unless requested
  double unreached_area = 0;                 ///< area of the components without a site, squared mesh units
  /// Warnings, one sentence each: coincident sites, components without a site.
  std::vector<std::string> warnings;
};

/// Computes the diagram of one or more sites. Windows are propagated from all sites at once, and the windows of a site
/// end soon after they have left its cell. Then each face is cut along the lower envelope of the distances that reach
/// it, in parallel. With `exact`, border points are equidistant from their sites to rounding (1e-12 of the mesh's
/// size). Where two sites are equally near along a segment up to 1e-13 of the distance, the segment belongs to one of
/// them and is not divided.
///
/// If several sites coincide, the first has the cell and the others' cells are empty. Where a whole region is equally
/// near to two sites (behind a saddle vertex that lies on a border), one of them has all of it.
///
/// Bills the stages "propagation" and "cells" and the quantities "windows", "cut_faces" and "subdivisions". Throws
/// "voronoi.no_sites", "voronoi.too_many_sites" (more than a million), "voronoi.invalid_option" and what
/// surface::checked_point throws (where = "sites/3").
Diagram diagram(const surface::GeodesicSolver& solver, std::span<const surface::SurfacePoint> sites,
                const DiagramOptions& options = {}, const Execution& execution = {});

/// Random sites, uniformly distributed over the area. The same seed gives the same sites. Throws "voronoi.no_sites"
/// (count below 1) and "voronoi.too_many_sites".
std::vector<surface::SurfacePoint> random_sites(const surface::TriangleMesh& mesh, std::int64_t count,
                                                std::uint64_t seed = 1);

/// Statistics of a diagram over all Voronoi edges between two vertices, all cells and all vertices of cells.
struct DiagramStatistics {
  struct Spread {
    double mean = 0;
    double least = 0;
    double greatest = 0;
    double deviation = 0;  ///< standard deviation
  };
  Spread edge_length;      ///< geodesic distance between the vertices of an edge, mesh units
  Spread planarity;        ///< distance of a cell's vertices from the plane that fits them best, mesh units
  Spread area;             ///< area of cells, squared mesh units
  Spread vertex_distance;  ///< distance of a cell's vertices from its site over the cell's mean; 1 if regular
};
DiagramStatistics statistics(const surface::GeodesicSolver& solver, const Diagram& diagram,
                             const Execution& execution = {});

}  // namespace supple::voronoi
