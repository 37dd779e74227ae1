#include "face_cutter.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;

/// Relative to the face: triangles below are not halved any more.
constexpr double smallest_triangle = 1e-12;
/// Relative to the triangle: a Voronoi vertex may be this far outside.
constexpr double outside = 1e-9;
/// Relative to the distance: distances to the sites of a vertex differ by no more, and no other site is nearer by more.
constexpr double equidistance = 2e-13;
constexpr int most_newton_steps = 30;
/// Relative to the face: shorter parts of borders count as straight, and curves are found to this.
constexpr double shortest_curve = 1e-9;
constexpr double curve_rounding = 1e-13;
constexpr int most_curve_steps = 60;
/// Relative to the face: images closer than this are one.
constexpr double same_image = 1e-9;
/// Bends are found to this part of a border.
constexpr double bend_width = 1e-13;
/// Bends this near to an end are none: there it is not sure which way paths come.
constexpr double bend_margin = 1e-7;
constexpr int bend_samples = 8;
constexpr int most_changes = 12;  // of the ways along one part
/// Points of Gauss and Legendre's quadrature in [0, 1] along a part of a border.
constexpr std::array<double, 3> nodes{0.1127016653792583, 0.5, 0.8872983346207417};
constexpr std::array<double, 3> weights{5.0 / 18, 8.0 / 18, 5.0 / 18};

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// A side of a triangle: its cuts, by their number, and the sites between them.
struct Side {
  Vector2d from, to;
  std::vector<std::int32_t> cuts;
  std::vector<double> shares;
  std::vector<std::int32_t> sites;
};

Side reversed(const Side& side) {
  Side result{side.to, side.from, side.cuts, side.shares, side.sites};
  std::reverse(result.cuts.begin(), result.cuts.end());
  std::reverse(result.shares.begin(), result.shares.end());
  std::reverse(result.sites.begin(), result.sites.end());
  for (double& share : result.shares) share = 1 - share;
  return result;
}

/// The two halves of a side.
std::pair<Side, Side> halves(const Side& side) {
  const Vector2d middle = 0.5 * (side.from + side.to);
  Side first{side.from, middle, {}, {}, {}};
  Side second{middle, side.to, {}, {}, {}};
  const auto before =
      static_cast<std::size_t>(std::upper_bound(side.shares.begin(), side.shares.end(), 0.5) - side.shares.begin());
  for (std::size_t i = 0; i < side.shares.size(); ++i) {
    Side& half = i < before ? first : second;
    half.cuts.push_back(side.cuts[i]);
    half.shares.push_back(i < before ? 2 * side.shares[i] : 2 * side.shares[i] - 1);
  }
  first.sites.assign(side.sites.begin(), side.sites.begin() + static_cast<std::ptrdiff_t>(before) + 1);
  second.sites.assign(side.sites.begin() + static_cast<std::ptrdiff_t>(before), side.sites.end());
  return {first, second};
}

using Sides = std::array<Side, 3>;

/// What one meets on the way round a triangle: corners and cuts.
struct Stop {
  Vector2d place;
  std::int32_t cut = 0;    ///< number of the cut, `corner` for a corner
  std::int32_t site = -1;  ///< of what follows
  static constexpr std::int32_t corner = std::numeric_limits<std::int32_t>::min();
};

class Cutter {
 public:
  Cutter(const FaceDistances& distances, const std::array<Vector2d, 3>& corners, bool samples, CutFace& result)
      : distances_(distances), samples_(samples), result_(result) {
    for (const surface::FaceArrival& arrival : distances.arrivals())
      if (arrival.everywhere && arrival.sigma == 0) sites_.push_back({arrival.image, arrival.source});
    for (int i = 0; i < 3; ++i) size_ = std::max(size_, (corners[(i + 1) % 3] - corners[i]).norm());
  }

  /// Of a cut of a side of the face.
  void add_cut(const Vector2d& place) { cut_places_.push_back(place); }

