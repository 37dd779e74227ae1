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

/// Fraction of the segment: shorter parts are not searched for.
constexpr double min_part = 1e-13;
/// Relative to the distance: sites whose distances differ by less are equally near.
constexpr double tie_tolerance = 1e-12;
/// Relative to the distance: a part in which another site is nearer by no more than this stays with the present site.
/// This is about a hundred times rounding: sites do not alternate along a border that coincides with the segment.
constexpr double min_advantage = 1e-13;
/// Maximum number of arrivals for which all roots of their differences are computed.
constexpr std::size_t max_straight_arrivals = 24;
/// Maximum number of divisions of a segment. Sites that cannot be told apart by then nearly coincide.
constexpr int max_segment_divisions = 1024;
/// Numbers of halvings after which equal sites at both ends of a part are trusted, and after which ties are searched
/// for.
constexpr int trusted_depth = 12;
constexpr int tie_depth = 6;
constexpr int max_root_steps = 80;

class Labeller {
 public:
  Labeller(const FaceDistances& distances, const Vector2d& from, const Vector2d& to, LabelledSegment& result)
      : distances_(distances), from_(from), direction_(to - from), length_(direction_.norm()), result_(result) {}

  /// Labels a part of the segment.
  void label(const Active& active, double begin, double end, int depth) {
    Active remaining;
    const double middle = 0.5 * (begin + end);
    const double radius = 0.5 * (end - begin) * length_;
    const Nearest nearest = distances_.prune(active, at(middle), radius, remaining);
    if (remaining.size() > 2) drop_longer(remaining, begin, end);
    if (distances_.are_of_one_site(remaining)) return switch_to(nearest.site, begin);
    if (remaining.size() <= max_straight_arrivals) {
      const double turning = turning_fraction(remaining, begin, end);
      if (turning == end) return label_straight(remaining, begin, end);
      label(remaining, begin, turning, depth + 1);
      return label(remaining, turning, end, depth + 1);
    }
    if (!(end - begin > min_part) || ++divisions_ > max_segment_divisions) return switch_to(nearest.site, begin);
    if (depth >= tie_depth && are_tied(remaining, {begin, middle, end})) {
      if (!contains_site(remaining, result_.sites.back())) switch_to(nearest.site, begin);
      return;
    }
    if (depth >= trusted_depth && are_of_two_sites(remaining)) return bisect_two_sites(remaining, begin, end);
    label(remaining, begin, middle, depth + 1);
    label(remaining, middle, end, depth + 1);
  }

  /// Lets the segment end with this site.
  void end_with(std::int32_t site) { switch_to(site, 1); }

 private:
  /// An arrival in a part of the segment in which all of its paths turn at one place or nowhere.
  struct StraightArrival {
    Vector2d image;
    double sigma;
    std::int32_t source;

    double length_to(const Vector2d& point) const { return sigma + (point - image).norm(); }
  };

  /// Begins the part of a site at `fraction`, or at pending_fraction_ if this is the pending site.
  void switch_to(std::int32_t site, double fraction) {
    append(pending_site_ == site ? pending_fraction_ : fraction, site);
    pending_site_ = -1;
  }

  void append(double fraction, std::int32_t site) {
    if (result_.sites.back() == site) return;
    if (!result_.cuts.empty() && !(fraction > result_.cuts.back())) {
      // The preceding part has no length.
      result_.sites.back() = site;
      if (result_.sites[result_.sites.size() - 2] == site) {
        result_.sites.pop_back();
        result_.cuts.pop_back();
      }
      return;
    }
    result_.cuts.push_back(fraction);
    result_.sites.push_back(site);
  }

  Vector2d at(double fraction) const { return from_ + fraction * direction_; }

  bool contains_site(const Active& active, std::int32_t site) const {
    return std::any_of(active.begin(), active.end(),
                       [&](std::int32_t i) { return distances_.arrivals()[i].source == site; });
  }

