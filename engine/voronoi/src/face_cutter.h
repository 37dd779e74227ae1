#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "border_accuracy.h"
#include "border_polyline.h"
#include "face_distances.h"
#include "labelled_segment.h"
#include "supple/voronoi/diagram.h"

namespace supple::voronoi {

/// A point inside a face that the face adds to the diagram.
struct FacePoint {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< in the plane of the face
  double distance = 0;
  bool vertex = false;  ///< whether it is a Voronoi vertex
};

/// A part of a border within a face. An end is the index of a point of the face, or -1 - (number of a cut). Cuts are
/// numbered from side 0 to side 2, along each side in the direction of the face's halfedges.
struct FaceBorder {
  std::int32_t from = 0;
  std::int32_t to = 0;
  std::int32_t left = -1;   ///< site on the left in the direction from `from` to `to`
  std::int32_t right = -1;  ///< site on the right
  double length = 0;        ///< along the border
};

/// A cell's part of a face.
struct FacePiece {
  std::int32_t site = -1;
  double area = 0;                       ///< with curved borders, squared mesh units
  std::vector<Eigen::Vector2d> corners;  ///< in the plane of the face, counterclockwise
  /// Indices, ascending, of the corners that only draw an arc. The areas of FaceSample are relative to the polygon
  /// without them.
  std::vector<std::int32_t> arc_corners;
};

/// A face that several cells have a part of.
struct CutFace {
  std::vector<FacePoint> points;
  std::vector<FaceBorder> borders;
  std::vector<FacePiece> pieces;
  std::vector<FaceSample> samples;  ///< empty unless requested
  /// DiagramFaces fills these on request: distance gradients of the Voronoi vertices, as pairs of a point and a
  /// gradient, ascending by point, and of the samples.
  std::vector<std::pair<std::int32_t, SiteDistanceGradient>> vertex_gradients;
  std::vector<BorderSample> border_samples;
  std::int64_t subdivisions = 0;
  bool resolved =
      true;  ///< false if some polygons could not be resolved, because of rounding or the limit of divisions
};

/// Cuts a face along the lower envelope of the distances in it. `sides` are the cuts of its sides, from corner i to
/// corner i + 1.
///
/// A convex polygon is simple if at most two cuts lie on its sides, or if three or more cells meet in one point of it
/// and each begins at one cut. Cells are star-shaped around their sites: a cell without a site in the polygon reaches
/// its sides. Every other polygon is divided along a straight line. A polygon below 1e-12 of the face that is still not
/// simple is taken as a Voronoi vertex of all cells on its sides.
///
/// A polygon is also divided if a border in it cannot be traced, such as one that leaves the polygon and returns.
///
/// Bends that do not matter for the accuracy are located only with `samples`.
CutFace cut_face(const FaceDistances& distances, const std::array<Eigen::Vector2d, 3>& corners,
                 const std::array<const LabelledSegment*, 3>& sides, bool samples, const BorderAccuracy& accuracy);

}  // namespace supple::voronoi
