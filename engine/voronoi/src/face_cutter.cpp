#include "face_cutter.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "bisector_borders.h"
#include "border_curve.h"
#include "face_vertex.h"
#include "planar_cross.h"
#include "planar_face.h"
#include "polygon_sides.h"
#include "quadrature.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;

/// Relative to the face: polygons whose longest side is below this are not divided any more.
constexpr double min_polygon_size = 1e-12;
/// Relative to the face: in smaller polygons a border that cannot be traced is taken as straight.
constexpr double min_traced_size = 1e-4;
/// Relative to the face: maximum distance of a border's points outside their polygon.
constexpr double outside_tolerance = 1e-9;
/// Maximum number of successive chords between parts of cells. After that polygons are halved, which is certain to make
/// them smaller.
constexpr int max_chords = 24;
/// Number of chords that a chord between two parts of one cell counts as if it crosses other cells. Chords next to it
/// would cross them too and leave slivers.
constexpr int missed_chord_count = 4;
/// Maximum number of divisions of a face. Polygons that are not simple by then cannot be resolved by rounding.
constexpr std::int64_t max_divisions = 1500;

/// Memory that a thread reuses for all faces.
struct CutterWorkspace {
  /// The memory for a polygon that is being divided.
  struct Level {
    std::vector<BoundaryVertex> boundary;
    std::vector<std::size_t> cuts;  ///< indices into `boundary` of the cuts
    Active remaining;
  };
  std::deque<Level> levels;
  std::vector<Vector2d> cut_places;
  BisectorBorders bisectors;
  std::vector<Vector2d> polygon;
  std::deque<BorderPolyline> lines;

  Level& level(int depth) {
    while (levels.size() <= static_cast<std::size_t>(depth)) levels.emplace_back();
    Level& found = levels[static_cast<std::size_t>(depth)];
    found.boundary.clear();
    found.cuts.clear();
    return found;
  }
  BorderPolyline& line(std::size_t number) {
    while (lines.size() <= number) lines.emplace_back();
    return lines[number];
  }
};

class Cutter {
 public:
  Cutter(const FaceDistances& distances, const std::array<Vector2d, 3>& corners, bool samples,
         const BorderAccuracy& accuracy, CutterWorkspace& workspace, CutFace& result)
      : distances_(distances),
        corners_(corners),
        result_(result),
        size_(longest_side(corners)),
        curve_(distances, corners, size_, accuracy),
        workspace_(workspace),
        cut_places_(workspace.cut_places),
        samples_(samples) {
    cut_places_.clear();
    for (const surface::FaceArrival& arrival : distances.arrivals())
      if (arrival.everywhere && arrival.sigma == 0) sites_.push_back({arrival.image, arrival.source});
  }

  /// Adds the place of the next cut of the face's sides.
  void add_cut(const Vector2d& place) { cut_places_.push_back(place); }

  /// Cuts a polygon. `depth` is the number of successive chords from the whole face to it.
  void cut(const Sides& sides, const Active& active, int depth) {
    Vector2d centre = Vector2d::Zero();
    for (const Side& side : sides) centre += side.from / static_cast<double>(sides.size());
    double radius = 0;
    double longest = 0;
    for (const Side& side : sides) {
      radius = std::max(radius, (side.from - centre).norm());
      longest = std::max(longest, (side.to - side.from).norm());
    }
    auto& [boundary, cuts, remaining] = workspace_.level(depth);
    for (const Side& side : sides) {
      boundary.push_back({side.from, BoundaryVertex::corner, side.sites.front()});
      for (std::size_t i = 0; i < side.cuts.size(); ++i) {
        cuts.push_back(boundary.size());
        boundary.push_back({place_of(side.cuts[i]), side.cuts[i], side.sites[i + 1]});
      }
    }
    const bool hidden = has_hidden_site(sides, boundary);
    if (!hidden && cuts.empty()) return add_whole(boundary);
    distances_.prune(active, centre, radius, remaining);
    if (cut_by_bisectors(sides, boundary, cuts, remaining)) return;
    const bool small = !(longest > min_polygon_size * size_) || result_.subdivisions >= max_divisions;
    const bool accept_failed = small || !(longest > min_traced_size * size_);
    if (!hidden && cuts.size() == 2 && cut_in_two(sides, boundary, cuts, remaining, accept_failed)) return;
    if (!hidden && cuts.size() >= 3 && all_differ(boundary, cuts)) {
      Vector2d place = centre;
      if (find_vertex(distances_, remaining, corners_, sides, boundary, cuts, longest, place) &&
          cut_at_vertex(sides, boundary, cuts, place, remaining, accept_failed))
        return;
    }
    if (result_.subdivisions >= max_divisions) result_.resolved = false;
    if (small) {
      if (cuts.empty()) return add_whole(boundary);
      cut_at_vertex(sides, boundary, cuts, centre, remaining, true);
      return;
    }
    BoundaryPlace begin;
    BoundaryPlace end;
    if (hidden || depth >= max_chords || !choose_chord(sides, begin, end))
      choose_middle_chord(sides, longest, begin, end);
    divide(sides, begin, end, remaining, depth);
  }

