#pragma once

#include <Eigen/Core>

#include "supple/base/error.h"
#include "supple/base/ids.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

/// A point of the surface: a face and barycentric coordinates in it, which are nonnegative and whose sum is 1. A point
/// on an edge or a vertex may be written in any face that contains it.
struct SurfacePoint {
  FaceId face = FaceId::none;
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
};

/// A point that does not lie on the mesh, or a vertex or face that the mesh does not have. Its code begins with
/// "point.".
class PointError : public Error {
 public:
  using Error::Error;
};

/// The vertex as a point of one of its faces. Throws "point.vertex_out_of_range" or "point.isolated_vertex".
SurfacePoint vertex_point(const TriangleMesh& mesh, VertexId v);

/// Checks face and barycentric coordinates. Returns the point with coordinates clamped to [0, 1], whose sum is 1 up to
/// rounding. Throws "point.face_out_of_range", "point.non_finite", or "point.outside_face" if a coordinate is below
/// -1e-5 or their sum differs from 1 by more than 1e-5. `where` names the point in the error ("pairs/3/from").
SurfacePoint checked_point(const TriangleMesh& mesh, const SurfacePoint& point, const std::string& where = "point");

Eigen::Vector3d position(const TriangleMesh& mesh, const SurfacePoint& point);

/// The corner (0, 1, 2) of its face on which the point lies exactly, or -1.
int corner_of(const SurfacePoint& point);
/// The side i of its face (halfedge 3 f + i) in whose interior the point lies exactly, or -1.
int side_of(const SurfacePoint& point);

/// The orthonormal frame of a face in space. Column 0 lies along the face's first halfedge, and column 1 is turned by
/// +90 degrees within the face. Tangent vectors of the face have two coordinates in this frame.
Eigen::Matrix<double, 3, 2> tangent_frame(const TriangleMesh& mesh, FaceId face);

}  // namespace supple::surface
