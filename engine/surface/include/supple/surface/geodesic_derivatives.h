#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "supple/surface/geodesic.h"

namespace supple::surface {

/// The mollifier of [Thesis, eq. 3.12]. It is t at a distance of at least `epsilon` from 0 and 1, and a cubic blend
/// with zero slope at 0 and 1 nearer to them. It is C1 on [0, 1]. Needs 0 < epsilon <= 0.5.
struct Mollified {
  double value;
  double slope;
  double curvature;
};
Mollified mollify(double t, double epsilon);

/// A path's length and its derivatives.
struct PathLength {
  double length = 0;
  GeodesicDerivatives derivatives;
};

/// Computes the length of a shortest path and its first and second derivatives from the path alone, by implicit
/// differentiation of the conditions that make it shortest [Thesis, eq. 3.7 to 3.11].
///
/// The system of the crossings is symmetric and tridiagonal, so that this takes O(points). `path` starts and ends at
/// the ends and holds every edge crossing. Vertices that it passes stay where they are. The result agrees with the
/// closed forms of Geodesic::derivatives.
PathLength path_length(const TriangleMesh& mesh, const std::vector<PathPoint>& path);

/// Computes the length of a shortest path whose edge crossings t are replaced by mollified ones, with its exact first
/// and second derivatives. Needs 0 < epsilon <= 0.5. `path` is complete, as for path_length.
///
/// Mollified crossings do not make the length least. Therefore the motion of the crossings with the ends counts here,
/// to second order, while [Thesis, eq. 3.6] leaves it out. Between vertices the path is straight in unfolded faces,
/// which gives t and its derivatives in closed form. O(points).
///
/// With `ends` the mollifier also acts on the barycentric coordinates w of both ends (the paragraph before
/// [Thesis, eq. 3.12]). With the mollifier m, the path then begins and ends at sum m(w_i) v_i / sum m(w_i). The
/// division, which [Thesis] does not have, keeps the point in its face. At an end on an edge, the derivative towards
/// the opposite corner then vanishes. The Hessian jumps by 2 / epsilon times the gradient where a coordinate passes
/// epsilon. Minimizers therefore converge to points of edges that are no equilibria, which is why `ends` is off by
/// default. Numbers are in docs/notes/geodesics.md.
PathLength mollified_length(const TriangleMesh& mesh, const std::vector<PathPoint>& path, double epsilon,
                            bool ends = false);

/// The length of a shortest path, and its derivatives with respect to its ends and to the vertices of the surface.
///
/// The variables are the three barycentric coordinates of the first end and the three of the second, as in
/// GeodesicDerivatives, then x, y and z of each of `vertices`. The ends are material points: their barycentric
/// coordinates stay the same while vertices move, c = sum of w_i v_i. Only variations of barycentric coordinates that
/// sum to zero at either end stay on the surface; for them, and for all motions of vertices, these are the derivatives.
/// Units: mesh units per barycentric coordinate, 1 for vertices, and their quotients.
struct HostDerivatives {
  double length = 0;                   ///< mesh units
  std::vector<std::int32_t> vertices;  ///< vertices of every face that the path passes, ascending, each once
  Eigen::VectorXd gradient;            ///< 6 + 3 vertices.size() entries
  Eigen::MatrixXd hessian;             ///< a square of that size, symmetric; empty for order 1
};

/// Computes the first and, for `order` 2, second derivatives of the length of a shortest path on a surface whose
/// vertices move [Thesis, eq. 3.21, appendix A.1 to A.19]. `path` is complete, as for path_length. A path of length
/// zero has no derivatives, and zeros are returned for it.
///
/// Vertices that bend the path (saddle and boundary vertices) stay on it as they move. Where it runs straight through
/// another vertex, these are the derivatives on one side of it. If an end lies on an edge or a vertex, they are the
/// derivatives into the face in which the end is given.
///
/// The crossings' parameters t are eliminated from their symmetric tridiagonal system [Thesis, eq. A.13 to A.17] in
/// closed form. In unfolded faces, the crossings move across the path like beads on a taut string of length L, whose
/// compliance between arc lengths p <= q is p (L - q) / L. Unlike the system itself, this stays well conditioned if
/// segments are short or edges are nearly parallel to the path. With m segments, the gradient takes O(m) and the
/// Hessian O(m^2), which is its size.
HostDerivatives host_derivatives(const TriangleMesh& mesh, const std::vector<PathPoint>& path, int order = 2);

/// Computes a positive semidefinite matrix near the Hessian of host_derivatives, in the same variables. Without it, a
/// convex model of the length would not resist steps that bend the path sideways. The matrix consists of the second
/// derivatives of the segments' lengths with respect to the positions of their ends. These positions are linear
/// functions of all variables, and the crossings minimize the sum. The matrix neglects that the weights of an edge's
/// vertices in the position of a crossing change when the crossing moves along the edge. `vertices` and its order are
/// those of host_derivatives. O(m^3) for m segments.
Eigen::MatrixXd convex_host_hessian(const TriangleMesh& mesh, const std::vector<PathPoint>& path,
                                    const std::vector<std::int32_t>& vertices);

/// Computes the barycentric derivatives from the tangent derivatives.
void express_in_barycentrics(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                             GeodesicDerivatives& derivatives);

}  // namespace supple::surface