 private:
  /// A site within the face.
  struct InnerSite {
    Vector2d place;
    std::int32_t site;
  };
  const Vector2d& place_of(std::int32_t cut) const {
    return cut < 0 ? cut_places_[static_cast<std::size_t>(-1 - cut)]
                   : result_.points[static_cast<std::size_t>(cut)].place;
  }

  /// Whether a site lies in the polygon and its cell does not reach the sides.
  bool has_hidden_site(const Sides& sides, const std::vector<BoundaryVertex>& boundary) const {
    for (const InnerSite& inner : sites_) {
      if (std::any_of(boundary.begin(), boundary.end(),
                      [&](const BoundaryVertex& vertex) { return vertex.site == inner.site; }))
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

  void add_whole(const std::vector<BoundaryVertex>& boundary) {
    FacePiece piece;
    piece.site = boundary.front().site;
    for (const BoundaryVertex& vertex : boundary) piece.corners.push_back(vertex.place);
    add_piece(std::move(piece));
  }

  /// Adds a piece. Before the call, `piece.area` holds the area between its polygon and its borders.
  void add_piece(FacePiece piece) {
    double twice_area = 0;
    for (std::size_t i = 2; i < piece.corners.size(); ++i)
      twice_area += cross(piece.corners[i - 1] - piece.corners[0], piece.corners[i] - piece.corners[0]);
    piece.area += 0.5 * twice_area;
    if (piece.corners.size() < 2) return;
    // A piece between a side and a nearly straight border has only a corner at each end. A third one in the middle
    // makes a polygon of it.
    if (piece.corners.size() == 2) {
      piece.corners.insert(piece.corners.begin() + 1, 0.5 * (piece.corners[0] + piece.corners[1]));
      piece.arc_corners = {1};
    }
    result_.pieces.push_back(std::move(piece));
  }

  /// Begins the piece between two successive cuts, with its corners along the boundary.
  static FacePiece piece_between(const std::vector<BoundaryVertex>& boundary, const std::vector<std::size_t>& cuts,
                                 std::size_t i) {
    const std::size_t begin = cuts[i];
    const std::size_t end = i + 1 < cuts.size() ? cuts[i + 1] : cuts[0] + boundary.size();
    FacePiece piece;
    piece.site = boundary[begin].site;
    for (std::size_t k = begin; k <= end; ++k) piece.corners.push_back(boundary[k % boundary.size()].place);
    return piece;
  }

  /// Continues a piece along a border, which has the piece on its left or, with `backwards`, on its right.
  static void append_border(const BorderPolyline& line, bool backwards, FacePiece& piece) {
    const std::size_t count = line.points.size();
    for (std::size_t k = 0; k < count; ++k) {
      const BorderPolyline::Point& point = line.points[backwards ? count - 1 - k : k];
      if (point.on_arc) piece.arc_corners.push_back(static_cast<std::int32_t>(piece.corners.size()));
      piece.corners.push_back(point.place);
    }
    piece.area += backwards ? line.area : -line.area;
  }

  /// Traces a border within the polygon. Returns false if this fails. If it leaves the polygon, it is another border of
  /// the same sites, and the border is taken as straight.
  bool trace(const Sides& sides, const Vector2d& begin, const Vector2d& end, std::int32_t left, std::int32_t right,
             const Active& active, BorderPolyline& line) {
    trace_border(curve_, begin, end, left, right, active, samples_, line);
    const auto is_outside = [&](const BorderPolyline::Point& point) {
      return std::any_of(sides.begin(), sides.end(), [&](const Side& side) {
        const Vector2d along = side.to - side.from;
        return cross(along, point.place - side.from) < -outside_tolerance * size_ * along.norm();
      });
    };
    if (std::none_of(line.points.begin(), line.points.end(), is_outside)) return !line.failed;
    line.set_straight(left, right, begin, end, samples_);
    return false;
  }

  /// Cuts a polygon with two cells and one border. Returns false if the border cannot be traced, unless
  /// `accept_failed`.
  bool cut_in_two(const Sides& sides, const std::vector<BoundaryVertex>& boundary, const std::vector<std::size_t>& cuts,
                  const Active& active, bool accept_failed) {
    // The part that follows the first cut lies on the left of the line from the second cut to the first.
    const BoundaryVertex& to = boundary[cuts[0]];
    const BoundaryVertex& from = boundary[cuts[1]];
    BorderPolyline& line = workspace_.line(0);
    if (!trace(sides, from.place, to.place, to.site, from.site, active, line) && !accept_failed) return false;
    add_border(line, from.cut, to.cut, to.site, from.site);
    for (const std::size_t i : {0, 1}) {
      FacePiece piece = piece_between(boundary, cuts, i);
      append_border(line, i == 1, piece);
      add_piece(std::move(piece));
    }
    return true;
  }

  /// Cuts a polygon with a vertex from which borders lead to all cuts. Returns false if one cannot be traced, unless
  /// `accept_failed`.
  bool cut_at_vertex(const Sides& sides, const std::vector<BoundaryVertex>& boundary,
                     const std::vector<std::size_t>& cuts, const Vector2d& place, const Active& active,
                     bool accept_failed) {
    const auto right_of = [&](std::size_t i) { return boundary[cuts[(i + cuts.size() - 1) % cuts.size()]].site; };
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      const BoundaryVertex& to = boundary[cuts[i]];
      if (!trace(sides, place, to.place, to.site, right_of(i), active, workspace_.line(i)) && !accept_failed)
        return false;
    }
    const auto vertex = static_cast<std::int32_t>(result_.points.size());
    result_.points.push_back({place, distances_.nearest(active, place).distance, true});
    for (std::size_t i = 0; i < cuts.size(); ++i)
      add_border(workspace_.line(i), vertex, boundary[cuts[i]].cut, boundary[cuts[i]].site, right_of(i));
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      FacePiece piece = piece_between(boundary, cuts, i);
      append_border(workspace_.line((i + 1) % cuts.size()), true, piece);
      piece.corners.push_back(place);
      append_border(workspace_.line(i), false, piece);
      add_piece(std::move(piece));
    }
    return true;
  }

