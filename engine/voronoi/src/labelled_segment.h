#pragma once

#include <Eigen/Core>
#include <vector>

#include "face_distances.h"

namespace supple::voronoi {

/// A straight segment of a face, cut where the nearest site changes.
struct LabelledSegment {
  std::vector<double> cuts;         ///< shares of the way in [0, 1], ascending
  std::vector<double> distances;    ///< of the cuts from the sites on their sides
  std::vector<std::int32_t> sites;  ///< of the parts, one more than cuts; neighbouring ones differ
};

/// Cuts the segment from `from` to `to` exactly: parts are told apart by what the arrivals can at most grow, and cuts
/// are roots in closed form where one arrival of each site is left. The ends belong to the sites that are given, which
/// is a tie where the arrivals say otherwise: there a cut is at the very end. Where two sites are equally near along
/// the segment, the one before has it. Parts shorter than 1e-13 of the segment may be
/// missed, and longer ones where many sites are almost in one place.
LabelledSegment label_segment(const FaceDistances& distances, const Active& active, const Eigen::Vector2d& from,
                              const Eigen::Vector2d& to, std::int32_t site_at_from, std::int32_t site_at_to);

}  // namespace supple::voronoi
