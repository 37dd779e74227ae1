#include "bisector_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "equal_length_roots.h"
#include "planar_cross.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;
using surface::FaceArrival;

/// Relative to the face: sigmas (distances of images from their sites) that differ by less are equal, and images closer
/// than this coincide.
constexpr double sigma_tolerance = 1e-12;
constexpr double image_tolerance = 1e-9;
/// With more images, the general method finds the envelope.
constexpr std::size_t max_bisector_images = 64;
/// Radians: bundles of paths from one image with a narrower gap between them are adjacent.
constexpr double min_bundle_gap = 1e-11;

/// Whether |x - far| - |x - near| falls below -gain, gain > 0, between two places at which it is not below.
bool falls_below(const Vector2d& far, const Vector2d& near, double gain, const Vector2d& from, const Vector2d& to) {
  const LineRoots roots = equal_length_roots(near, far, gain, from, to - from);
  return std::any_of(roots.fractions.begin(), roots.fractions.begin() + static_cast<std::ptrdiff_t>(roots.count),
                     [](double fraction) { return fraction > 0 && fraction < 1; });
}

}  // namespace

bool BisectorCells::gather_images(const FaceDistances& distances, const Active& active, double size) {
  const auto& arrivals = distances.arrivals();
  sigma_ = std::numeric_limits<double>::infinity();
  for (const std::int32_t i : active) sigma_ = std::min(sigma_, arrivals[static_cast<std::size_t>(i)].sigma);
  images_.clear();
  image_arrivals_.clear();
  image_of_arrival_.clear();
  farther_.clear();
  const double squared_tolerance = image_tolerance * image_tolerance * size * size;
  for (const std::int32_t i : active) {
    const FaceArrival& arrival = arrivals[static_cast<std::size_t>(i)];
    if (arrival.sigma > sigma_ + sigma_tolerance * size) {
      farther_.push_back(i);
    } else {
      image_arrivals_.push_back(i);
    }
  }
  // The order must not depend on that of the arrivals: recomputing a few faces has to give the same diagram.
  std::sort(image_arrivals_.begin(), image_arrivals_.end(), [&](std::int32_t i, std::int32_t j) {
    const FaceArrival& a = arrivals[static_cast<std::size_t>(i)];
    const FaceArrival& b = arrivals[static_cast<std::size_t>(j)];
    if (a.source != b.source) return a.source < b.source;
    return a.image.x() != b.image.x() ? a.image.x() < b.image.x() : a.image.y() < b.image.y();
  });
  for (const std::int32_t i : image_arrivals_) {
    const FaceArrival& arrival = arrivals[static_cast<std::size_t>(i)];
    std::size_t image = 0;
    while (image < images_.size() && !((images_[image].place - arrival.image).squaredNorm() <= squared_tolerance))
      ++image;
    if (image == images_.size()) {
      if (image == max_bisector_images) return false;
      images_.push_back({arrival.image, arrival.source});
    } else if (images_[image].site != arrival.source) {
      return false;
    }
    image_of_arrival_.push_back(static_cast<std::int32_t>(image));
  }
  return true;
}

bool BisectorCells::clip_cell(std::size_t image, std::span<const Vector2d> polygon) {
  Cell& cell = cells_[image];
  cell.count = polygon.size();
  for (std::size_t side = 0; side < polygon.size(); ++side)
    cell.corners[side] = {polygon[side], -1 - static_cast<std::int32_t>(side)};
  const Vector2d& own = images_[image].place;
  Cell clipped;
  for (std::size_t other = 0; other < images_.size() && cell.count > 0; ++other) {
    if (other == image) continue;
    // The two cells of a bisector compute the same numbers but for their sign.
    const Vector2d normal = images_[other].place - own;
    const double offset = 0.5 * normal.dot(images_[other].place + own);
    std::array<double, Cell::max_corners> bisector_value;
    bool any = false;
    for (std::size_t i = 0; i < cell.count; ++i) {
      bisector_value[i] = normal.dot(cell.corners[i].place) - offset;
      any = any || bisector_value[i] > 0;
    }
    if (!any) continue;
    clipped.count = 0;
    for (std::size_t i = 0; i < cell.count; ++i) {
      const std::size_t next = i + 1 < cell.count ? i + 1 : 0;
      if (clipped.count + 2 > Cell::max_corners) return false;
      const Corner& corner = cell.corners[i];
      if (bisector_value[i] <= 0) {
        clipped.corners[clipped.count++] = corner;
        if (bisector_value[next] > 0 && bisector_value[i] == 0) {
          clipped.corners[clipped.count - 1].neighbour = static_cast<std::int32_t>(other);
          continue;
        }
      }
      if ((bisector_value[i] <= 0) == (bisector_value[next] <= 0)) continue;
      if (bisector_value[next] == 0) continue;  // the next corner lies on the bisector
      const Vector2d place = corner.place + bisector_value[i] / (bisector_value[i] - bisector_value[next]) *
                                                (cell.corners[next].place - corner.place);
      clipped.corners[clipped.count++] = {place,
                                          bisector_value[i] <= 0 ? static_cast<std::int32_t>(other) : corner.neighbour};
    }
    cell.count = clipped.count < 3 ? 0 : clipped.count;
    std::copy_n(clipped.corners.begin(), cell.count, cell.corners.begin());
  }
  return true;
}

