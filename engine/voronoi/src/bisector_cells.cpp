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

/// Relative to the face: lengths that differ by less are the same, and so are places.
constexpr double same_sigma = 1e-12;
constexpr double same_image_place = 1e-9;
/// Of more images the envelope is found otherwise.
constexpr std::size_t most_bisector_images = 64;
/// Radians: bundles of paths from one image with a narrower gap are one.
constexpr double narrowest_gap = 1e-11;

/// Whether |x - far| - |x - near| falls below -least, least > 0, between two places where it does not.
bool falls_below(const Vector2d& far, const Vector2d& near, double least, const Vector2d& from, const Vector2d& to) {
  const LineRoots roots = equal_length_roots(near, far, least, from, to - from);
  return std::any_of(roots.fractions.begin(), roots.fractions.begin() + static_cast<std::ptrdiff_t>(roots.count),
                     [](double fraction) { return fraction > 0 && fraction < 1; });
}

}  // namespace

bool BisectorCells::gather_images(const FaceDistances& distances, const Active& kept, double size) {
  const auto& arrivals = distances.arrivals();
  sigma_ = std::numeric_limits<double>::infinity();
  for (const std::int32_t i : kept) sigma_ = std::min(sigma_, arrivals[static_cast<std::size_t>(i)].sigma);
  images_.clear();
  near_.clear();
  near_images_.clear();
  farther_.clear();
  const double same_squared = same_image_place * same_image_place * size * size;
  for (const std::int32_t i : kept) {
    const FaceArrival& arrival = arrivals[static_cast<std::size_t>(i)];
    if (arrival.sigma > sigma_ + same_sigma * size) {
      farther_.push_back(i);
    } else {
      near_.push_back(i);
    }
  }
  // In an order that does not depend on that of the arrivals, so that a diagram that is made anew in a few faces only
  // is the same.
  std::sort(near_.begin(), near_.end(), [&](std::int32_t i, std::int32_t j) {
    const FaceArrival& a = arrivals[static_cast<std::size_t>(i)];
    const FaceArrival& b = arrivals[static_cast<std::size_t>(j)];
    if (a.source != b.source) return a.source < b.source;
    return a.image.x() != b.image.x() ? a.image.x() < b.image.x() : a.image.y() < b.image.y();
  });
  for (const std::int32_t i : near_) {
    const FaceArrival& arrival = arrivals[static_cast<std::size_t>(i)];
    std::size_t image = 0;
    while (image < images_.size() && !((images_[image].place - arrival.image).squaredNorm() <= same_squared)) ++image;
    if (image == images_.size()) {
      if (image == most_bisector_images) return false;
      images_.push_back({arrival.image, arrival.source});
    } else if (images_[image].site != arrival.source) {
      return false;
    }
    near_images_.push_back(static_cast<std::int32_t>(image));
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
    // Both cells of a bisector see it by the same numbers, but for their sign.
    const Vector2d normal = images_[other].place - own;
    const double offset = 0.5 * normal.dot(images_[other].place + own);
    std::array<double, Cell::most_corners> beyond;
    bool any = false;
    for (std::size_t i = 0; i < cell.count; ++i) {
      beyond[i] = normal.dot(cell.corners[i].place) - offset;
      any = any || beyond[i] > 0;
    }
    if (!any) continue;
    clipped.count = 0;
    for (std::size_t i = 0; i < cell.count; ++i) {
      const std::size_t next = i + 1 < cell.count ? i + 1 : 0;
      if (clipped.count + 2 > Cell::most_corners) return false;
      const Corner& corner = cell.corners[i];
      if (beyond[i] <= 0) {
        clipped.corners[clipped.count++] = corner;
        if (beyond[next] > 0 && beyond[i] == 0) {
          clipped.corners[clipped.count - 1].beyond = static_cast<std::int32_t>(other);
          continue;
        }
      }
      if ((beyond[i] <= 0) == (beyond[next] <= 0)) continue;
      if (beyond[next] == 0) continue;  // the next corner is where the bisector enters
      const Vector2d place =
          corner.place + beyond[i] / (beyond[i] - beyond[next]) * (cell.corners[next].place - corner.place);
      clipped.corners[clipped.count++] = {place, beyond[i] <= 0 ? static_cast<std::int32_t>(other) : corner.beyond};
    }
    cell.count = clipped.count < 3 ? 0 : clipped.count;
    std::copy_n(clipped.corners.begin(), cell.count, cell.corners.begin());
  }
  return true;
}

