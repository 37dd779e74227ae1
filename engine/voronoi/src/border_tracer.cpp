#include "border_tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "border_rounding.h"
#include "planar_cross.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;

constexpr int max_curve_steps = 60;
constexpr int max_height_steps = 8;
/// Relative to the distance: rounding error of the lengths of two paths.
constexpr double length_rounding = 1e-14;

}  // namespace

void BorderTracer::set_chord(const Vector2d& begin, const Vector2d& end) {
  begin_ = begin;
  chord_ = end - begin;
  length_ = chord_.norm();
  if (length_ > min_curve_length * size_) normal_ = Vector2d(-chord_.y(), chord_.x()) / length_;
  part_sources_ = nullptr;
}

int BorderTracer::set_sites(std::int32_t left, std::int32_t right, const Active& active) {
  left_ = left;
  right_ = right;
  if (!(length_ > min_curve_length * size_)) return 0;
  // Borders must have bulges below a quarter of their length; others are divided first.
  const Vector2d middle = begin_ + 0.5 * chord_;
  const double radius = 0.6 * length_;
  const double tolerance = same_image * size_;
  return distances_.prune_site(active, left, middle, radius, tolerance, from_left_) +
         distances_.prune_site(active, right, middle, radius, tolerance, from_right_);
}

std::optional<PseudoSources> BorderTracer::straight_sources() const {
  const surface::FaceArrival* from_left = straight_arrival(from_left_);
  const surface::FaceArrival* from_right = straight_arrival(from_right_);
  if (from_left == nullptr || from_right == nullptr) return std::nullopt;
  return PseudoSources{PseudoSource{from_left->image, from_left->sigma},
                       PseudoSource{from_right->image, from_right->sigma}};
}

/// The arrival, of several from one image, that reaches both ends of the border straight, and so all of it; null if
/// there is none.
const surface::FaceArrival* BorderTracer::straight_arrival(const Active& active) const {
  const Vector2d end = begin_ + chord_;
  for (const std::int32_t i : active) {
    const surface::FaceArrival& arrival = distances_.arrivals()[static_cast<std::size_t>(i)];
    if (&arrival.turns_at(begin_) == &arrival.image && &arrival.turns_at(end) == &arrival.image) return &arrival;
  }
  return nullptr;
}

/// Each step goes to the height that is equally far from the present pseudo-sources, until these stay
/// the same. The steps are bracketed, because they may alternate about a bend.
bool BorderTracer::find_point(double fraction, BorderPoint& point, const PseudoSources* guess) const {
  const Vector2d base = begin_ + fraction * chord_;
  // Lengths are defined beyond the face too, where they may be equal at other places.
  auto [below, above] = heights_within_face(base);
  if (guess != nullptr && part_sources_ == nullptr)
    point.height = equidistant_height(*guess, base, point.height, below, above);
  for (int step = 0; step < max_curve_steps; ++step) {
    point.place = base + point.height * normal_;
    measure(point);
    const double gap = point.left.distance - point.right.distance;
    const Vector2d gradient = point.left.gradient - point.right.gradient;
    const double across = gradient.dot(normal_);
    if (!std::isfinite(gap)) return false;
    // Towards the left cell the left site gets nearer, unless both are equally near everywhere.
    if (!(across < 0)) return std::abs(gap) <= tie_gap * size_;
    point.stretch = gradient.norm() / -across;
    const double change = -gap / across;
    if (std::abs(change) <= curve_rounding * size_) return true;
    (gap > 0 ? below : above) = point.height;
    double next = point.height + change;
    if (part_sources_ == nullptr) next = equidistant_height(pseudo_sources_at(point), base, next, below, above);
    if (!(next > below && next < above)) next = 0.5 * (below + above);
    if (!(std::abs(next) < length_)) return false;
    if (next == point.height) return true;
    point.height = next;
  }
  return true;
}

void BorderTracer::measure(BorderPoint& point) const {
  if (part_sources_ == nullptr) {
    point.left = distances_.from_site(from_left_, left_, point.place);
    point.right = distances_.from_site(from_right_, right_, point.place);
    return;
  }
  const auto distance_from = [&](const PseudoSource& source) {
    const Vector2d from = point.place - source.place;
    const double length = from.norm();
    return SiteDistance{source.distance + length, length > 0 ? Vector2d(from / length) : Vector2d::Zero()};
  };
  point.left = distance_from((*part_sources_)[0]);
  point.right = distance_from((*part_sources_)[1]);
}

double BorderTracer::equidistant_height(const PseudoSources& sources, const Vector2d& base, double height, double below,
                                        double above) const {
  double found = height;
  for (int step = 0; step < max_height_steps; ++step) {
    const Vector2d place = base + found * normal_;
    const Vector2d from_left = place - sources[0].place;
    const Vector2d from_right = place - sources[1].place;
    const double left = from_left.norm();
    const double right = from_right.norm();
    const double across = from_left.dot(normal_) / left - from_right.dot(normal_) / right;
    const double change = (sources[1].distance + right - sources[0].distance - left) / across;
    found += change;
    if (!(across < 0) || !(found > below && found < above) || !(std::abs(found) < length_)) return height;
    if (std::abs(change) <= curve_rounding * size_) break;
  }
  return found;
}

std::pair<double, double> BorderTracer::heights_within_face(const Vector2d& base) const {
  double backwards = -std::numeric_limits<double>::infinity();
  double forwards = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector2d side = corners_[(i + 1) % 3] - corners_[i];
    const double inwards = cross(side, normal_);
    if (inwards == 0) continue;
    const double height = -std::max(cross(side, base - corners_[i]), 0.0) / inwards;
    if (inwards > 0)
      backwards = std::max(backwards, height);
    else
      forwards = std::min(forwards, height);
  }
  return {backwards - min_curve_length * size_, forwards + min_curve_length * size_};
}

PseudoSource BorderTracer::pseudo_source_of(const SiteDistance& shortest, const Vector2d& place) const {
  const surface::FaceArrival& arrival = distances_.arrivals()[static_cast<std::size_t>(shortest.arrival)];
  const Vector2d& turn = arrival.turns_at(place);
  return {turn, arrival.sigma + (turn - arrival.image).norm()};
}

PseudoSources BorderTracer::pseudo_sources_at(const BorderPoint& point) const {
  return {pseudo_source_of(point.left, point.place), pseudo_source_of(point.right, point.place)};
}

bool BorderTracer::is_on_border(const LabelledPoint& point, double tolerance) const {
  const double left = point.sources[0].length_to(point.place);
  const double right = point.sources[1].length_to(point.place);
  tolerance += length_rounding * left;
  return distances_.is_distance(from_left_, left_, point.place, left, tolerance) &&
         distances_.is_distance(from_right_, right_, point.place, right, tolerance);
}

}  // namespace supple::voronoi
