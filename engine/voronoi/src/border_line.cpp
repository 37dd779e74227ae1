#include "border_line.h"

#include "planar_cross.h"
#include "quadrature.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;

/// Divisions of a part that bulges much, each of which leaves half of its turn or less.
constexpr int max_part_divisions = 6;

class LineTracer {
 public:
  LineTracer(BorderCurve& curve, std::int32_t left, std::int32_t right, bool samples, BorderLine& line)
      : curve_(curve), left_(left), right_(right), samples_(samples), line_(line) {}

  /// Adds the part without bends that the curve has been laid along, which has this number. Where it bulges much it is
  /// divided.
  void add_part(std::size_t number, const Vector2d& begin, const Vector2d& end, int divisions) {
    BorderCurve::Bend top;
    if (divisions == 0 || !curve_.bulges() || !curve_.find_top(top)) return add_flat_part(begin, end);
    curve_.lay_part(number, begin, top.place);
    add_part(number, begin, top.place, divisions - 1);
    line_.points.push_back({top.place, top.distance, false});
    curve_.lay_part(number, top.place, end);
    add_part(number, top.place, end, divisions - 1);
  }

 private:
  /// Its length, the area between it and its polyline, and points of quadrature.
  void add_flat_part(const Vector2d& begin, const Vector2d& end) {
    double area = 0;
    double length = 0;
    for (const BorderCurve::Node& node : curve_.nodes()) {
      const double part = node.weight * node.point.stretch * curve_.length();
      const double beside = node.weight * node.point.height * curve_.length();
      area += beside;
      length += part;
      if (samples_)
        line_.samples.push_back({left_, right_, node.point.place, part,
                                 node.point.place - 0.5 * node.point.height * curve_.normal(), beside});
    }
    const std::vector<BorderCurve::Bend>& arc = curve_.arc();
    if (arc.empty()) {
      line_.beside += area;
      line_.lengths.push_back(length);
      return;
    }
    const std::size_t first = line_.lengths.size();
    Vector2d before = begin;
    double drawn = 0;
    double doubled = 0;  // area between the straight line and the polyline, negative where that lies on its left
    const auto go_to = [&](const Vector2d& place) {
      line_.lengths.push_back((place - before).norm());
      drawn += line_.lengths.back();
      doubled += cross(before - begin, place - begin);
      before = place;
    };
    for (const auto& [place, distance] : arc) {
      go_to(place);
      line_.points.push_back({place, distance, true});
    }
    go_to(end);
    for (std::size_t i = first; i < line_.lengths.size(); ++i) line_.lengths[i] *= length / drawn;
    line_.beside += area + 0.5 * doubled;
  }

  BorderCurve& curve_;
  std::int32_t left_;
  std::int32_t right_;
  bool samples_;
  BorderLine& line_;
};

}  // namespace

void BorderLine::take_straight(std::int32_t left, std::int32_t right, const Vector2d& begin, const Vector2d& end,
                               bool with_samples) {
  points.clear();
  samples.clear();
  beside = 0;
  lost = true;
  const double length = (end - begin).norm();
  lengths.assign(1, length);
  for (std::size_t i = 0; i < three_nodes.size() && with_samples; ++i) {
    const Vector2d place = begin + three_nodes[i] * (end - begin);
    samples.push_back({left, right, place, three_weights[i] * length, place, 0});
  }
}

void trace_border(BorderCurve& curve, const Vector2d& begin, const Vector2d& end, std::int32_t left, std::int32_t right,
                  const Active& active, bool samples, BorderLine& line) {
  line.points.clear();
  line.lengths.clear();
  line.samples.clear();
  line.beside = 0;
  curve.lay(begin, end, left, right, active);
  curve.find_bends(samples);
  LineTracer tracer(curve, left, right, samples, line);
  Vector2d before = begin;
  std::size_t part = 0;
  for (const auto& [bend, distance] : curve.bends()) {
    curve.lay_part(part, before, bend);
    tracer.add_part(part++, before, bend, max_part_divisions);
    line.points.push_back({bend, distance, false});
    before = bend;
  }
  if (part > 0) curve.lay_part(part, before, end);
  tracer.add_part(part, before, end, max_part_divisions);
  line.lost = curve.is_lost();
}

}  // namespace supple::voronoi