  /// Cuts a polygon in which all borders are bisectors. Returns false if they are not, or do not meet the cuts of the
  /// sides.
  bool cut_by_bisectors(const Sides& sides, const std::vector<BoundaryVertex>& boundary,
                        const std::vector<std::size_t>& cuts, const Active& active) {
    workspace_.polygon.clear();
    for (const Side& side : sides) workspace_.polygon.push_back(side.from);
    BisectorBorders& found = workspace_.bisectors;
    const auto first = static_cast<std::int32_t>(result_.points.size());
    if (!found.find(distances_, active, workspace_.polygon, boundary, cuts, first, size_)) return false;
    result_.points.insert(result_.points.end(), found.points().begin(), found.points().end());
    for (const FaceBorder& border : found.borders())
      add_straight_border(border.from, border.to, border.left, border.right);
    for (std::size_t image = 0; image < found.pieces(); ++image) {
      FacePiece piece;
      piece.site = found.site_of_piece(image);
      found.write_piece(
          image, [&](std::int32_t end) -> const Vector2d& { return place_of(end); }, piece.corners);
      if (piece.corners.size() > 2) add_piece(std::move(piece));
    }
    return true;
  }

  void add_straight_border(std::int32_t from, std::int32_t to, std::int32_t left, std::int32_t right) {
    const Vector2d& begin = place_of(from);
    const Vector2d chord = place_of(to) - begin;
    const double length = chord.norm();
    result_.borders.push_back({from, to, left, right, length});
    if (!samples_) return;
    for (std::size_t i = 0; i < three_nodes.size(); ++i) {
      const Vector2d place = begin + three_nodes[i] * chord;
      result_.samples.push_back({left, right, place, three_weights[i] * length, place, 0});
    }
  }