bool BisectorCells::reaches_cell_straight(const FaceDistances& distances, std::size_t image) const {
  const auto& arrivals = distances.arrivals();
  const Cell& cell = cells_[image];
  const auto reaches_straight = [](const FaceArrival& arrival, const Vector2d& place) {
    return &arrival.turns_at(place) == &arrival.image;
  };
  // Mostly one bundle of paths reaches the whole cell.
  std::size_t bundle_count = 0;
  for (std::size_t k = 0; k < image_arrivals_.size(); ++k) {
    if (image_of_arrival_[k] != static_cast<std::int32_t>(image)) continue;
    ++bundle_count;
    const FaceArrival& arrival = arrivals[static_cast<std::size_t>(image_arrivals_[k])];
    bool all = true;
    for (std::size_t i = 0; i < cell.count && all; ++i) all = reaches_straight(arrival, cell.corners[i].place);
    if (all) return true;
  }
  if (bundle_count < 2) return false;
  // Otherwise several bundles may reach it together, if each is adjacent to another one.
  std::array<const FaceArrival*, 8> adjacent;
  std::size_t count = 0;
  const auto is_adjacent = [&](const FaceArrival& arrival) {
    return std::any_of(adjacent.begin(), adjacent.begin() + static_cast<std::ptrdiff_t>(count),
                       [&](const FaceArrival* other) {
                         const auto are_separate = [](const FaceArrival& first, const FaceArrival& second) {
                           const Vector2d end = first.begin - first.image;
                           const Vector2d begin = second.end - second.image;
                           return cross(end, begin) > min_bundle_gap * end.norm() * begin.norm();
                         };
                         return !are_separate(*other, arrival) && !are_separate(arrival, *other);
                       });
  };
  for (bool is_growing = true; is_growing && count < adjacent.size();) {
    is_growing = false;
    for (std::size_t k = 0; k < image_arrivals_.size() && count < adjacent.size(); ++k) {
      if (image_of_arrival_[k] != static_cast<std::int32_t>(image)) continue;
      const FaceArrival& arrival = arrivals[static_cast<std::size_t>(image_arrivals_[k])];
      const auto end = adjacent.begin() + static_cast<std::ptrdiff_t>(count);
      if (arrival.everywhere || std::find(adjacent.begin(), end, &arrival) != end) continue;
      bool any = count > 0;
      for (std::size_t i = 0; i < cell.count && !any; ++i) any = reaches_straight(arrival, cell.corners[i].place);
      if (!any || (count > 0 && !is_adjacent(arrival))) continue;
      adjacent[count++] = &arrival;
      is_growing = true;
    }
  }
  for (std::size_t i = 0; i < cell.count; ++i)
    if (std::none_of(adjacent.begin(), adjacent.begin() + static_cast<std::ptrdiff_t>(count),
                     [&](const FaceArrival* arrival) { return reaches_straight(*arrival, cell.corners[i].place); }))
      return false;
  return true;
}

bool BisectorCells::is_nowhere_shorter(const FaceArrival& arrival, std::size_t image, double size) const {
  const Cell& cell = cells_[image];
  const Vector2d& near = images_[image].place;
  // The region in which the arrival is shorter is convex and unbounded: it crosses the sides of the cell or does not
  // meet it.
  const double min_excess = arrival.sigma - sigma_ + sigma_tolerance * size;
  const double image_distance = (arrival.image - near).norm();
  if (image_distance <= min_excess) return true;
  // Length of the image's own path minus that of the arrival's straight path, at each corner.
  std::array<double, Cell::max_corners> excess;
  std::array<double, Cell::max_corners> sums;
  for (std::size_t i = 0; i < cell.count; ++i) {
    const Vector2d& place = cell.corners[i].place;
    const double own = (place - near).norm();
    const double other = (place - arrival.image).norm();
    excess[i] = own - other;
    sums[i] = own + other;
    if (excess[i] > min_excess) return false;
  }
  for (std::size_t i = 0; i < cell.count; ++i) {
    const std::size_t next = i + 1 < cell.count ? i + 1 : 0;
    const Vector2d& from = cell.corners[i].place;
    const Vector2d& to = cell.corners[next].place;
    // The gradients of |x - S| and |x - T|, S and T the images, differ by at most 2 |S - T| / (|x - S| + |x - T|). This
    // bounds the change of the excess along the side.
    const double length = (to - from).norm();
    const double sum = std::min(sums[i], sums[next]) - length;
    if (sum > 0 && 0.5 * (excess[i] + excess[next]) + length * image_distance / sum <= min_excess) continue;
    if (falls_below(arrival.image, near, min_excess, from, to)) return false;
  }
  return true;
}

bool BisectorCells::find(const FaceDistances& distances, const Active& active, std::span<const Vector2d> polygon,
                         double size) {
  if (polygon.size() + 1 > Cell::max_corners || !gather_images(distances, active, size)) return false;
  if (cells_.size() < images_.size()) cells_.resize(images_.size());
  for (std::size_t image = 0; image < images_.size(); ++image) {
    if (!clip_cell(image, polygon)) return false;
    if (cells_[image].count == 0) continue;
    if (!reaches_cell_straight(distances, image)) return false;
    for (const std::int32_t i : farther_)
      if (!is_nowhere_shorter(distances.arrivals()[static_cast<std::size_t>(i)], image, size)) return false;
  }
  return true;
}

}  // namespace supple::voronoi
