#pragma once

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
PathLength mollified_length(const TriangleMesh& mesh, const std::vector<PathPoint>& path, double epsilon);

/// Fills the barycentric derivatives from the tangent ones.
void express_in_barycentrics(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                             GeodesicDerivatives& derivatives);

}  // namespace supple::surface
