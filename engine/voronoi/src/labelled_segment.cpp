#include "labelled_segment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "equal_length_roots.h"
#include "planar_cross.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;
using surface::FaceArrival;

/// Fraction of the segment: shorter parts are not looked for.
constexpr double shortest_part = 1e-13;
/// Relative to the distance: sites this close to each other are equally near.
constexpr double tie = 1e-12;
/// Relative to the distance: a part in which another site is nearer by no more than this is the present site's. It is
/// some hundred times what rounding does to lengths, so that along a border that coincides with the segment sites do
/// not take turns by their last digits.
constexpr double indistinguishable = 1e-13;
/// Up to so many arrivals are told apart by all roots of their differences.
constexpr std::size_t max_straight = 24;
/// Divisions of a segment: sites that are not told apart by then lie almost in one place and are equally near.
constexpr int max_parts = 1024;
/// Halvings after which equal labels at both ends of a part are believed, and after which ties are looked for.
constexpr int deep = 12;
constexpr int tie_depth = 6;
constexpr int max_root_steps = 80;

class Labeller {
 public:
  Labeller(const FaceDistances& distances, const Vector2d& from, const Vector2d& to, LabelledSegment& result)
      : distances_(distances), from_(from), way_(to - from), length_(way_.norm()), result_(result) {}

  void label(const Active& active, double begin, double end, int depth) {
    Active kept;
    const double middle = 0.5 * (begin + end);
    const double radius = 0.5 * (end - begin) * length_;
    const Nearest nearest = distances_.prune(active, at(middle), radius, kept);
    if (kept.size() > 2) drop_longer(kept, begin, end);
    if (distances_.of_one_site(kept)) return change_to(nearest.site, begin);
    if (kept.size() <= max_straight) {
      const double turning = turning_fraction(kept, begin, end);
      if (turning == end) return label_straight(kept, begin, end);
      label(kept, begin, turning, depth + 1);
      return label(kept, turning, end, depth + 1);
    }
    if (!(end - begin > shortest_part) || ++divisions_ > max_parts) return change_to(nearest.site, begin);
    if (depth >= tie_depth && tied(kept, {begin, middle, end})) {
      if (!has(kept, result_.sites.back())) change_to(nearest.site, begin);
      return;
    }
    if (depth >= deep && two_sites(kept)) return label_deep(kept, begin, end);
    label(kept, begin, middle, depth + 1);
    label(kept, middle, end, depth + 1);
  }

  /// The part up to the end is the site's that the end is given.
  void end_with(std::int32_t site) { change_to(site, 1); }

 private:
  /// What an arrival is where its paths turn nowhere or all at one place.
  struct StraightArrival {
    Vector2d image;
    double sigma;
    std::int32_t source;

    double length_to(const Vector2d& point) const { return sigma + (point - image).norm(); }
  };

  /// From `fraction` on the nearest site is this one, or from where it has been so by no more than rounding.
  void change_to(std::int32_t site, double fraction) {
    append(pending_site_ == site ? pending_fraction_ : fraction, site);
    pending_site_ = -1;
  }

  void append(double share, std::int32_t site) {
    if (result_.sites.back() == site) return;
    if (!result_.cuts.empty() && !(share > result_.cuts.back())) {
      // The part before has no length.
      result_.sites.back() = site;
      if (result_.sites[result_.sites.size() - 2] == site) {
        result_.sites.pop_back();
        result_.cuts.pop_back();
      }
      return;
    }
    result_.cuts.push_back(share);
    result_.sites.push_back(site);
  }

  Vector2d at(double share) const { return from_ + share * way_; }

  bool has(const Active& active, std::int32_t site) const {
    return std::any_of(active.begin(), active.end(),
                       [&](std::int32_t i) { return distances_.arrivals()[i].source == site; });
  }