bool BisectorCells::sees_cell(const FaceDistances& distances, std::size_t image) const {
  const auto& arrivals = distances.arrivals();
  const Cell& cell = cells_[image];
  const auto sees = [](const FaceArrival& arrival, const Vector2d& place) {
    return &arrival.turns_at(place) == &arrival.image;
  };
  // One bundle of paths mostly has all of a cell.
  std::size_t of_image = 0;
  for (std::size_t k = 0; k < near_.size(); ++k) {
    if (near_images_[k] != static_cast<std::int32_t>(image)) continue;
    ++of_image;
    const FaceArrival& arrival = arrivals[static_cast<std::size_t>(near_[k])];
    bool all = true;
    for (std::size_t i = 0; i < cell.count && all; ++i) all = sees(arrival, cell.corners[i].place);
    if (all) return true;
  }
  if (of_image < 2) return false;
  // Else several do, of which each touches another.
  std::array<const FaceArrival*, 8> joined;
  std::size_t count = 0;
  const auto touches = [&](const FaceArrival& arrival) {
    return std::any_of(joined.begin(), joined.begin() + static_cast<std::ptrdiff_t>(count), [&](const FaceArrival* by) {
      const auto apart = [](const FaceArrival& first, const FaceArrival& second) {
        const Vector2d end = first.begin - first.image;
        const Vector2d begin = second.end - second.image;
        return cross(end, begin) > narrowest_gap * end.norm() * begin.norm();
      };
      return !apart(*by, arrival) && !apart(arrival, *by);
    });
  };
  for (bool grows = true; grows && count < joined.size();) {
    grows = false;
    for (std::size_t k = 0; k < near_.size() && count < joined.size(); ++k) {
      if (near_images_[k] != static_cast<std::int32_t>(image)) continue;
      const FaceArrival& arrival = arrivals[static_cast<std::size_t>(near_[k])];
      const auto end = joined.begin() + static_cast<std::ptrdiff_t>(count);
      if (arrival.everywhere || std::find(joined.begin(), end, &arrival) != end) continue;
      bool any = count > 0;
      for (std::size_t i = 0; i < cell.count && !any; ++i) any = sees(arrival, cell.corners[i].place);
      if (!any || (count > 0 && !touches(arrival))) continue;
      joined[count++] = &arrival;
      grows = true;
    }
  }
  for (std::size_t i = 0; i < cell.count; ++i)
    if (std::none_of(joined.begin(), joined.begin() + static_cast<std::ptrdiff_t>(count),
                     [&](const FaceArrival* arrival) { return sees(*arrival, cell.corners[i].place); }))
      return false;
  return true;
}

bool BisectorCells::is_farther(const FaceArrival& arrival, std::size_t image, double size) const {
  const Cell& cell = cells_[image];
  const Vector2d& near = images_[image].place;
  // Where the arrival is shorter is convex and goes on for ever: it meets the sides of the cell or stays out of it.
  const double least = arrival.sigma - sigma_ + same_sigma * size;
  const double apart = (arrival.image - near).norm();
  if (apart <= least) return true;
  std::array<double, Cell::most_corners> gains;  // of the arrival on the image's own paths
  std::array<double, Cell::most_corners> sums;
  for (std::size_t i = 0; i < cell.count; ++i) {
    const Vector2d& place = cell.corners[i].place;
    const double own = (place - near).norm();
    const double other = (place - arrival.image).norm();
    gains[i] = own - other;
    sums[i] = own + other;
    if (gains[i] > least) return false;
  }
  for (std::size_t i = 0; i < cell.count; ++i) {
    const std::size_t next = i + 1 < cell.count ? i + 1 : 0;
    const Vector2d& from = cell.corners[i].place;
    const Vector2d& to = cell.corners[next].place;
    // The directions in which two images S, T see a place x differ by at most 2 |S - T| / (|x - S| + |x - T|): so much
    // may be gained on a part of the side.
    const double length = (to - from).norm();
    const double sum = std::min(sums[i], sums[next]) - length;
    if (sum > 0 && 0.5 * (gains[i] + gains[next]) + length * apart / sum <= least) continue;
    if (falls_below(arrival.image, near, least, from, to)) return false;
  }
  return true;
}

bool BisectorCells::find(const FaceDistances& distances, const Active& kept, std::span<const Vector2d> polygon,
                         double size) {
  if (polygon.size() + 1 > Cell::most_corners || !gather_images(distances, kept, size)) return false;
  if (cells_.size() < images_.size()) cells_.resize(images_.size());
  for (std::size_t image = 0; image < images_.size(); ++image) {
    if (!clip_cell(image, polygon)) return false;
    if (cells_[image].count == 0) continue;
    if (!sees_cell(distances, image)) return false;
    for (const std::int32_t i : farther_)
      if (!is_farther(distances.arrivals()[static_cast<std::size_t>(i)], image, size)) return false;
  }
  return true;
}

}  // namespace supple::voronoi
