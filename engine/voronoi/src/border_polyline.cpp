#include "border_polyline.h"

#include "planar_cross.h"
#include "quadrature.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;

/// Maximum successive divisions of a strongly curved part. Each leaves at most half of the part's change of direction.
constexpr int max_part_divisions = 6;

class PolylineTracer {
 public:
  PolylineTracer(BorderCurve& curve, std::int32_t left, std::int32_t right, bool samples, BorderPolyline& line)
      : curve_(curve), left_(left), right_(right), samples_(samples), line_(line) {}

  /// Adds the bend-free part of this number, which the curve has been set to. A strongly curved part is divided.
  void add_part(std::size_t number, const Vector2d& begin, const Vector2d& end, int divisions) {
    BorderBend top;
    if (divisions == 0 || !curve_.needs_division() || !curve_.find_top(top)) return add_flat_part(begin, end);
    curve_.set_part(number, begin, top.place);
    add_part(number, begin, top.place, divisions - 1);
    line_.points.push_back({top.place, top.distance, false});
    curve_.set_part(number, top.place, end);
    add_part(number, top.place, end, divisions - 1);
  }

 private:
  /// Adds the part's length, the area between it and its polyline, and its quadrature points.
  void add_flat_part(const Vector2d& begin, const Vector2d& end) {
    double area = 0;
    double length = 0;
    for (const BorderCurve::Node& node : curve_.nodes()) {
      const double part = node.weight * node.point.stretch * curve_.length();
      const double area_weight = node.weight * node.point.height * curve_.length();
      area += area_weight;
      length += part;
      if (samples_)
        line_.samples.push_back({left_, right_, node.point.place, part,
                                 node.point.place - 0.5 * node.point.height * curve_.normal(), area_weight});
    }
    const std::vector<BorderBend>& arc = curve_.arc();
    if (arc.empty()) {
      line_.area += area;
      line_.lengths.push_back(length);
      return;
    }
    const std::size_t first = line_.lengths.size();
    Vector2d before = begin;
    double polyline_length = 0;
    double twice_area = 0;  // twice the area between chord and polyline; negative if the polyline is on the left
    const auto add_segment = [&](const Vector2d& place) {
      line_.lengths.push_back((place - before).norm());
      polyline_length += line_.lengths.back();
      twice_area += cross(before - begin, place - begin);
      before = place;
    };
    for (const auto& [place, distance] : arc) {
      add_segment(place);
      line_.points.push_back({place, distance, true});
    }
    add_segment(end);
    for (std::size_t i = first; i < line_.lengths.size(); ++i) line_.lengths[i] *= length / polyline_length;
    line_.area += area + 0.5 * twice_area;
  }

  BorderCurve& curve_;
  std::int32_t left_;
  std::int32_t right_;
  bool samples_;
  BorderPolyline& line_;
};

}  // namespace

void BorderPolyline::set_straight(std::int32_t left, std::int32_t right, const Vector2d& begin, const Vector2d& end,
                                  bool with_samples) {
  points.clear();
  samples.clear();
  area = 0;
  failed = true;
  const double length = (end - begin).norm();
  lengths.assign(1, length);
  for (std::size_t i = 0; i < three_nodes.size() && with_samples; ++i) {
    const Vector2d place = begin + three_nodes[i] * (end - begin);
    samples.push_back({left, right, place, three_weights[i] * length, place, 0});
  }
}

void trace_border(BorderCurve& curve, const Vector2d& begin, const Vector2d& end, std::int32_t left, std::int32_t right,
                  const Active& active, bool samples, BorderPolyline& line) {
  line.points.clear();
  line.lengths.clear();
  line.samples.clear();
  line.area = 0;
  curve.set_border(begin, end, left, right, active);
  curve.find_bends(samples);
  PolylineTracer tracer(curve, left, right, samples, line);
  Vector2d before = begin;
  std::size_t part = 0;
  for (const auto& [bend, distance] : curve.bends()) {
    curve.set_part(part, before, bend);
    tracer.add_part(part++, before, bend, max_part_divisions);
    line.points.push_back({bend, distance, false});
    before = bend;
  }
  if (part > 0) curve.set_part(part, before, end);
  tracer.add_part(part, before, end, max_part_divisions);
  line.failed = curve.has_failed();
}

}  // namespace supple::voronoi