  bool two_sites(const Active& active) const {
    const auto& arrivals = distances_.arrivals();
    const std::int32_t first = arrivals[active.front()].source;
    std::int32_t second = first;
    for (const std::int32_t i : active) {
      const std::int32_t site = arrivals[i].source;
      if (site == first || site == second) continue;
      if (second != first) return false;
      second = site;
    }
    return true;
  }

  /// Drops arrivals of which another is shorter at both ends of a part, and so all along: two images that are equally
  /// far from their sites are equally near at one place of a line at most.
  void drop_longer(Active& active, double begin, double end) const {
    distances_.charge(active.size() * active.size());
    const Vector2d first = at(begin);
    const Vector2d last = at(end);
    for (std::size_t j = 0; j < active.size(); ++j) {
      const FaceArrival& by = distances_.arrivals()[active[j]];
      if (&by.turns_at(first) != &by.image || &by.turns_at(last) != &by.image) continue;
      const double at_first = (first - by.image).squaredNorm();
      const double at_last = (last - by.image).squaredNorm();
      for (std::size_t i = active.size(); i-- > 0;) {
        const FaceArrival& other = distances_.arrivals()[active[i]];
        if (i == j || other.sigma != by.sigma || !((first - other.image).squaredNorm() > at_first * (1 + tie)) ||
            !((last - other.image).squaredNorm() > at_last * (1 + tie)))
          continue;
        active.erase(active.begin() + static_cast<std::ptrdiff_t>(i));
        if (i < j) --j;
      }
    }
  }

  /// Where in a part paths of an arrival begin to turn at an end of their bundle or cease to: of several such places
  /// the one nearest to the middle, `end` where there is none.
  double turning_fraction(const Active& active, double begin, double end) const {
    distances_.charge(active.size());
    const double middle = 0.5 * (begin + end);
    double least = 0.5 * (end - begin) - shortest_part;  // not at an end
    double found = end;
    for (const std::int32_t i : active) {
      const FaceArrival& arrival = distances_.arrivals()[i];
      if (arrival.everywhere) continue;
      for (const Vector2d& edge : {Vector2d(arrival.begin - arrival.image), Vector2d(arrival.end - arrival.image)}) {
        const double fraction = cross(edge, arrival.image - from_) / cross(edge, way_);
        if (!(std::abs(fraction - middle) < least)) continue;
        least = std::abs(fraction - middle);
        found = fraction;
      }
    }
    return found;
  }

  bool tied(const Active& active, const std::array<double, 3>& shares) const {
    for (const double share : shares) {
      const Vector2d point = at(share);
      const double least = distances_.nearest(active, point).distance;
      for (const std::int32_t i : active) {
        const double own = distances_.from_site(active, distances_.arrivals()[i].source, point).distance;
        if (own > least + tie * least) return false;
      }
    }
    return true;
  }

  /// Arrivals that turn at one place all along or nowhere: between two successive roots of their differences one site
  /// is the nearest.
  void label_straight(const Active& active, double begin, double end) {
    straight_.clear();
    const Vector2d middle = at(0.5 * (begin + end));
    for (const std::int32_t i : active) {
      const FaceArrival& arrival = distances_.arrivals()[i];
      const Vector2d& turn = arrival.turns_at(middle);
      straight_.push_back({turn, arrival.sigma + (turn - arrival.image).norm(), arrival.source});
    }
    std::array<double, max_straight*(max_straight - 1) + 1> cuts;
    std::size_t count = 0;
    for (std::size_t i = 1; i < straight_.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) count = add_roots(straight_[i], straight_[j], begin, end, cuts, count);
    std::sort(cuts.begin(), cuts.begin() + static_cast<std::ptrdiff_t>(count));
    cuts[count] = end;
    double before = begin;
    for (std::size_t i = 0; i <= count; ++i) {
      if (cuts[i] > before) label_between(before, cuts[i]);
      before = std::max(before, cuts[i]);
    }
  }

