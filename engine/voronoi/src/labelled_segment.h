#pragma once

#include <Eigen/Core>
#include <vector>

#include "face_distances.h"

namespace supple::voronoi {

/// A straight segment in a face, cut where the nearest site changes.
struct LabelledSegment {
  std::vector<double> cuts;         ///< fractions of the segment in [0, 1], ascending
  std::vector<double> distances;    ///< distances of the cuts from the sites on both sides
  std::vector<std::int32_t> sites;  ///< sites of the parts, one more than cuts; successive ones differ
};

/// Cuts the segment from `from` to `to`. Bounds of growth exclude arrivals in parts of it. Where few are left, the cuts
/// are roots in closed form. The ends belong to the given sites. If the arrivals say otherwise, this is a tie, and a
/// cut lies at the end itself. Where two sites are equally near along the segment, the preceding one has it. Parts
/// shorter than 1e-13 of the segment may be missed, and longer ones where many sites nearly coincide.
LabelledSegment label_segment(const FaceDistances& distances, const Active& active, const Eigen::Vector2d& from,
                              const Eigen::Vector2d& to, std::int32_t site_at_from, std::int32_t site_at_to);

}  // namespace supple::voronoi