  /// Adds a border between two points, with its intermediate points.
  void add_border(const BorderPolyline& line, std::int32_t from, std::int32_t to, std::int32_t left,
                  std::int32_t right) {
    for (std::size_t i = 0; i < line.points.size(); ++i) {
      const auto number = static_cast<std::int32_t>(result_.points.size());
      result_.points.push_back({line.points[i].place, line.points[i].distance, false});
      result_.borders.push_back({from, number, left, right, line.lengths[i]});
      from = number;
    }
    result_.borders.push_back({from, to, left, right, line.lengths.back()});
    result_.samples.insert(result_.samples.end(), line.samples.begin(), line.samples.end());
  }

  /// Divides a polygon by the chord between two places on different sides, and cuts both parts.
  void divide(const Sides& sides, const BoundaryPlace& begin, const BoundaryPlace& end, const Active& active,
              int depth) {
    ++result_.subdivisions;
    auto [first_before, first_after] = split(sides[begin.side], begin.fraction);
    auto [last_before, last_after] = split(sides[end.side], end.fraction);
    const Vector2d from = first_before.to;
    const Vector2d to = last_before.to;
    const LabelledSegment labelled =
        label_segment(distances_, active, from, to, first_before.sites.back(), last_before.sites.back());
    Side chord{from, to, {}, labelled.cuts, labelled.sites};
    for (const double fraction : labelled.cuts) {
      chord.cuts.push_back(static_cast<std::int32_t>(result_.points.size()));
      const Vector2d place = from + fraction * (to - from);
      result_.points.push_back({place, distances_.nearest(active, place).distance, false});
    }
    Sides first_polygon{reversed(chord), std::move(first_after)};
    for (std::size_t k = begin.side + 1; k < end.side; ++k) first_polygon.push_back(sides[k]);
    first_polygon.push_back(std::move(last_before));
    Sides second_polygon{std::move(chord), std::move(last_after)};
    for (std::size_t k = end.side + 1; k < sides.size(); ++k) second_polygon.push_back(sides[k]);
    for (std::size_t k = 0; k < begin.side; ++k) second_polygon.push_back(sides[k]);
    second_polygon.push_back(std::move(first_before));
    const bool crosses_other_cells = labelled.sites.front() == labelled.sites.back() && !labelled.cuts.empty();
    depth += crosses_other_cells ? missed_chord_count : 1;
    cut(first_polygon, active, depth);
    cut(second_polygon, active, depth);
  }

  const FaceDistances& distances_;
  std::array<Vector2d, 3> corners_;
  CutFace& result_;
  std::vector<InnerSite> sites_;
  double size_;
  BorderCurve curve_;
  CutterWorkspace& workspace_;
  std::vector<Vector2d>& cut_places_;  ///< a member of workspace_
  bool samples_;
};

}  // namespace

CutFace cut_face(const FaceDistances& distances, const std::array<Vector2d, 3>& corners,
                 const std::array<const LabelledSegment*, 3>& sides, bool samples, const BorderAccuracy& accuracy) {
  CutFace result;
  static thread_local CutterWorkspace workspace;
  Cutter cutter(distances, corners, samples, accuracy, workspace, result);
  Sides whole(3);
  std::int32_t number = 0;
  for (int i = 0; i < 3; ++i) {
    const Vector2d& from = corners[i];
    const Vector2d& to = corners[(i + 1) % 3];
    whole[static_cast<std::size_t>(i)] = {from, to, {}, sides[i]->cuts, sides[i]->sites};
    for (const double fraction : sides[i]->cuts) {
      whole[static_cast<std::size_t>(i)].cuts.push_back(-1 - number++);
      cutter.add_cut(from + fraction * (to - from));
    }
  }
  Active active;
  distances.all(active);
  cutter.cut(whole, active, 0);
  return result;
}

}  // namespace supple::voronoi
