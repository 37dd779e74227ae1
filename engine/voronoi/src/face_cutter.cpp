#include "face_cutter.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>

#include "bisector_borders.h"
#include "border_curve.h"
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
        result_(result),
        size_(longest_side(corners)),
        curve_(distances, corners, size_, area_tolerance),
        room_(room),
        cut_places_(room.cut_places),
        areas_(room.areas),
        samples_(samples) {
    cut_places_.clear();
    areas_.clear();
    for (const surface::FaceArrival& arrival : distances.arrivals())
      if (arrival.everywhere && arrival.sigma == 0) sites_.push_back({arrival.image, arrival.source});
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
    place = within_face(corners_, x);
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

  /// A border between two points: where it bends because paths from one of its sites come another way, it has a point.
  /// Returns these.
  std::vector<Vector2d> add_border(std::int32_t from, std::int32_t to, std::int32_t left, std::int32_t right,
                                   const Active& active) {
    std::vector<Vector2d> bends;
    curve_.lay(place_of(from), place_of(to), left, right, active);
    curve_.find_bends(samples_);
    std::int32_t before = from;
    for (const auto& [bend, distance] : curve_.bends()) {
      const auto number = static_cast<std::int32_t>(result_.points.size());
      result_.points.push_back({bend, distance, false});
      curve_.lay_part(bends.size(), place_of(before), bend);
      add_smooth_border(before, number, left, right);
      bends.push_back(bend);
      before = number;
    }
    if (!bends.empty()) curve_.lay_part(bends.size(), place_of(before), place_of(to));
    add_smooth_border(before, to, left, right);
    return bends;
  }

  /// A part of a border without bends: the area between it and the straight line, its length, points of quadrature.
  void add_smooth_border(std::int32_t from, std::int32_t to, std::int32_t left, std::int32_t right) {
    double area = 0;
    double along = 0;
    for (const BorderCurve::Node& node : curve_.nodes()) {
      const double part = node.weight * node.point.stretch * curve_.length();
      const double beside = node.weight * node.point.height * curve_.length();
      area += beside;
      along += part;
      if (samples_)
        result_.samples.push_back({left, right, node.point.place, part,
                                   node.point.place - 0.5 * node.point.height * curve_.normal(), beside});
    }
    // A border that lies on the left of its straight line takes from the cell there.
    areas_.emplace_back(left, -area);
    areas_.emplace_back(right, area);
    result_.borders.push_back({from, to, left, right, along});
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
  CutFace& result_;
  std::vector<InnerSite> sites_;
  double size_;
  BorderCurve curve_;
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