  void cut(const Sides& sides, const Active& active) {
    const Vector2d centre = (sides[0].from + sides[1].from + sides[2].from) / 3;
    double radius = 0;
    double longest = 0;
    for (const Side& side : sides) {
      radius = std::max(radius, (side.from - centre).norm());
      longest = std::max(longest, (side.to - side.from).norm());
    }
    std::vector<Stop> round;
    std::vector<std::size_t> cuts;
    for (const Side& side : sides) {
      round.push_back({side.from, Stop::corner, side.sites.front()});
      for (std::size_t i = 0; i < side.cuts.size(); ++i) {
        cuts.push_back(round.size());
        round.push_back({place_of(side.cuts[i]), side.cuts[i], side.sites[i + 1]});
      }
    }
    const bool hidden = has_hidden_site(sides, round);
    if (!hidden && cuts.empty()) return add_piece(round.front().site, round, 0, round.size(), {});
    Active kept;
    distances_.prune(active, centre, radius, kept);
    if (!hidden && cuts.size() == 2) return cut_in_two(round, cuts, kept);
    const bool small = !(longest > smallest_triangle * size_);
    if (!hidden && cuts.size() >= 3 && all_differ(round, cuts)) {
      Vector2d place = centre;
      if (meet(sides, round, cuts, kept, longest, place)) return cut_at_vertex(round, cuts, place, kept);
    }
    if (small)
      return cuts.empty() ? add_piece(round.front().site, round, 0, round.size(), {})
                          : cut_at_vertex(round, cuts, centre, kept);
    halve(sides, kept);
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
  bool has_hidden_site(const Sides& sides, const std::vector<Stop>& round) const {
    for (const InnerSite& inner : sites_) {
      if (std::any_of(round.begin(), round.end(), [&](const Stop& stop) { return stop.site == inner.site; })) continue;
      bool inside = true;
      for (const Side& side : sides) inside = inside && cross(side.to - side.from, inner.place - side.from) >= 0;
      if (inside) return true;
    }
    return false;
  }

  static bool all_differ(const std::vector<Stop>& round, const std::vector<std::size_t>& cuts) {
    for (std::size_t i = 0; i < cuts.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (round[cuts[i]].site == round[cuts[j]].site) return false;
    return true;
  }

  /// Newton's method for the point at one distance from the sites of all cuts (thesis eq. 3.25). True if it lies in the
  /// triangle and no other site is nearer.
  bool meet(const Sides& sides, const std::vector<Stop>& round, const std::vector<std::size_t>& cuts,
            const Active& active, double longest, Vector2d& place) const {
    Vector2d x = place;
    double distance = 0;
    double error = std::numeric_limits<double>::infinity();
    const auto count = static_cast<Eigen::Index>(cuts.size());
    for (int step = 0; step < most_newton_steps; ++step) {
      const Slope first = distances_.from_site(active, round[cuts[0]].site, x);
      if (!std::isfinite(first.distance)) return false;
      distance = first.distance;
      double worst = 0;
      Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
      Vector2d right = Vector2d::Zero();
      Eigen::Matrix2d two = Eigen::Matrix2d::Zero();
      Vector2d gaps = Vector2d::Zero();
      for (Eigen::Index k = 1; k < count; ++k) {
        const Slope other = distances_.from_site(active, round[cuts[static_cast<std::size_t>(k)]].site, x);
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
    place = x;
    return true;
  }

  /// The polygon of what lies between two stops of the way round, and then `beyond`.
  void add_piece(std::int32_t site, const std::vector<Stop>& round, std::size_t begin, std::size_t end,
                 const std::vector<Vector2d>& beyond) {
    FacePiece piece{site, {}};
    piece.corners.reserve(end - begin + beyond.size());
    for (std::size_t i = begin; i < end; ++i) piece.corners.push_back(round[i % round.size()].place);
    piece.corners.insert(piece.corners.end(), beyond.begin(), beyond.end());
    double doubled = 0;
    for (std::size_t i = 2; i < piece.corners.size(); ++i)
      doubled += cross(piece.corners[i - 1] - piece.corners[0], piece.corners[i] - piece.corners[0]);
    areas_.emplace_back(site, 0.5 * doubled);
    result_.pieces.push_back(std::move(piece));
  }

  /// The piece between two neighbouring cuts, and what is beyond.
  void add_piece_between(const std::vector<Stop>& round, const std::vector<std::size_t>& cuts, std::size_t i,
                         const std::vector<Vector2d>& beyond) {
    const std::size_t begin = cuts[i];
    const std::size_t end = i + 1 < cuts.size() ? cuts[i + 1] : cuts[0] + round.size();
    add_piece(round[begin].site, round, begin, end + 1, beyond);
  }

  void cut_in_two(const std::vector<Stop>& round, const std::vector<std::size_t>& cuts, const Active& active) {
    // What follows the first cut lies on the left of the way from the second cut to the first.
    std::vector<Vector2d> bends =
        add_border(round[cuts[1]].cut, round[cuts[0]].cut, round[cuts[0]].site, round[cuts[1]].site, active);
    add_piece_between(round, cuts, 0, bends);
    std::reverse(bends.begin(), bends.end());
    add_piece_between(round, cuts, 1, bends);
  }

  void cut_at_vertex(const std::vector<Stop>& round, const std::vector<std::size_t>& cuts, const Vector2d& place,
                     const Active& active) {
    const auto vertex = static_cast<std::int32_t>(result_.points.size());
    result_.points.push_back({place, distances_.nearest(active, place).distance, true});
    std::vector<std::vector<Vector2d>> bends;  // from the vertex to each cut
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      const std::size_t before = (i + cuts.size() - 1) % cuts.size();
      bends.push_back(add_border(vertex, round[cuts[i]].cut, round[cuts[i]].site, round[cuts[before]].site, active));
    }
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      const std::vector<Vector2d>& next = bends[(i + 1) % cuts.size()];
      std::vector<Vector2d> beyond(next.rbegin(), next.rend());
      beyond.push_back(place);
      beyond.insert(beyond.end(), bends[i].begin(), bends[i].end());
      add_piece_between(round, cuts, i, beyond);
    }
  }

  /// A border as a function over the straight line between its ends.
  struct Curve {
    Vector2d begin, way, along, normal;
    std::int32_t left, right;
    double length;
  };
  /// A place of it.
  struct CurvePoint {
    Vector2d place = Vector2d::Zero();
    double height = 0;   ///< over the line
    double stretch = 1;  ///< how much longer than the line the border is here
    Slope left{}, right{};
  };

  /// A border between two points: where it bends because paths from one of its sites come another way, it has a point.
  /// Returns these.
  std::vector<Vector2d> add_border(std::int32_t from, std::int32_t to, std::int32_t left, std::int32_t right,
                                   const Active& active) {
    Curve curve;
    curve.begin = place_of(from);
    curve.way = place_of(to) - curve.begin;
    curve.length = curve.way.norm();
    curve.left = left;
    curve.right = right;
    std::vector<Vector2d> bends;
    if (curve.length > shortest_curve * size_) {
      curve.along = curve.way / curve.length;
      curve.normal = Vector2d(-curve.along.y(), curve.along.x());
      if (several_ways(left, active) || several_ways(right, active)) find_all_bends(curve, active, bends);
    }
    std::int32_t before = from;
    for (const Vector2d& bend : bends) {
      const auto number = static_cast<std::int32_t>(result_.points.size());
      result_.points.push_back({bend, distances_.nearest(active, bend).distance, false});
      add_smooth_border(before, number, left, right, active);
      before = number;
    }
    add_smooth_border(before, to, left, right, active);
    return bends;
  }

  bool same_ways(const CurvePoint& a, const CurvePoint& b) const {
    const double tolerance = same_image * size_;
    return distances_.same_paths(a.left.arrival, a.place, b.left.arrival, b.place, tolerance) &&
           distances_.same_paths(a.right.arrival, a.place, b.right.arrival, b.place, tolerance);
  }

  /// Whether paths from a site come from more than one image.
  bool several_ways(std::int32_t site, const Active& active) const {
    const surface::FaceArrival* first = nullptr;
    for (const std::int32_t i : active) {
      const surface::FaceArrival& arrival = distances_.arrivals()[i];
      if (arrival.source != site) continue;
      if (first == nullptr) first = &arrival;
      if ((arrival.image - first->image).norm() > same_image * size_) return true;
    }
    return false;
  }

  void find_all_bends(const Curve& curve, const Active& active, std::vector<Vector2d>& bends) const {
    CurvePoint before;
    double begin = bend_margin;
    if (!on_curve(curve, begin, active, before)) return;
    for (int i = 1; i <= bend_samples; ++i) {
      const double end = i == bend_samples ? 1 - bend_margin : static_cast<double>(i) / bend_samples;
      CurvePoint after;
      if (!on_curve(curve, end, active, after)) return;
      find_bends(curve, begin, before, end, after, most_changes, active, bends);
      begin = end;
      before = after;
    }
  }

  /// Halves until it has both sides of a place where paths change.
  void find_bends(const Curve& curve, double begin, const CurvePoint& first, double end, const CurvePoint& last,
                  int changes, const Active& active, std::vector<Vector2d>& bends) const {
    if (changes == 0 || same_ways(first, last)) return;
    double low = begin;
    double high = end;
    CurvePoint after = last;
    while (high - low > bend_width) {
      const double middle = 0.5 * (low + high);
      CurvePoint point;
      if (!on_curve(curve, middle, active, point)) return;
      if (same_ways(first, point)) {
        low = middle;
      } else {
        high = middle;
        after = point;
      }
    }
    bends.push_back(after.place);
    find_bends(curve, high, after, end, last, changes - 1, active, bends);
  }

  /// A part of a border without bends: the area between it and the straight line, its length, points of quadrature.
  void add_smooth_border(std::int32_t from, std::int32_t to, std::int32_t left, std::int32_t right,
                         const Active& active) {
    Curve curve;
    curve.begin = place_of(from);
    curve.way = place_of(to) - curve.begin;
    curve.length = curve.way.norm();
    curve.left = left;
    curve.right = right;
    std::array<CurvePoint, nodes.size()> points;
    bool curved = curve.length > shortest_curve * size_;
    if (curved) {
      curve.along = curve.way / curve.length;
      curve.normal = Vector2d(-curve.along.y(), curve.along.x());
    }
    for (std::size_t i = 0; i < nodes.size() && curved; ++i)
      curved = on_curve(curve, nodes[i], active, points[i]) && std::abs(points[i].height) < curve.length;
    double area = 0;
    double along = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (!curved) points[i] = {curve.begin + nodes[i] * curve.way};
      const double part = weights[i] * points[i].stretch * curve.length;
      area += weights[i] * points[i].height * curve.length;
      along += part;
      if (samples_) result_.samples.push_back({left, right, points[i].place, part});
    }
    // A border that lies on the left of its straight line takes from the cell there.
    areas_.emplace_back(left, -area);
    areas_.emplace_back(right, area);
    result_.borders.push_back({from, to, left, right, along});
  }

  /// The border over a point of its straight line: Newton's method, within a bracket once there is one, because it may
  /// go back and forth about a bend.
  bool on_curve(const Curve& curve, double share, const Active& active, CurvePoint& point) const {
    const Vector2d base = curve.begin + share * curve.way;
    point.height = 0;
    double below = -std::numeric_limits<double>::infinity();
    double above = std::numeric_limits<double>::infinity();
    for (int step = 0; step < most_curve_steps; ++step) {
      point.place = base + point.height * curve.normal;
      point.left = distances_.from_site(active, curve.left, point.place);
      point.right = distances_.from_site(active, curve.right, point.place);
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

  void halve(const Sides& sides, const Active& active) {
    ++result_.subdivisions;
    int longest = 0;
    for (int i = 1; i < 3; ++i) {
      if ((sides[i].to - sides[i].from).squaredNorm() > (sides[longest].to - sides[longest].from).squaredNorm())
        longest = i;
    }
    auto [first, second] = halves(sides[longest]);
    const Side& next = sides[(longest + 1) % 3];
    const Side& last = sides[(longest + 2) % 3];
    // From the middle of the longest side to the corner across.
    const LabelledSegment labelled =
        label_segment(distances_, active, first.to, next.to, second.sites.front(), next.sites.back());
    Side across{first.to, next.to, {}, labelled.cuts, labelled.sites};
    for (const double share : labelled.cuts) {
      across.cuts.push_back(static_cast<std::int32_t>(result_.points.size()));
      const Vector2d place = across.from + share * (across.to - across.from);
      result_.points.push_back({place, distances_.nearest(active, place).distance, false});
    }
    const Side back = reversed(across);
    // `first` ends where `across` begins: its last site is that of `second`'s begin unless the cut is right there.
    cut({std::move(first), std::move(across), last}, active);
    cut({std::move(second), next, back}, active);
  }

  const FaceDistances& distances_;
  bool samples_;
  CutFace& result_;
  std::vector<Vector2d> cut_places_;
  std::vector<InnerSite> sites_;
  std::vector<std::pair<std::int32_t, double>> areas_;
  double size_ = 0;
};

}  // namespace

CutFace cut_face(const FaceDistances& distances, const std::array<Vector2d, 3>& corners,
                 const std::array<const LabelledSegment*, 3>& sides, bool samples) {
  CutFace result;
  Cutter cutter(distances, corners, samples, result);
  Sides whole;
  std::int32_t number = 0;
  for (int i = 0; i < 3; ++i) {
    const Vector2d& from = corners[i];
    const Vector2d& to = corners[(i + 1) % 3];
    whole[i] = {from, to, {}, sides[i]->cuts, sides[i]->sites};
    for (const double share : sides[i]->cuts) {
      whole[i].cuts.push_back(-1 - number++);
      cutter.add_cut(from + share * (to - from));
    }
  }
  Active active;
  distances.all(active);
  cutter.cut(whole, active);
  cutter.finish();
  return result;
}

}  // namespace supple::voronoi