  /// A part along which one site is the nearest: it stays the present one's where that is as near up to rounding.
  void label_between(double begin, double end) {
    const Vector2d point = at(0.5 * (begin + end));
    const std::int32_t present = result_.sites.back();
    Nearest nearest{std::numeric_limits<double>::infinity(), -1};
    double own = std::numeric_limits<double>::infinity();
    for (const StraightArrival& arrival : straight_) {
      const double length = arrival.length_to(point);
      if (length < nearest.distance) nearest = {length, arrival.source};
      if (arrival.source == present) own = std::min(own, length);
    }
    if (nearest.site == present) {
      pending_site_ = -1;
    } else if (own - nearest.distance > indistinguishable * nearest.distance) {
      change_to(nearest.site, begin);
    } else if (pending_site_ != nearest.site) {
      pending_site_ = nearest.site;
      pending_fraction_ = begin;
    }
  }

  /// Where two arrivals of different sites are equally long in a part.
  template <std::size_t size>
  std::size_t add_roots(const StraightArrival& a, const StraightArrival& b, double begin, double end,
                        std::array<double, size>& cuts, std::size_t count) const {
    if (a.source == b.source) return count;
    const LineRoots roots = equal_length_roots(a.image, b.image, b.sigma - a.sigma, from_, way_);
    for (std::size_t i = 0; i < roots.count; ++i) {
      const double fraction = roots.fractions[i];
      if (fraction > begin && fraction < end) cuts[count++] = polished(a, b, fraction, begin, end);
    }
    return count;
  }

  /// A root with the digits that its closed form has lost.
  double polished(const StraightArrival& a, const StraightArrival& b, double share, double begin, double end) const {
    const Vector2d unit = way_ / length_;
    for (int i = 0; i < 3; ++i) {
      const Vector2d point = at(share);
      const Vector2d from_a = point - a.image;
      const Vector2d from_b = point - b.image;
      const double slope = (from_a.dot(unit) / from_a.norm() - from_b.dot(unit) / from_b.norm()) * length_;
      const double next = share - (a.length_to(point) - b.length_to(point)) / slope;
      if (!(next > begin && next < end) || !(std::abs(next - share) < 1e-3 * (end - begin))) break;
      share = next;
    }
    return share;
  }

  /// Two sites and several arrivals, of which more than one may be needed: the cut between different ends by halving.
  void label_deep(const Active& kept, double begin, double end) {
    const std::int32_t first = distances_.nearest(kept, at(begin)).site;
    const std::int32_t last = distances_.nearest(kept, at(end)).site;
    change_to(first, begin);
    if (first == last) return;
    for (int i = 0; i < max_root_steps && end - begin > 1e-16; ++i) {
      const double middle = 0.5 * (begin + end);
      if (!(middle > begin && middle < end)) break;
      (distances_.nearest(kept, at(middle)).site == first ? begin : end) = middle;
    }
    change_to(last, end);
  }

  const FaceDistances& distances_;
  Vector2d from_;
  Vector2d way_;
  double length_;
  LabelledSegment& result_;
  std::vector<StraightArrival> straight_;
  /// The site that has been nearest since some place, by no more than rounding; -1 where the present one is nearest.
  std::int32_t pending_site_ = -1;
  double pending_fraction_ = 0;
  int divisions_ = 0;
};

}  // namespace

LabelledSegment label_segment(const FaceDistances& distances, const Active& active, const Vector2d& from,
                              const Vector2d& to, std::int32_t site_at_from, std::int32_t site_at_to) {
  LabelledSegment result;
  result.sites.push_back(site_at_from);
  Labeller labeller(distances, from, to, result);
  labeller.label(active, 0, 1, 0);
  labeller.end_with(site_at_to);
  for (const double share : result.cuts)
    result.distances.push_back(distances.nearest(active, from + share * (to - from)).distance);
  return result;
}

}  // namespace supple::voronoi
