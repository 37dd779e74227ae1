#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "border_accuracy.h"
#include "border_line.h"
#include "face_distances.h"
#include "labelled_segment.h"
#include "supple/voronoi/diagram.h"

namespace supple::voronoi {

/// A point that a face adds to the diagram.
struct FacePoint {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< in the plane of the face
  double distance = 0;
  bool vertex = false;
};

/// A part of a border within a face. Its ends are points of the face (>= 0) or cuts of sides: -1 - number, where
/// numbers count the cuts of side 0, then 1, then 2 in the direction of the face's halfedges.
struct FaceBorder {
  std::int32_t from = 0;
  std::int32_t to = 0;
  std::int32_t left = -1;   ///< site on the left of the way from `from` to `to`
  std::int32_t right = -1;  ///< and on the right
  double length = 0;        ///< along the border
};

/// A cell's part of a face.
struct FacePiece {
  std::int32_t site = -1;
  double area = 0;                       ///< with borders as the curves that they are
  std::vector<Eigen::Vector2d> corners;  ///< in the plane of the face, counterclockwise
  /// Indices, ascending, of the corners that only draw an arc. Without them the polygon is the one beside which areas
  /// of FaceSample lie.
  std::vector<std::int32_t> arc_corners;
};

/// A face as it is cut by the cells.
struct CutFace {
  std::vector<FacePoint> points;
  std::vector<FaceBorder> borders;
  std::vector<FacePiece> pieces;
  std::vector<FaceSample> samples;  ///< if asked for
  /// What DiagramFaces works out where it is asked for: of points that are vertices their pulls, ascending by point,
  /// and of the samples.
  std::vector<std::pair<std::int32_t, SitePull>> vertex_pulls;
  std::vector<BorderSample> border_samples;
  std::int64_t subdivisions = 0;
  bool resolved = true;  ///< whether rounding and the limit of divisions left nothing over
};

/// Cuts a face along the lower envelope of the distances in it, given how its sides (from corner i to corner i + 1) are
/// cut.
///
/// A convex polygon is simple where at most two cuts lie on its sides, or three or more of as many cells which meet in
/// one point of it: cells are star-shaped round their sites, so that a cell without a site in the polygon shows on its
/// sides. Any other polygon is divided along a straight line. Polygons below 1e-12 of the face that are still not
/// simple are a Voronoi vertex of all cells that show on their sides.
///
/// A border that is not found between its ends, as one that leaves and comes back next to its beginning, has its
/// polygon divided, too.
///
/// Bends of borders that make no difference to the accuracy are located only with `samples`.
CutFace cut_face(const FaceDistances& distances, const std::array<Eigen::Vector2d, 3>& corners,
                 const std::array<const LabelledSegment*, 3>& sides, bool samples, const BorderAccuracy& accuracy);

}  // namespace supple::voronoi
