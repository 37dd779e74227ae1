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

// The unit of the following lengths is the smallest wall.
/// Width below which a place is narrow: simplifying outlines removes up to a hundredth of a wall.
constexpr double narrow_width = 0.98;
/// Diameter of the disk that fits in on either side of a neck.
constexpr double disk_diameter = 0.98;
/// Distance on either side of a neck within which such disks are searched. A place that is narrow for longer is no
/// neck, but a wall.
constexpr double disk_search_distance = 2.5;
/// Half side of the square window in which the solid is examined. It is so large that erosion from the window's border
/// does not enter the area where disks are searched.
constexpr double window_half_side = 4.2;
/// Distance below which two places are one neck.
constexpr double same_neck_distance = 1;
/// Width of a strip, of which simplifying outlines leaves at least a wall.
constexpr double strip_width = 1.02;
/// Limit of the widenings of a neck. A strip may leave narrow places beside it, which are widened, too.
constexpr int max_widenings = 3;
/// Length by which a cut extends beyond the neck on either side, and half of its length along the solid.
constexpr double cut_margin = 0.02;
constexpr double half_cut = 0.05;

// The unit of the following lengths is 1 mm.
/// Approximate width of the necks that join coincident corners. Places narrower than half of it count as such corners.
constexpr double joint_width = 4e-3;
/// Distance below which points differ by rounding only.
constexpr double rounding_distance = 1e-6;

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
  double min_distance = INFINITY;
  for (const auto& path : area) {
    const Polygon polygon = to_polygon(path);
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Eigen::Vector2d candidate = nearest_on_segment(point, polygon[k], polygon[(k + 1) % polygon.size()]);
      const double distance = (candidate - point).norm();
      if (distance >= min_distance) continue;
      min_distance = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

/// The solid on one side of a narrow place.
struct SolidBeyond {
  /// The nearest centre of a disk that fits in.
  std::optional<Eigen::Vector2d> disk;
  /// Whether the solid continues beyond the area that is searched.
  bool continues = false;
};

/// The solid near narrow places.
class Surroundings {
 public:
  Surroundings(const SolidFace& solid, const std::vector<NarrowPlace>& places, double wall) : wall_(wall) {
    Paths windows;
    windows.reserve(places.size());
    for (const NarrowPlace& place : places)
      windows.push_back(to_path(square_around(place.middle(), window_half_side * wall)));
    const Paths near = operation(ClipperLib::ctIntersection, to_paths(solid), windows);
    near_ = with_bounds(near);
    disks_ = with_bounds(grown(near, -disk_diameter / 2 * wall, ClipperLib::jtRound));
  }

  /// The solid to the left of the line from a to b (`side` 1) or to its right (-1).
  SolidBeyond beyond(const NarrowPlace& place, int side) const {
    const Eigen::Vector2d across = (place.b - place.a).normalized();
    const Eigen::Vector2d along = side * Eigen::Vector2d(-across.y(), across.x());
    const double search_distance = disk_search_distance * wall_;
    const Polygon search_area = rectangle_around(place.middle() + search_distance / 2 * along, search_distance * across,
                                                 search_distance / 2 * along);
    const auto piece = piece_at(place, along, search_area);
    if (piece.empty()) return {};
    SolidBeyond result;
    for (const Polygon& polygon : piece) {
      for (const Eigen::Vector2d& p : polygon) {
        const Eigen::Vector2d displacement = p - place.middle();
        const double ahead = displacement.dot(along), aside = std::abs(displacement.dot(across));
        const bool is_at_border =
            ahead >= search_distance - rounding_distance || aside >= search_distance - rounding_distance;
        // A piece that returns to the line through the neck continues behind it.
        const bool comes_back = ahead <= rounding_distance && aside > place.width() / 2 + rounding_distance;
        result.continues = result.continues || is_at_border || comes_back;
      }
    }
    const Paths disks = operation(ClipperLib::ctIntersection, near_only(disks_, search_area), {to_path(search_area)});
    const Paths inside = operation(ClipperLib::ctIntersection, disks, to_paths(piece));
    if (!inside.empty()) result.disk = nearest_outline_point(inside, place.middle());
    return result;
  }

 private:
  /// The connected piece of the solid within the searched area that begins at the narrow place.
  SolidFace piece_at(const NarrowPlace& place, const Eigen::Vector2d& along, const Polygon& search_area) const {
    ClipperLib::Clipper clipper;
    clipper.AddPaths(near_only(near_, search_area), ClipperLib::ptSubject, true);
    clipper.AddPath(to_path(search_area), ClipperLib::ptClip, true);
    ClipperLib::PolyTree tree;
    clipper.Execute(ClipperLib::ctIntersection, tree, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
    std::vector<SolidFace> pieces;
    add_faces(tree, pieces);
    const Eigen::Vector2d inside = place.middle() + std::min(place.width() / 8, 50 * rounding_distance) * along;
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
  std::vector<BoundedPath> disks_;  ///< areas of the centres of disks that fit in
};

}  // namespace

NeckRepairs::NeckRepairs(const Paths& outline, double wall) : outline_(outline), wall_(wall) {}

double NeckRepairs::limit() const { return narrow_width * wall_; }

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
  std::optional<Paths> centre_line_area;  // area in which the centre line of a strip may run
  const auto cut = [&](const NarrowPlace& place) {
    const Eigen::Vector2d across = (place.b - place.a).normalized();
    repair.removed.push_back(to_path(rectangle_around(place.middle(), (place.width() / 2 + cut_margin * wall_) * across,
                                                      half_cut * wall_ * Eigen::Vector2d(-across.y(), across.x()))));
  };
  ++pass_;
  for (const NarrowPlace& place : places) {
    const SolidBeyond left = surroundings.beyond(place, 1), right = surroundings.beyond(place, -1);
    const bool is_neck = (left.disk || left.continues) && (right.disk || right.continues);
    if (!is_neck) {
      // A piece that is connected by joined corners only becomes a crumb.
      if (place.width() < 2 * joint_width) cut(place);
      continue;
    }
    const auto found = std::find_if(necks_.begin(), necks_.end(), [&](const Neck& neck) {
      return (neck.position - place.middle()).norm() < same_neck_distance * wall_;
    });
    const auto index = static_cast<std::size_t>(found - necks_.begin());
    if (found == necks_.end()) necks_.push_back({place.middle()});
    Neck& neck = necks_[index];
    if (neck.last_pass != pass_) ++neck.passes;
    neck.last_pass = pass_;
    if (neck.passes <= max_widenings && left.disk && right.disk && !neck.is_cut) {
      if (!centre_line_area) centre_line_area = grown(outline_, -strip_width / 2 * wall_, ClipperLib::jtMiter);
      const Eigen::Vector2d middle = is_within(*centre_line_area, place.middle())
                                         ? place.middle()
                                         : nearest_outline_point(*centre_line_area, place.middle());
      const Paths widening = widened_line({to_path({*left.disk})[0], to_path({middle})[0], to_path({*right.disk})[0]},
                                          strip_width / 2 * wall_);
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
