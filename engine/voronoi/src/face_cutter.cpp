#include "face_cutter.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>

#include "bisector_borders.h"
#include "planar_cross.h"
#include "planar_face.h"
#include "polygon_sides.h"
#include "quadrature.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;

/// Relative to the face: polygons below are not divided any more.
constexpr double smallest_triangle = 1e-12;
/// Lines between parts of cells are tried this often in a row: after that polygons are halved, because that makes them
/// smaller for sure.
constexpr int most_chords = 24;
/// Divisions of a face: polygons that are not simple by then are told apart by rounding only.
constexpr std::int64_t most_divisions = 1500;
/// Relative to the triangle: a Voronoi vertex may be this far outside.
constexpr double outside = 1e-9;
/// Relative to the distance: distances to the sites of a vertex differ by no more, and no other site is nearer by more.
constexpr double equidistance = 2e-13;
constexpr int most_newton_steps = 30;
/// Relative to the face: shorter parts of borders count as straight, and curves are found to this.
constexpr double shortest_curve = 1e-9;
constexpr double curve_rounding = 1e-13;
constexpr int most_curve_steps = 60;
constexpr int most_curve_halvings = 8;
/// How far, at the outer ones of three points, cubic and quartic terms take a curve from its parabola, as fractions of
/// the bulge for a series whose terms are all equal; and what fraction of the sixth term three points miss.
constexpr double cubic_part = 0.156;
constexpr double quartic_part = 0.06;
constexpr double quadrature_error = 1.4e-3;
/// What a curvature that is gone before the first or after the last of three points changes in the area, as a fraction
/// of the bulge.
constexpr double end_error = 2e-3;
/// Relative to the face: images closer than this are one.
constexpr double same_image = 1e-9;
/// Fractions of a border to which its bends are found, and the places where paths only begin to turn, where the border
/// is smooth but for its curvature. Areas need less than derivatives do, because bends lie on the border all the same.
struct BendWidths {
  double bend, turn;
};
constexpr BendWidths widths_for_derivatives{1e-12, 1e-7};
/// The same by the area that a part may leave, as a fraction of the face's square: a bend that is missed by w takes an
/// area of the order of w from a piece, a place where paths begin to turn one of the order of w^3.
BendWidths widths_for_areas(double area) {
  return {std::clamp(1e2 * area, 1e-10, 1e-5), std::clamp(std::cbrt(area), 1e-4, 1e-2)};
}
/// Relative to the face: lengths that differ by less do not say which is shorter.
constexpr double tie_gap = 1e-12;
constexpr double tiny_gap = 1e-300;
/// Bends this near to an end do not count: there it is not sure which way paths come.
constexpr double bend_margin = 1e-7;
constexpr int most_bend_samples = 8;
constexpr int most_changes = 12;  // of paths along one part of a border

/// Room that a thread keeps from face to face, so that cutting one asks for little memory.
struct CutterRoom {
  /// What a polygon that is being divided needs.
  struct Level {
    std::vector<BoundaryVertex> boundary;
    std::vector<std::size_t> cuts;  ///< indices of those that are cuts and not corners
    Active kept;
  };
  std::deque<Level> levels;
  std::vector<Vector2d> cut_places;
  std::vector<std::pair<std::int32_t, double>> areas;
  BisectorBorders bisectors;
  std::vector<Vector2d> polygon;

  Level& level(int depth) {
    while (levels.size() <= static_cast<std::size_t>(depth)) levels.emplace_back();
    Level& found = levels[static_cast<std::size_t>(depth)];
    found.boundary.clear();
    found.cuts.clear();
    return found;
  }
};

class Cutter {
 public:
  Cutter(const FaceDistances& distances, const std::array<Vector2d, 3>& corners, bool samples, double area_tolerance,
         CutterRoom& room, CutFace& result)
      : distances_(distances),
        corners_(corners),
        area_tolerance_(area_tolerance),
        result_(result),
        room_(room),
        cut_places_(room.cut_places),
        areas_(room.areas),
        samples_(samples) {
    cut_places_.clear();
    areas_.clear();
    for (const surface::FaceArrival& arrival : distances.arrivals())
      if (arrival.everywhere && arrival.sigma == 0) sites_.push_back({arrival.image, arrival.source});
    for (int i = 0; i < 3; ++i) size_ = std::max(size_, (corners[(i + 1) % 3] - corners[i]).norm());
  }

