#include "neck_repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "clipper_paths.h"
#include "polygon.h"

namespace supple::tiling {
namespace {

using ClipperLib::Paths;

// Lengths in walls.
/// A place is narrow below this width: simplifying outlines takes up to a hundredth of a wall away.
constexpr double narrow = 0.98;
/// A disk of this diameter fits in on either side of a neck.
constexpr double full = 0.98;
/// Such disks are looked for within this distance on either side of a neck. What is narrow for longer is no neck but a
/// wall.
constexpr double neck_reach = 2.5;
/// The solid is cut out this far around a neck, so that erosion from the border stays beyond the reach's corners.
constexpr double window_reach = 4.2;
/// Places so near to each other are one neck.
constexpr double one_neck = 1;
/// A strip is so wide: what simplifying outlines takes away leaves a wall.
constexpr double strip = 1.02;
/// A strip may leave narrow places beside it, which are widened in their turn; so often this is tried.
constexpr int max_widenings = 3;
/// A cut reaches this far beyond the neck and is half as long along the solid as this says twice.
constexpr double cut_margin = 0.02;
constexpr double half_cut = 0.05;

// Lengths in mm.
/// Corners in one place become necks of about this width, and what is narrower counts as corners in one place.
constexpr double joint_width = 4e-3;
/// Points so near to each other are one but for rounding.
constexpr double rounding = 1e-6;

Polygon rectangle_around(const Eigen::Vector2d& middle, const Eigen::Vector2d& half_length,
                         const Eigen::Vector2d& half_width) {
  Polygon polygon = {middle - half_length - half_width, middle + half_length - half_width,
                     middle + half_length + half_width, middle - half_length + half_width};
  if (area(polygon) < 0) std::reverse(polygon.begin(), polygon.end());
  return polygon;
}

Polygon square_around(const Eigen::Vector2d& middle, double half_side) {
  return rectangle_around(middle, {half_side, 0}, {0, half_side});
}

Polygon diamond_around(const Eigen::Vector2d& middle) {
  return rectangle_around(middle, {joint_width / 2, joint_width / 2}, {-joint_width / 2, joint_width / 2});
}

bool is_within(const Paths& area, const Eigen::Vector2d& point) {
  int winding = 0;
  for (const auto& path : area) winding += winding_number(to_polygon(path), point);
  return winding != 0;
}

Eigen::Vector2d nearest_outline_point(const Paths& area, const Eigen::Vector2d& point) {
  Eigen::Vector2d nearest = point;
  double least = INFINITY;
  for (const auto& path : area) {
    const Polygon polygon = to_polygon(path);
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Eigen::Vector2d candidate = nearest_on_segment(point, polygon[k], polygon[(k + 1) % polygon.size()]);
      const double distance = (candidate - point).norm();
      if (distance >= least) continue;
      least = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

/// The solid on one side of a narrow place.
struct Beyond {
  /// The nearest centre of a disk that fits in.
  std::optional<Eigen::Vector2d> disk;
  /// Whether the solid goes on farther than was looked.
  bool goes_on = false;
};

/// The solid near narrow places.
class Surroundings {
 public:
  Surroundings(const SolidFace& solid, const std::vector<NarrowPlace>& places, double wall) : wall_(wall) {
    Paths windows;
    windows.reserve(places.size());
    for (const NarrowPlace& place : places)
      windows.push_back(to_path(square_around(place.middle(), window_reach * wall)));
    const Paths near = operation(ClipperLib::ctIntersection, to_paths(solid), windows);
    near_ = with_bounds(near);
    disks_ = with_bounds(grown(near, -full / 2 * wall, ClipperLib::jtRound));
  }

  /// `side`: 1 or -1.
  Beyond beyond(const NarrowPlace& place, int side) const {
    const Eigen::Vector2d across = (place.b - place.a).normalized();
    const Eigen::Vector2d along = side * Eigen::Vector2d(-across.y(), across.x());
    const double reach = neck_reach * wall_;
    const Polygon half_plane = rectangle_around(place.middle() + reach / 2 * along, reach * across, reach / 2 * along);
    const auto piece = piece_at(place, along, half_plane);
    if (piece.empty()) return {};
    Beyond result;
    for (const Polygon& polygon : piece) {
      for (const Eigen::Vector2d& p : polygon) {
        const Eigen::Vector2d way = p - place.middle();
        const double ahead = way.dot(along), aside = std::abs(way.dot(across));
        const bool is_at_border = ahead >= reach - rounding || aside >= reach - rounding;
        // A piece that comes back to the line through the neck goes on behind it.
        const bool comes_back = ahead <= rounding && aside > place.width() / 2 + rounding;
        result.goes_on = result.goes_on || is_at_border || comes_back;
      }
    }
    const Paths disks = operation(ClipperLib::ctIntersection, near_only(disks_, half_plane), {to_path(half_plane)});
    const Paths inside = operation(ClipperLib::ctIntersection, disks, to_paths(piece));
    if (!inside.empty()) result.disk = nearest_outline_point(inside, place.middle());
    return result;
  }

 private:
  /// The connected piece of the solid in the half plane that begins at the narrow place.
  SolidFace piece_at(const NarrowPlace& place, const Eigen::Vector2d& along, const Polygon& half_plane) const {
    ClipperLib::Clipper clipper;
    clipper.AddPaths(near_only(near_, half_plane), ClipperLib::ptSubject, true);
    clipper.AddPath(to_path(half_plane), ClipperLib::ptClip, true);
    ClipperLib::PolyTree tree;
    clipper.Execute(ClipperLib::ctIntersection, tree, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
    std::vector<SolidFace> pieces;
    add_faces(tree, pieces);
    const Eigen::Vector2d inside = place.middle() + std::min(place.width() / 8, 50 * rounding) * along;
    for (SolidFace& piece : pieces) {
      if (winding_number(piece[0], inside) != 0) return std::move(piece);
    }
    return {};
  }

  struct BoundedPath {
    ClipperLib::Path path;
    Bounds bounds;
  };

  static std::vector<BoundedPath> with_bounds(const Paths& paths) {
    std::vector<BoundedPath> result;
    result.reserve(paths.size());
    for (const auto& path : paths) result.push_back({path, bounds_of(to_polygon(path))});
    return result;
  }

  /// The paths that may meet a polygon.
  static Paths near_only(const std::vector<BoundedPath>& paths, const Polygon& polygon) {
    Paths result;
    const Bounds bounds = bounds_of(polygon);
    for (const BoundedPath& one : paths) {
      if (one.bounds.meet(bounds)) result.push_back(one.path);
    }
    return result;
  }

  double wall_;
  std::vector<BoundedPath> near_;
  std::vector<BoundedPath> disks_;  ///< centres of disks that fit in
};

}  // namespace

NeckRepairs::NeckRepairs(const Paths& outline, double wall) : outline_(outline), wall_(wall) {}

double NeckRepairs::limit() const { return narrow * wall_; }

NeckRepair NeckRepairs::next(const SolidFace& solid, const std::vector<NarrowPlace>& places) {
  NeckRepair repair;
  if (places.empty()) return repair;
  Paths joints;
  for (const NarrowPlace& place : places) {
    if (place.width() < joint_width / 2) joints.push_back(to_path(diamond_around(place.middle())));
  }
  repair.added = operation(ClipperLib::ctIntersection, joints, outline_);
  if (!repair.added.empty()) return repair;

  const Surroundings surroundings(solid, places, wall_);
  std::optional<Paths> middles;  // where the middle of a strip may run
  const auto cut = [&](const NarrowPlace& place) {
    const Eigen::Vector2d across = (place.b - place.a).normalized();
    repair.removed.push_back(to_path(rectangle_around(place.middle(), (place.width() / 2 + cut_margin * wall_) * across,
                                                      half_cut * wall_ * Eigen::Vector2d(-across.y(), across.x()))));
  };
  ++round_;
  for (const NarrowPlace& place : places) {
    const Beyond left = surroundings.beyond(place, 1), right = surroundings.beyond(place, -1);
    const bool is_neck = (left.disk || left.goes_on) && (right.disk || right.goes_on);
    if (!is_neck) {
      // What hangs by a joint of corners is a crumb.
      if (place.width() < 2 * joint_width) cut(place);
      continue;
    }
    const auto known = std::find_if(necks_.begin(), necks_.end(), [&](const Neck& neck) {
      return (neck.at - place.middle()).norm() < one_neck * wall_;
    });
    const auto index = static_cast<std::size_t>(known - necks_.begin());
    if (known == necks_.end()) necks_.push_back({place.middle()});
    Neck& neck = necks_[index];
    if (neck.last_round != round_) ++neck.rounds;
    neck.last_round = round_;
    if (neck.rounds <= max_widenings && left.disk && right.disk && !neck.is_cut) {
      if (!middles) middles = grown(outline_, -strip / 2 * wall_, ClipperLib::jtMiter);
      const Eigen::Vector2d middle =
          is_within(*middles, place.middle()) ? place.middle() : nearest_outline_point(*middles, place.middle());
      const Paths widening =
          widened_line({to_path({*left.disk})[0], to_path({middle})[0], to_path({*right.disk})[0]}, strip / 2 * wall_);
      repair.added.insert(repair.added.end(), widening.begin(), widening.end());
    } else {
      neck.is_cut = true;
      cut(place);
    }
  }
  repair.added = operation(ClipperLib::ctIntersection, repair.added, outline_);
  return repair;
}

std::size_t NeckRepairs::cut() const {
  return static_cast<std::size_t>(
      std::count_if(necks_.begin(), necks_.end(), [](const Neck& neck) { return neck.is_cut; }));
}

std::size_t NeckRepairs::widened() const { return necks_.size() - cut(); }

Paths joined_corners(const Paths& solid, const Paths& outline) {
  std::map<std::pair<ClipperLib::cInt, ClipperLib::cInt>, int> corners;
  Paths joints;
  for (const auto& path : solid) {
    for (const auto& p : path) {
      if (++corners[{p.X, p.Y}] == 2) joints.push_back(to_path(diamond_around(to_polygon({p})[0])));
    }
  }
  if (joints.empty()) return solid;
  joints = operation(ClipperLib::ctIntersection, joints, outline);
  joints.insert(joints.end(), solid.begin(), solid.end());
  return operation(ClipperLib::ctUnion, joints, {});
}

}  // namespace supple::tiling