  bool are_of_two_sites(const Active& active) const {
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

  /// Drops arrivals that are longer than another one of the same sigma at both ends of a part. They are longer in
  /// between too, because two such arrivals are equally long at one place of a line at most.
  void drop_longer(Active& active, double begin, double end) const {
    distances_.charge(active.size() * active.size());
    const Vector2d first = at(begin);
    const Vector2d last = at(end);
    for (std::size_t j = 0; j < active.size(); ++j) {
      const FaceArrival& shorter = distances_.arrivals()[active[j]];
      if (&shorter.turns_at(first) != &shorter.image || &shorter.turns_at(last) != &shorter.image) continue;
      const double at_first = (first - shorter.image).squaredNorm();
      const double at_last = (last - shorter.image).squaredNorm();
      for (std::size_t i = active.size(); i-- > 0;) {
        const FaceArrival& other = distances_.arrivals()[active[i]];
        if (i == j || other.sigma != shorter.sigma ||
            !((first - other.image).squaredNorm() > at_first * (1 + tie_tolerance)) ||
            !((last - other.image).squaredNorm() > at_last * (1 + tie_tolerance)))
          continue;
        active.erase(active.begin() + static_cast<std::ptrdiff_t>(i));
        if (i < j) --j;
      }
    }
  }

  /// The place of a part, the one nearest to its middle, where the paths of an arrival begin or cease to turn at an end
  /// of their bundle; `end` if there is none.
  double turning_fraction(const Active& active, double begin, double end) const {
    distances_.charge(active.size());
    const double middle = 0.5 * (begin + end);
    double least = 0.5 * (end - begin) - min_part;  // places at the ends of the part do not count
    double found = end;
    for (const std::int32_t i : active) {
      const FaceArrival& arrival = distances_.arrivals()[i];
      if (arrival.everywhere) continue;
      for (const Vector2d& edge : {Vector2d(arrival.begin - arrival.image), Vector2d(arrival.end - arrival.image)}) {
        const double fraction = cross(edge, arrival.image - from_) / cross(edge, direction_);
        if (!(std::abs(fraction - middle) < least)) continue;
        least = std::abs(fraction - middle);
        found = fraction;
      }
    }
    return found;
  }

  /// Whether the sites of all arrivals are equally near at these places.
  bool are_tied(const Active& active, const std::array<double, 3>& fractions) const {
    for (const double fraction : fractions) {
      const Vector2d point = at(fraction);
      const double least = distances_.nearest(active, point).distance;
      for (const std::int32_t i : active) {
        const double own = distances_.from_site(active, distances_.arrivals()[i].source, point).distance;
        if (own > least + tie_tolerance * least) return false;
      }
    }
    return true;
  }

  /// Labels a part in which each arrival's paths turn at one place or nowhere. One site is the nearest between
  /// successive roots of the differences of lengths.
  void label_straight(const Active& active, double begin, double end) {
    straight_.clear();
    const Vector2d middle = at(0.5 * (begin + end));
    for (const std::int32_t i : active) {
      const FaceArrival& arrival = distances_.arrivals()[i];
      const Vector2d& turn = arrival.turns_at(middle);
      straight_.push_back({turn, arrival.sigma + (turn - arrival.image).norm(), arrival.source});
    }
    std::array<double, max_straight_arrivals*(max_straight_arrivals - 1) + 1> cuts;
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

  /// Labels a part along which one site is the nearest. The part stays with the present site if that is equally near up
  /// to rounding.
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
    } else if (own - nearest.distance > min_advantage * nearest.distance) {
      switch_to(nearest.site, begin);
    } else if (pending_site_ != nearest.site) {
      pending_site_ = nearest.site;
      pending_fraction_ = begin;
    }
  }

  /// Adds the places of a part where two arrivals of different sites are equally long.
  template <std::size_t size>
  std::size_t add_roots(const StraightArrival& a, const StraightArrival& b, double begin, double end,
                        std::array<double, size>& cuts, std::size_t count) const {
    if (a.source == b.source) return count;
    const LineRoots roots = equal_length_roots(a.image, b.image, b.sigma - a.sigma, from_, direction_);
    for (std::size_t i = 0; i < roots.count; ++i) {
      const double fraction = roots.fractions[i];
      if (fraction > begin && fraction < end) cuts[count++] = polished(a, b, fraction, begin, end);
    }
    return count;
  }

  /// Restores by Newton's method the digits that a root of the closed form has lost.
  double polished(const StraightArrival& a, const StraightArrival& b, double fraction, double begin, double end) const {
    const Vector2d unit = direction_ / length_;
    for (int i = 0; i < 3; ++i) {
      const Vector2d point = at(fraction);
      const Vector2d from_a = point - a.image;
      const Vector2d from_b = point - b.image;
      const double slope = (from_a.dot(unit) / from_a.norm() - from_b.dot(unit) / from_b.norm()) * length_;
      const double next = fraction - (a.length_to(point) - b.length_to(point)) / slope;
      if (!(next > begin && next < end) || !(std::abs(next - fraction) < 1e-3 * (end - begin))) break;
      fraction = next;
    }
    return fraction;
  }

  /// Labels a part with two sites and several arrivals. If the sites at its ends differ, the cut is found by bisection.
  void bisect_two_sites(const Active& remaining, double begin, double end) {
    const std::int32_t first = distances_.nearest(remaining, at(begin)).site;
    const std::int32_t last = distances_.nearest(remaining, at(end)).site;
    switch_to(first, begin);
    if (first == last) return;
    for (int i = 0; i < max_root_steps && end - begin > 1e-16; ++i) {
      const double middle = 0.5 * (begin + end);
      if (!(middle > begin && middle < end)) break;
      (distances_.nearest(remaining, at(middle)).site == first ? begin : end) = middle;
    }
    switch_to(last, end);
  }

  const FaceDistances& distances_;
  Vector2d from_;
  Vector2d direction_;
  double length_;
  LabelledSegment& result_;
  std::vector<StraightArrival> straight_;
  /// Nearest site since pending_fraction_, by no more than rounding; -1 if the present site is the nearest.
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
  for (const double fraction : result.cuts)
    result.distances.push_back(distances.nearest(active, from + fraction * (to - from)).distance);
  return result;
}

}  // namespace supple::voronoi