  /// Adds the place of the next cut of a side of the face.
  void add_cut(const Vector2d& place) { cut_places_.push_back(place); }

  void cut(const Sides& sides, const Active& active, int depth) {
    Vector2d centre = Vector2d::Zero();
    for (const Side& side : sides) centre += side.from / static_cast<double>(sides.size());
    double radius = 0;
    double longest = 0;
    for (const Side& side : sides) {
      radius = std::max(radius, (side.from - centre).norm());
      longest = std::max(longest, (side.to - side.from).norm());
    }
    auto& [boundary, cuts, kept] = room_.level(depth);
    for (const Side& side : sides) {
      boundary.push_back({side.from, BoundaryVertex::corner, side.sites.front()});
      for (std::size_t i = 0; i < side.cuts.size(); ++i) {
        cuts.push_back(boundary.size());
        boundary.push_back({place_of(side.cuts[i]), side.cuts[i], side.sites[i + 1]});
      }
    }
    const bool hidden = has_hidden_site(sides, boundary);
    if (!hidden && cuts.empty()) return add_piece(boundary.front().site, boundary, 0, boundary.size(), {});
    distances_.prune(active, centre, radius, kept);
    if (cut_by_bisectors(sides, boundary, cuts, kept)) return;
    if (!hidden && cuts.size() == 2) return cut_in_two(boundary, cuts, kept);
    const bool small = !(longest > smallest_triangle * size_) || result_.subdivisions >= most_divisions;
    if (!hidden && cuts.size() >= 3 && all_differ(boundary, cuts)) {
      Vector2d place = centre;
      if (meet(sides, boundary, cuts, kept, longest, place)) return cut_at_vertex(boundary, cuts, place, kept);
    }
    if (result_.subdivisions >= most_divisions) result_.resolved = false;
    if (small)
      return cuts.empty() ? add_piece(boundary.front().site, boundary, 0, boundary.size(), {})
                          : cut_at_vertex(boundary, cuts, centre, kept);
    BorderPlace begin;
    BorderPlace end;
    if (hidden || depth >= most_chords || !choose_chord(sides, begin, end)) choose_middle(sides, longest, begin, end);
    divide(sides, begin, end, kept, depth + 1);
  }

  /// The areas between the straight lines and the borders.
  void finish() {
    std::sort(areas_.begin(), areas_.end());
    for (const auto& [site, area] : areas_) {
      if (result_.areas.empty() || result_.areas.back().first != site)
        result_.areas.emplace_back(site, area);
      else
        result_.areas.back().second += area;
    }
  }

 private:
  struct InnerSite {
    Vector2d place;
    std::int32_t site;
  };
  const Vector2d& place_of(std::int32_t cut) const {
    return cut < 0 ? cut_places_[static_cast<std::size_t>(-1 - cut)]
                   : result_.points[static_cast<std::size_t>(cut)].place;
  }

  /// A place that is outside the face by rounding, as where sites are so near to each other that their border is known
  /// to few digits, on its boundary.
  Vector2d within_face(const Vector2d& place) const {
    const bool inside = [&] {
      for (std::size_t i = 0; i < 3; ++i)
        if (cross(corners_[(i + 1) % 3] - corners_[i], place - corners_[i]) < 0) return false;
      return true;
    }();
    if (inside) return place;
    const Eigen::Vector3d weights = barycentric(corners_, place);
    return weights[0] * corners_[0] + weights[1] * corners_[1] + weights[2] * corners_[2];
  }

  /// Whether a site lies in the triangle whose cell does not show on the sides.
  bool has_hidden_site(const Sides& sides, const std::vector<BoundaryVertex>& boundary) const {
    for (const InnerSite& inner : sites_) {
      if (std::any_of(boundary.begin(), boundary.end(),
                      [&](const BoundaryVertex& stop) { return stop.site == inner.site; }))
        continue;
      bool inside = true;
      for (const Side& side : sides) inside = inside && cross(side.to - side.from, inner.place - side.from) >= 0;
      if (inside) return true;
    }
    return false;
  }

