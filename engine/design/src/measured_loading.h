#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

// Which points of a test belong to its first loading, before it broke.
namespace supple::design {

using MeasuredPoints = std::vector<Eigen::Vector2d>;

/// This fraction of the strain's range decides whether a strain turns back, and whether a curve begins at the origin.
inline constexpr double noticeable_fraction = 0.05;

/// How far the strain falls back below its greatest value so far, at most, as a fraction of its range; of a compression
/// with the strain's sign turned, so that a strain that only falls does not turn back either.
double turning_back(const MeasuredPoints& points);

/// The points of first loadings in their order: those whose strain lies beyond all that was reached before the strain
/// last turned back noticeably. A rubber that was stretched before is softer up to that strain and follows its virgin
/// curve beyond it (Mullins), so that cycles of growing strain give the virgin curve. Strains that shake by less than
/// that are kept. A test that begins with an unloading counts from where the strain was least. O(points).
MeasuredPoints first_loadings(const MeasuredPoints& points);

/// How many of the last points follow a break: the size of the stress falls within four points from half of its
/// greatest value to a fifth of it and stays below the half, while the strain does not turn back. 0 without a break.
std::size_t points_after_rupture(const MeasuredPoints& points);

}  // namespace supple::design
