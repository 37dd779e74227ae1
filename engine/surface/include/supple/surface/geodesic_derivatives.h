#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "supple/surface/geodesic.h"

namespace supple::surface {

/// The mollifier of thesis eq. 3.12: t at least `epsilon` from 0 and 1, a cubic blend nearer, with zero slope at 0
/// and 1. C1 on [0, 1]. Needs 0 < epsilon <= 0.5.
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

/// First and second derivatives of a shortest path's length from the path alone, by implicit differentiation of the
/// conditions that make it shortest (thesis eq. 3.7 to 3.11).
///
/// The crossings' system is symmetric tridiagonal: O(points). `path` starts and ends at the ends and holds every edge
/// crossing; vertices that it passes stay where they are. Agrees with the closed forms of Geodesic::derivatives.
PathLength path_length(const TriangleMesh& mesh, const std::vector<PathPoint>& path);

/// The length of a shortest path whose crossings t of edges are replaced by mollified ones, with its exact first and
/// second derivatives. Needs 0 < epsilon <= 0.5; `path` as for path_length, in full.
///
/// Mollified crossings do not make the length least, so that what the thesis leaves out because of that (eq. 3.6)
/// counts here: the motion of the crossings with the ends, to second order. Between vertices the path is straight in
/// unfolded faces, which gives t and its derivatives in closed form. O(points).
///
/// With `ends` the mollifier acts on the barycentric coordinates w of both ends as well (the paragraph before thesis
/// eq. 3.12): the path then begins and ends at sum m(w_i) v_i / sum m(w_i), m the mollifier. The division, which the
/// thesis does not have, keeps the point in its face. An end that lies on an edge then feels no pull off it, towards
/// the corner opposite, whatever pulls, and the Hessian jumps by 2 / epsilon of the gradient where a coordinate passes
/// epsilon: minimizers stop at edges that are no equilibria. Hence off; numbers are in
/// docs/bench/geodesics-mollifier.md.
PathLength mollified_length(const TriangleMesh& mesh, const std::vector<PathPoint>& path, double epsilon,
                            bool ends = false);

/// A shortest path's length and its derivatives by its ends and by the vertices of the surface that carries it.
///
/// The variables are the three barycentric coordinates of the first end and the three of the second, as in
/// GeodesicDerivatives, then x, y and z of each of `vertices`. The ends are material: their barycentric coordinates
/// stay what they are while vertices move, c = sum of w_i v_i. Only variations of barycentric coordinates that sum to
/// zero at either end stay on the surface; for them, and for all motions of vertices, these are the derivatives.
/// Units: mesh units per barycentric coordinate, 1 for vertices, and their quotients.
struct HostDerivatives {
  double length = 0;                   ///< mesh units
  std::vector<std::int32_t> vertices;  ///< of every face that the path passes, ascending, each once
  Eigen::VectorXd gradient;            ///< 6 + 3 vertices
  Eigen::MatrixXd hessian;             ///< square of that size, symmetric; empty for order 1
};

/// First and, for `order` 2, second derivatives of a shortest path's length on a surface whose vertices move: thesis
/// eq. 3.21 and appendix A.1 to A.19. `path` as for path_length, in full; a path of length zero has no derivatives,
/// and gets ones of zero.
///
/// Vertices that bend the path (saddle and boundary vertices) stay on it as they move. Where it runs straight through
/// another vertex, these are the derivatives on one side of it, and where an end lies on an edge or a vertex, those
/// into the face that the end names.
///
/// The crossings' parameters t are eliminated through their symmetric tridiagonal system (eq. A.13 to A.17) in closed
/// form: in unfolded faces the motions of the crossings across the path are those of beads on a taut string, whose
/// compliance between arc lengths p <= q of L is p (L - q) / L. Unlike the system itself this stays well conditioned
/// where segments are short or edges nearly parallel to the path. With m segments: O(m) for the gradient, O(m^2) for
/// the Hessian, the size of what is returned.
HostDerivatives host_derivatives(const TriangleMesh& mesh, const std::vector<PathPoint>& path, int order = 2);

/// A positive semidefinite matrix near the Hessian of host_derivatives, in the same variables, without which nothing
/// stops a step that bends a path sideways: the second derivatives of the segments' lengths by the places of their
/// ends, with these as linear functions of all variables, and the crossings where they make the sum least. What is left
/// out is that a crossing which moves along its edge turns it another share of the way. `vertices` and its order are
/// those of host_derivatives. O(m^3) for m segments.
Eigen::MatrixXd convex_host_hessian(const TriangleMesh& mesh, const std::vector<PathPoint>& path,
                                    const std::vector<std::int32_t>& vertices);

/// Fills the barycentric derivatives from the tangent ones.
void express_in_barycentrics(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                             GeodesicDerivatives& derivatives);

}  // namespace supple::surface