  static bool all_differ(const std::vector<BoundaryVertex>& boundary, const std::vector<std::size_t>& cuts) {
    for (std::size_t i = 0; i < cuts.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (boundary[cuts[i]].site == boundary[cuts[j]].site) return false;
    return true;
  }

  /// Newton's method for the point at one distance from the sites of all cuts (thesis eq. 3.25). True if it lies in the
  /// triangle and no other site is nearer.
  bool meet(const Sides& sides, const std::vector<BoundaryVertex>& boundary, const std::vector<std::size_t>& cuts,
            const Active& active, double longest, Vector2d& place) const {
    Vector2d x = place;
    double distance = 0;
    double error = std::numeric_limits<double>::infinity();
    const auto count = static_cast<Eigen::Index>(cuts.size());
    for (int step = 0; step < most_newton_steps; ++step) {
      const Slope first = distances_.from_site(active, boundary[cuts[0]].site, x);
      if (!std::isfinite(first.distance)) return false;
      distance = first.distance;
      double worst = 0;
      Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
      Vector2d right = Vector2d::Zero();
      Eigen::Matrix2d two = Eigen::Matrix2d::Zero();
      Vector2d gaps = Vector2d::Zero();
      for (Eigen::Index k = 1; k < count; ++k) {
        const Slope other = distances_.from_site(active, boundary[cuts[static_cast<std::size_t>(k)]].site, x);
        if (!std::isfinite(other.distance)) return false;
        const double gap = first.distance - other.distance;
        const Vector2d slope = first.gradient - other.gradient;
        worst = std::max(worst, std::abs(gap));
        if (k <= 2) {
          two.row(k - 1) = slope.transpose();
          gaps[k - 1] = gap;
        }
        normal += slope * slope.transpose();
        right += slope * gap;
      }
      if (!(worst < 0.5 * error) && worst <= equidistance * distance) break;  // as small as rounding lets it be
      error = worst;
      Vector2d way;
      if (count == 3) {
        const double determinant = cross(two.row(0), two.row(1));
        if (determinant == 0) return false;
        way = Vector2d(two(1, 1) * gaps[0] - two(0, 1) * gaps[1], two(0, 0) * gaps[1] - two(1, 0) * gaps[0]) /
              -determinant;
      } else {
        way = -normal.ldlt().solve(right);
      }
      const double length = way.norm();
      if (!std::isfinite(length)) return false;
      if (length > longest) way *= longest / length;
      x += way;
      if ((x - place).norm() > 2 * longest) return false;
      if (worst == 0) break;
    }
    if (!(error <= equidistance * distance)) return false;
    for (const Side& side : sides) {
      const Vector2d along = side.to - side.from;
      if (cross(along, x - side.from) < -outside * along.norm() * longest) return false;
    }
    if (distances_.nearest(active, x).distance < distance - 4 * equidistance * distance) return false;
    place = within_face(x);
    return true;
  }

  /// Adds the polygon of the boundary between two of its vertices and of the places `beyond`.
  void add_piece(std::int32_t site, const std::vector<BoundaryVertex>& boundary, std::size_t begin, std::size_t end,
                 const std::vector<Vector2d>& beyond) {
    FacePiece piece{site, {}};
    piece.corners.reserve(end - begin + beyond.size());
    for (std::size_t i = begin; i < end; ++i) piece.corners.push_back(boundary[i % boundary.size()].place);
    piece.corners.insert(piece.corners.end(), beyond.begin(), beyond.end());
    add_piece(std::move(piece));
  }

  void add_piece(FacePiece piece) {
    double doubled = 0;
    for (std::size_t i = 2; i < piece.corners.size(); ++i)
      doubled += cross(piece.corners[i - 1] - piece.corners[0], piece.corners[i] - piece.corners[0]);
    areas_.emplace_back(piece.site, 0.5 * doubled);
    result_.pieces.push_back(std::move(piece));
  }

  /// The piece between two neighbouring cuts, and what is beyond.
  void add_piece_between(const std::vector<BoundaryVertex>& boundary, const std::vector<std::size_t>& cuts,
                         std::size_t i, const std::vector<Vector2d>& beyond) {
    const std::size_t begin = cuts[i];
    const std::size_t end = i + 1 < cuts.size() ? cuts[i + 1] : cuts[0] + boundary.size();
    add_piece(boundary[begin].site, boundary, begin, end + 1, beyond);
  }

  void cut_in_two(const std::vector<BoundaryVertex>& boundary, const std::vector<std::size_t>& cuts,
                  const Active& active) {
    // What follows the first cut lies on the left of the way from the second cut to the first.
    std::vector<Vector2d> bends = add_border(boundary[cuts[1]].cut, boundary[cuts[0]].cut, boundary[cuts[0]].site,
                                             boundary[cuts[1]].site, active);
    add_piece_between(boundary, cuts, 0, bends);
    std::reverse(bends.begin(), bends.end());
    add_piece_between(boundary, cuts, 1, bends);
  }

  void cut_at_vertex(const std::vector<BoundaryVertex>& boundary, const std::vector<std::size_t>& cuts,
                     const Vector2d& place, const Active& active) {
    const auto vertex = static_cast<std::int32_t>(result_.points.size());
    result_.points.push_back({place, distances_.nearest(active, place).distance, true});
    std::vector<std::vector<Vector2d>> bends;  // from the vertex to each cut
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      const std::size_t before = (i + cuts.size() - 1) % cuts.size();
      bends.push_back(
          add_border(vertex, boundary[cuts[i]].cut, boundary[cuts[i]].site, boundary[cuts[before]].site, active));
    }
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      const std::vector<Vector2d>& next = bends[(i + 1) % cuts.size()];
      std::vector<Vector2d> beyond(next.rbegin(), next.rend());
      beyond.push_back(place);
      beyond.insert(beyond.end(), bends[i].begin(), bends[i].end());
      add_piece_between(boundary, cuts, i, beyond);
    }
  }

  /// Where all borders in the polygon are bisectors, and meet its sides where these are cut.
  bool cut_by_bisectors(const Sides& sides, const std::vector<BoundaryVertex>& boundary,
                        const std::vector<std::size_t>& cuts, const Active& active) {
    room_.polygon.clear();
    for (const Side& side : sides) room_.polygon.push_back(side.from);
    BisectorBorders& found = room_.bisectors;
    const auto first = static_cast<std::int32_t>(result_.points.size());
    if (!found.find(distances_, active, room_.polygon, boundary, cuts, first, size_)) return false;
    result_.points.insert(result_.points.end(), found.points().begin(), found.points().end());
    for (const FaceBorder& border : found.borders())
      add_straight_border(border.from, border.to, border.left, border.right);
    for (std::size_t image = 0; image < found.pieces(); ++image) {
      FacePiece piece{found.site_of_piece(image), {}};
      found.write_piece(
          image, [&](std::int32_t end) -> const Vector2d& { return place_of(end); }, piece.corners);
      if (piece.corners.size() > 2) add_piece(std::move(piece));
    }
    return true;
  }

  void add_straight_border(std::int32_t from, std::int32_t to, std::int32_t left, std::int32_t right) {
    const Vector2d& begin = place_of(from);
    const Vector2d way = place_of(to) - begin;
    const double length = way.norm();
    result_.borders.push_back({from, to, left, right, length});
    if (!samples_) return;
    for (std::size_t i = 0; i < three_nodes.size(); ++i) {
      const Vector2d place = begin + three_nodes[i] * way;
      result_.samples.push_back({left, right, place, three_weights[i] * length, place, 0});
    }
  }

  /// A border as a function over the straight line between its ends.
  struct Curve {
    Vector2d begin, way, along, normal;
    double length = 0;
    std::int32_t left = -1, right = -1;
    Active from_left, from_right;  ///< the arrivals that matter along it
    bool bisects = false;          ///< images as far from their sites, so that it is straight
    int other_images = 0;          ///< that paths from the sites may come from besides one for each
  };
  /// A place of it.
  struct CurvePoint {
    Vector2d place = Vector2d::Zero();
    double height = 0;   ///< over the line
    double stretch = 1;  ///< how much longer than the line the border is here
    Slope left{}, right{};
  };

  /// A point of quadrature on a border, and the fraction of the straight line that it stands for.
  struct CurveNode {
    CurvePoint point;
    double weight = 0;
  };

  double sigma_of(const Active& active) const {
    return active.empty() ? 0 : distances_.arrivals()[static_cast<std::size_t>(active.front())].sigma;
  }

  /// Whether one of the arrivals, which have one image, reaches both ends of a border straight, and so all of it.
  bool comes_straight(const Active& active, const Vector2d& from, const Vector2d& to) const {
    return std::any_of(active.begin(), active.end(), [&](std::int32_t i) {
      const surface::FaceArrival& arrival = distances_.arrivals()[static_cast<std::size_t>(i)];
      return &arrival.turns_at(from) == &arrival.image && &arrival.turns_at(to) == &arrival.image;
    });
  }

  void lay_curve(std::int32_t from, std::int32_t to, std::int32_t left, std::int32_t right, const Active& active,
                 Curve& curve) const {
    curve.begin = place_of(from);
    curve.way = place_of(to) - curve.begin;
    curve.length = curve.way.norm();
    curve.left = left;
    curve.right = right;
    curve.other_images = 0;
    curve.bisects = false;
    if (!(curve.length > shortest_curve * size_)) return;
    curve.along = curve.way / curve.length;
    curve.normal = Vector2d(-curve.along.y(), curve.along.x());
    // Borders bulge by less than a quarter of their length, or they are cut first.
    const Vector2d middle = curve.begin + 0.5 * curve.way;
    const double radius = 0.6 * curve.length;
    const double tolerance = same_image * size_;
    curve.other_images = distances_.prune_site(active, left, middle, radius, tolerance, curve.from_left) +
                         distances_.prune_site(active, right, middle, radius, tolerance, curve.from_right);
    curve.bisects = curve.other_images == 0 && comes_straight(curve.from_left, curve.begin, place_of(to)) &&
                    comes_straight(curve.from_right, curve.begin, place_of(to)) &&
                    std::abs(sigma_of(curve.from_left) - sigma_of(curve.from_right)) <= tie_gap * size_;
  }

  /// A border between two points: where it bends because paths from one of its sites come another way, it has a point.
  /// Returns these.
  std::vector<Vector2d> add_border(std::int32_t from, std::int32_t to, std::int32_t left, std::int32_t right,
                                   const Active& active) {
    std::vector<Vector2d> bends;
    Curve& curve = curve_;
    lay_curve(from, to, left, right, active, curve);
    if (curve.other_images == 0 || (!samples_ && bends_are_faint(curve))) {
      add_smooth_border(from, to, curve);
      return bends;
    }
    find_all_bends(curve, bends);
    std::int32_t before = from;
    for (const Vector2d& bend : bends) {
      const auto number = static_cast<std::int32_t>(result_.points.size());
      result_.points.push_back({bend, distances_.nearest(active, bend).distance, false});
      lay_curve(before, number, left, right, active, curve);
      add_smooth_border(before, number, curve);
      before = number;
    }
    lay_curve(before, to, left, right, active, curve);
    add_smooth_border(before, to, curve);
    return bends;
  }

  /// Whether three points of quadrature say that a border has no bends that its area shows. Derivatives are of its
  /// parts, and see all of them.
  bool bends_are_faint(const Curve& curve) {
    curve_nodes_.clear();
    probes_ = {};
    return curve.length > shortest_curve * size_ && find_nodes(curve, 0, 0, 1, 0, -1);
  }

  bool same_ways(const CurvePoint& a, const CurvePoint& b) const {
    const double tolerance = same_image * size_;
    return distances_.same_paths(a.left.arrival, a.place, b.left.arrival, b.place, tolerance) &&
           distances_.same_paths(a.right.arrival, a.place, b.right.arrival, b.place, tolerance);
  }

  void find_all_bends(const Curve& curve, std::vector<Vector2d>& bends) const {
    CurvePoint before;
    double begin = bend_margin;
    if (!on_curve(curve, begin, before)) return;
    const bool probed = !samples_ && probes_.front().left.arrival >= 0;
    const int parts =
        probed ? 1 + static_cast<int>(probes_.size()) : std::min(2 * curve.other_images, most_bend_samples);
    for (int i = 1; i <= parts; ++i) {
      double end = i == parts ? 1 - bend_margin : static_cast<double>(i) / parts;
      CurvePoint after;
      if (probed && i < parts) {
        end = three_nodes[static_cast<std::size_t>(i - 1)];
        after = probes_[static_cast<std::size_t>(i - 1)];
      } else if (!on_curve(curve, end, after)) {
        return;
      }
      find_bends(curve, begin, before, end, after, most_changes, bends);
      begin = end;
      before = after;
    }
  }

  /// Closes in on the first place where paths change. Where these are paths of two images that cross, the lengths say
  /// where (the ITP method, Oliveira and Takahashi 2020); where paths begin or cease to turn at a vertex, halving does.
  void find_bends(const Curve& curve, double begin, const CurvePoint& first, double end, const CurvePoint& last,
                  int changes, std::vector<Vector2d>& bends) const {
    if (changes == 0 || same_ways(first, last)) return;
    const auto gap = [&](const CurvePoint& point) {
      const auto of_side = [&](const Slope& from, const Slope& to) {
        const auto& arrivals = distances_.arrivals();
        return from.arrival == to.arrival ? 0
                                          : arrivals[static_cast<std::size_t>(from.arrival)].length_to(point.place) -
                                                arrivals[static_cast<std::size_t>(to.arrival)].length_to(point.place);
      };
      return of_side(first.left, last.left) + of_side(first.right, last.right);
    };
    double low = begin;
    double high = end;
    double at_low = gap(first);
    double at_high = gap(last);
    double height_at_low = first.height;
    double height_at_high = last.height;
    const bool crosses = at_low < -tie_gap * size_ && at_high > tie_gap * size_;
    const BendWidths widths = samples_ ? widths_for_derivatives : widths_for_areas(area_tolerance_ / (size_ * size_));
    const double width = crosses ? widths.bend : widths.turn;
    CurvePoint after = last;
    // As many steps as halving and one more at most.
    double reach = high - low;
    while (high - low > width) {
      const double half = 0.5 * (low + high);
      double at = half;
      if (crosses) {
        const double secant = (at_high * low - at_low * high) / (at_high - at_low);
        const double inwards = secant < half ? 1 : -1;
        const double push = 0.2 * (high - low) * (high - low) / (end - begin);
        at = push <= std::abs(half - secant) ? secant + inwards * push : half;
        const double room = std::max(0.0, reach - 0.5 * (high - low));
        if (std::abs(at - half) > room) at = half - inwards * room;
        reach *= 0.5;
      }
      // Where the ends are near to each other the border between them is all but straight.
      CurvePoint point;
      point.height = height_at_low + (height_at_high - height_at_low) * ((at - low) / (high - low));
      if (!on_curve(curve, at, point)) return;
      if (same_ways(first, point)) {
        low = at;
        height_at_low = point.height;
        at_low = crosses ? std::min(gap(point), -tiny_gap) : 0;
      } else {
        high = at;
        height_at_high = point.height;
        after = point;
        at_high = crosses ? std::max(gap(point), tiny_gap) : 0;
      }
    }
    bends.push_back(within_face(after.place));
    find_bends(curve, high, after, end, last, changes - 1, bends);
  }

  /// A part of a border without bends: the area between it and the straight line, its length, points of quadrature.
  void add_smooth_border(std::int32_t from, std::int32_t to, const Curve& curve) {
    curve_nodes_.clear();
    if (!(curve.length > shortest_curve * size_) || curve.bisects ||
        !find_nodes(curve, 0, 0, 1, 0, most_curve_halvings)) {
      curve_nodes_.clear();
      for (std::size_t i = 0; i < three_nodes.size(); ++i) {
        CurvePoint point;
        point.place = curve.begin + three_nodes[i] * curve.way;
        curve_nodes_.push_back({point, three_weights[i]});
      }
    }
    double area = 0;
    double along = 0;
    for (const CurveNode& node : curve_nodes_) {
      const double part = node.weight * node.point.stretch * curve.length;
      const double beside = node.weight * node.point.height * curve.length;
      area += beside;
      along += part;
      if (samples_)
        result_.samples.push_back({curve.left, curve.right, node.point.place, part,
                                   node.point.place - 0.5 * node.point.height * curve.normal, beside});
    }
    // A border that lies on the left of its straight line takes from the cell there.
    areas_.emplace_back(curve.left, -area);
    areas_.emplace_back(curve.right, area);
    result_.borders.push_back({from, to, curve.left, curve.right, along});
  }

  /// Points of quadrature along a border between two fractions of its straight line, over which it has these heights.
  /// Three suffice where the border is all but a parabola; it is halved where it is not, as next to the focus of its
  /// hyperbola. False where the border is not found.
  bool find_nodes(const Curve& curve, double begin, double height_at_begin, double end, double height_at_end,
                  int halvings) {
    std::array<CurvePoint, three_nodes.size()> points;
    std::array<double, three_nodes.size()> bulges{};  // over the chord of this part, in units of its length
    const double length = (end - begin) * curve.length;
    for (const std::size_t i : {1, 0, 2}) {
      const double along = three_nodes[i];
      const double chord = (1 - along) * height_at_begin + along * height_at_end;
      // Through the ends and the middle goes a parabola, where the search begins.
      points[i].height = chord + (i == 1 ? 0 : 4 * along * (1 - along) * bulges[1] * length);
      if (!on_curve(curve, begin + along * (end - begin), points[i])) return false;
      if (!(std::abs(points[i].height) < curve.length)) return false;
      bulges[i] = (points[i].height - chord) / length;
    }
    const double parabola = 4 * three_nodes[0] * (1 - three_nodes[0]) * bulges[1];
    const double cubic = 0.5 * std::abs(bulges[0] - bulges[2]);
    const double quartic = 0.5 * std::abs(bulges[0] + bulges[2] - 2 * parabola);
    const double bulge = std::max({std::abs(bulges[1]), cubic, quartic});
    // In a series in the distance along the chord: the square of the ratio of successive terms. The sixth power is what
    // three points miss.
    const double square = bulge > 0 ? std::max(cubic * cubic / (cubic_part * cubic_part * bulge * bulge),
                                               quartic / (quartic_part * bulge))
                                    : 0;
    double left = quadrature_error * bulge * square * square * length * length;
    if (halvings < 0 && turns_near_ends(curve, points)) left += end_error * bulge * length * length;
    if (left > area_tolerance_) {
      probes_ = points;
      if (halvings < 0) return false;
      if (halvings == 0) return take_nodes(points, begin, end);
      const double middle = 0.5 * (begin + end);
      const double height = points[1].height;
      return find_nodes(curve, begin, height_at_begin, middle, height, halvings - 1) &&
             find_nodes(curve, middle, height, end, height_at_end, halvings - 1);
    }
    return take_nodes(points, begin, end);
  }

  /// Whether paths come other ways to an end of a border than to the point of quadrature next to it.
  bool turns_near_ends(const Curve& curve, const std::array<CurvePoint, three_nodes.size()>& points) const {
    for (const bool at_end : {false, true}) {
      CurvePoint end;
      end.place = at_end ? Vector2d(curve.begin + curve.way) : curve.begin;
      end.left = distances_.from_site(curve.from_left, curve.left, end.place);
      end.right = distances_.from_site(curve.from_right, curve.right, end.place);
      if (!same_ways(at_end ? points.back() : points.front(), end)) return true;
    }
    return false;
  }

  bool take_nodes(const std::array<CurvePoint, three_nodes.size()>& points, double begin, double end) {
    for (std::size_t i = 0; i < three_nodes.size(); ++i)
      curve_nodes_.push_back({points[i], three_weights[i] * (end - begin)});
    return true;
  }

  /// How far a line that leaves a place of the face runs in it, backwards and forwards, and a little beyond.
  std::pair<double, double> heights_within_face(const Vector2d& base, const Vector2d& direction) const {
    double backwards = -std::numeric_limits<double>::infinity();
    double forwards = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector2d side = corners_[(i + 1) % 3] - corners_[i];
      const double inwards = cross(side, direction);
      if (inwards == 0) continue;
      const double height = -std::max(cross(side, base - corners_[i]), 0.0) / inwards;
      if (inwards > 0)
        backwards = std::max(backwards, height);
      else
        forwards = std::min(forwards, height);
    }
    return {backwards - shortest_curve * size_, forwards + shortest_curve * size_};
  }

  /// The border over a point of its straight line: Newton's method from the height that `point` has, within a bracket
  /// once there is one, because it may go back and forth about a bend.
  bool on_curve(const Curve& curve, double share, CurvePoint& point) const {
    const Vector2d base = curve.begin + share * curve.way;
    // Beyond the face lengths of arrivals go on, and may be equal at other places.
    auto [below, above] = heights_within_face(base, curve.normal);
    for (int step = 0; step < most_curve_steps; ++step) {
      point.place = base + point.height * curve.normal;
      point.left = distances_.from_site(curve.from_left, curve.left, point.place);
      point.right = distances_.from_site(curve.from_right, curve.right, point.place);
      const double gap = point.left.distance - point.right.distance;
      const Vector2d gradient = point.left.gradient - point.right.gradient;
      const double across = gradient.dot(curve.normal);
      if (!std::isfinite(gap) || !(across < 0)) return false;  // towards the left cell its site comes nearer
      point.stretch = gradient.norm() / -across;
      const double change = -gap / across;
      if (std::abs(change) <= curve_rounding * size_) return true;
      (gap > 0 ? below : above) = point.height;
      double next = point.height + change;
      if (!(next > below && next < above)) next = 0.5 * (below + above);
      if (!(std::abs(next) < curve.length)) return false;
      if (next == point.height) return true;
      point.height = next;
    }
    return true;
  }

  /// Cuts the two parts of a polygon on the sides of a straight line between two places of different sides.
  void divide(const Sides& sides, const BorderPlace& begin, const BorderPlace& end, const Active& active, int depth) {
    ++result_.subdivisions;
    auto [first_before, first_after] = split(sides[begin.side], begin.share);
    auto [last_before, last_after] = split(sides[end.side], end.share);
    const Vector2d from = first_before.to;
    const Vector2d to = last_before.to;
    const LabelledSegment labelled =
        label_segment(distances_, active, from, to, first_before.sites.back(), last_before.sites.back());
    Side across{from, to, {}, labelled.cuts, labelled.sites};
    for (const double share : labelled.cuts) {
      across.cuts.push_back(static_cast<std::int32_t>(result_.points.size()));
      const Vector2d place = from + share * (to - from);
      result_.points.push_back({place, distances_.nearest(active, place).distance, false});
    }
    Sides between{reversed(across), std::move(first_after)};
    for (std::size_t k = begin.side + 1; k < end.side; ++k) between.push_back(sides[k]);
    between.push_back(std::move(last_before));
    Sides beyond{std::move(across), std::move(last_after)};
    for (std::size_t k = end.side + 1; k < sides.size(); ++k) beyond.push_back(sides[k]);
    for (std::size_t k = 0; k < begin.side; ++k) beyond.push_back(sides[k]);
    beyond.push_back(std::move(first_before));
    cut(between, active, depth);
    cut(beyond, active, depth);
  }

  const FaceDistances& distances_;
  std::array<Vector2d, 3> corners_;
  double area_tolerance_;  ///< what quadrature may leave of the area beside a part of a border
  CutFace& result_;
  std::vector<InnerSite> sites_;
  double size_ = 0;
  Curve curve_;
  std::vector<CurveNode> curve_nodes_;
  std::array<CurvePoint, three_nodes.size()> probes_;  ///< where bends_are_faint() has looked
  CutterRoom& room_;
  // Parts of it:
  std::vector<Vector2d>& cut_places_;
  std::vector<std::pair<std::int32_t, double>>& areas_;
  bool samples_;
};

}  // namespace

CutFace cut_face(const FaceDistances& distances, const std::array<Vector2d, 3>& corners,
                 const std::array<const LabelledSegment*, 3>& sides, bool samples, double area_tolerance) {
  CutFace result;
  static thread_local CutterRoom room;
  Cutter cutter(distances, corners, samples, area_tolerance, room, result);
  Sides whole(3);
  std::int32_t number = 0;
  for (int i = 0; i < 3; ++i) {
    const Vector2d& from = corners[i];
    const Vector2d& to = corners[(i + 1) % 3];
    whole[static_cast<std::size_t>(i)] = {from, to, {}, sides[i]->cuts, sides[i]->sites};
    for (const double share : sides[i]->cuts) {
      whole[static_cast<std::size_t>(i)].cuts.push_back(-1 - number++);
      cutter.add_cut(from + share * (to - from));
    }
  }
  Active active;
  distances.all(active);
  cutter.cut(whole, active, 0);
  cutter.finish();
  return result;
}

}  // namespace supple::voronoi
