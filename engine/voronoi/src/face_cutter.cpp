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
/// Points of Gauss-Legendre quadrature in [0, 1] along a part of a border.
constexpr std::array<double, 4> nodes{0.0694318442029737, 0.3300094782075719, 0.6699905217924281, 0.9305681557970263};
constexpr std::array<double, 4> weights{0.1739274225687269, 0.3260725774312731, 0.3260725774312731, 0.1739274225687269};

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
  Cutter(const FaceDistances& distances, const std::array<Vector2d, 3>& corners, CutFace& result)
      : distances_(distances), result_(result) {
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
    if (!hidden && cuts.empty()) return add_piece(round.front().site, round, 0, round.size(), nullptr);
    Active kept;
    distances_.prune(active, centre, radius, kept);
    if (!hidden && cuts.size() == 2) return cut_in_two(round, cuts, kept);
    const bool small = !(longest > smallest_triangle * size_);
    if (!hidden && cuts.size() >= 3 && all_differ(round, cuts)) {
      Vector2d place = centre;
      if (meet(sides, round, cuts, kept, longest, place)) return cut_at_vertex(round, cuts, place, kept);
    }
    if (small)
      return cuts.empty() ? add_piece(round.front().site, round, 0, round.size(), nullptr)
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

  /// The polygon of what lies between two cuts of the way round, and what is beyond the cuts: a Voronoi vertex or
  /// nothing.
  void add_piece(std::int32_t site, const std::vector<Stop>& round, std::size_t begin, std::size_t end,
                 const Vector2d* beyond) {
    FacePiece piece{site, {}};
    piece.corners.reserve(end - begin + 2);
    for (std::size_t i = begin; i < end; ++i) piece.corners.push_back(round[i % round.size()].place);
    if (beyond != nullptr) piece.corners.push_back(*beyond);
    double doubled = 0;
    for (std::size_t i = 2; i < piece.corners.size(); ++i)
      doubled += cross(piece.corners[i - 1] - piece.corners[0], piece.corners[i] - piece.corners[0]);
    areas_.emplace_back(site, 0.5 * doubled);
    result_.pieces.push_back(std::move(piece));
  }

  /// The piece between two neighbouring cuts, and what is beyond.
  void add_piece_between(const std::vector<Stop>& round, const std::vector<std::size_t>& cuts, std::size_t i,
                         const Vector2d* beyond) {
    const std::size_t begin = cuts[i];
    const std::size_t end = i + 1 < cuts.size() ? cuts[i + 1] : cuts[0] + round.size();
    add_piece(round[begin].site, round, begin, end + 1, beyond);
  }

  void cut_in_two(const std::vector<Stop>& round, const std::vector<std::size_t>& cuts, const Active& active) {
    for (std::size_t i = 0; i < 2; ++i) add_piece_between(round, cuts, i, nullptr);
    // What follows the first cut lies on the left of the way from the second cut to the first.
    add_border(round[cuts[1]].cut, round[cuts[0]].cut, round[cuts[0]].site, round[cuts[1]].site, active);
  }

  void cut_at_vertex(const std::vector<Stop>& round, const std::vector<std::size_t>& cuts, const Vector2d& place,
                     const Active& active) {
    const auto vertex = static_cast<std::int32_t>(result_.points.size());
    result_.points.push_back({place, distances_.nearest(active, place).distance, true});
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      add_piece_between(round, cuts, i, &place);
      const std::size_t before = (i + cuts.size() - 1) % cuts.size();
      add_border(vertex, round[cuts[i]].cut, round[cuts[i]].site, round[cuts[before]].site, active);
    }
  }

  /// A part of a border, the area between it and the straight line, and its length: where the two sites are equally
  /// near, over points of the line.
  void add_border(std::int32_t from, std::int32_t to, std::int32_t left, std::int32_t right, const Active& active) {
    const Vector2d begin = place_of(from);
    const Vector2d way = place_of(to) - begin;
    const double length = way.norm();
    double area = 0;
    double along = length;
    if (length > 1e-9 * size_) {
      const Vector2d normal(-way.y() / length, way.x() / length);
      double stretch = 0;
      double height = 0;
      bool curved = true;
      for (std::size_t i = 0; i < nodes.size() && curved; ++i) {
        double h = 0;
        double slope = 0;
        for (int step = 0; step < 6; ++step) {
          const Vector2d x = begin + nodes[i] * way + h * normal;
          const Slope a = distances_.from_site(active, left, x);
          const Slope b = distances_.from_site(active, right, x);
          const Vector2d gradient = a.gradient - b.gradient;
          const double across = gradient.dot(normal);
          if (!std::isfinite(a.distance + b.distance) || across == 0) {
            curved = false;
            break;
          }
          const double change = -(a.distance - b.distance) / across;
          h += change;
          slope = -gradient.dot(way) / (length * across);
          if (std::abs(change) <= 1e-14 * size_) break;
        }
        if (!(std::abs(h) < length) || !std::isfinite(slope)) curved = false;
        height += weights[i] * h;
        stretch += weights[i] * std::sqrt(1 + slope * slope);
      }
      if (curved) {
        area = height * length;
        along = stretch * length;
      }
    }
    // A border that lies on the left of its straight line takes from the cell there.
    areas_.emplace_back(left, -area);
    areas_.emplace_back(right, area);
    result_.borders.push_back({from, to, left, right, along});
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
  CutFace& result_;
  std::vector<Vector2d> cut_places_;
  std::vector<InnerSite> sites_;
  std::vector<std::pair<std::int32_t, double>> areas_;
  double size_ = 0;
};

}  // namespace

CutFace cut_face(const FaceDistances& distances, const std::array<Vector2d, 3>& corners,
                 const std::array<const LabelledSegment*, 3>& sides) {
  CutFace result;
  Cutter cutter(distances, corners, result);
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
