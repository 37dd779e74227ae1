#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

// The points of a test that belong to its first loading, before the specimen broke.
namespace supple::design {

using MeasuredPoints = std::vector<Eigen::Vector2d>;

/// Fraction of the strain's range above which a decrease of the strain counts as a reversal. It also decides whether a
/// curve begins at the origin.
inline constexpr double noticeable_fraction = 0.05;

/// The largest decrease of the strain below its previous maximum, as a fraction of the strain's range. It is the
/// smaller one of the values for the strain and for the negative strain, so that a monotone strain has no reversal in
/// either direction.
double reversal(const MeasuredPoints& points);

/// The points of first loadings in their order: those whose strain exceeds all strains before the last reversal. After
/// a reversal a rubber is softer up to the strain that it has reached before, and follows its virgin curve beyond
/// (Mullins effect). Cycles of growing strain therefore give the virgin curve. Decreases of the strain that are smaller
/// than a reversal are noise, and their points are retained. A test that begins with an unloading counts from the least
/// strain on. O(points).
MeasuredPoints first_loadings(const MeasuredPoints& points);

/// The number of points after a rupture, 0 without one. At a rupture the magnitude of the stress falls within four
/// points from half of its maximum to below a fifth of it, and it stays below half. The strain does not reverse
/// meanwhile.
std::size_t points_after_rupture(const MeasuredPoints& points);

}  // namespace supple::design
