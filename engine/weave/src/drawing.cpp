#include "supple/weave/drawing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "supple/base/stop_pace.h"

namespace supple::weave {
namespace {

constexpr double margin = 2;           ///< around the picture, mm
constexpr double point_spacing = 0.5;  ///< length of a curved strand between two points of its picture, mm
constexpr const char* strand_colour = "#3a6ea5";
constexpr const char* fused_colour = "#b03030";
constexpr const char* sliding_colour = "#d08020";

std::string number(double x) {
  std::ostringstream text;
  text.precision(6);
  // Tiny numbers are rounding, and minus zero is written as zero.
  text << (std::abs(x) < 1e-9 ? 0.0 : x);
  return text.str();
}

class Picture {
 public:
  explicit Picture(const CancellationToken& cancellation) : pace_(cancellation) {}

  void line(const std::vector<Eigen::Vector2d>& points, double width, const char* colour, bool closed = false) {
    body_ << "<path fill=\"none\" stroke=\"" << colour << "\" stroke-width=\"" << number(width) << "\" d=\"";
    for (std::size_t i = 0; i < points.size(); ++i) {
      pace_.check();
      body_ << (i == 0 ? 'M' : 'L') << number(points[i][0]) << ' ' << number(-points[i][1]);
      box_.extend(points[i]);
    }
    body_ << (closed ? "Z" : "") << "\"/>\n";
  }
  void circle(const Eigen::Vector2d& at, double radius, const char* colour, bool filled) {
    body_ << "<circle cx=\"" << number(at[0]) << "\" cy=\"" << number(-at[1]) << "\" r=\"" << number(radius) << "\" ";
    if (filled) {
      body_ << "fill=\"" << colour << "\"/>\n";
    } else {
      body_ << "fill=\"none\" stroke=\"" << colour << "\" stroke-width=\"" << number(radius / 3) << "\"/>\n";
    }
    box_.extend(at);
  }
  std::string text() const {
    const Eigen::AlignedBox2d box = box_.isEmpty() ? Eigen::AlignedBox2d(Eigen::Vector2d(0, 0)) : box_;
    const Eigen::Vector2d size = box.sizes() + Eigen::Vector2d::Constant(2 * margin);
    std::ostringstream svg;
    svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"" << number(box.min()[0] - margin) << ' '
        << number(-box.max()[1] - margin) << ' ' << number(size[0]) << ' ' << number(size[1]) << "\" width=\""
        << number(size[0]) << "mm\" height=\"" << number(size[1]) << "mm\">\n"
        << body_.str() << "</svg>\n";
    return svg.str();
  }

 private:
  StopPace pace_;
  std::ostringstream body_;
  Eigen::AlignedBox2d box_;
};

}  // namespace

std::size_t polyline_size(const StrandCurve& curve) {
  return curve.straight() ? 2 : static_cast<std::size_t>(std::max(4.0, std::ceil(curve.length() / point_spacing))) + 1;
}

std::vector<Eigen::Vector2d> polyline(const StrandCurve& curve, const Execution& execution) {
  StopPace pace(execution.cancellation);
  std::vector<Eigen::Vector2d> points;
  points.reserve(polyline_size(curve));
  const auto count = static_cast<double>(polyline_size(curve) - 1);
  for (std::size_t i = 0; i + 1 < polyline_size(curve); ++i) {
    pace.check();
    points.push_back(curve.at(curve.length() * static_cast<double>(i) / count).position);
  }
  // The last point follows from the first one: at its length a closed or periodic curve begins its next period.
  points.emplace_back(curve.ends() == Ends::open ? curve.at(curve.length()).position
                                                 : Eigen::Vector2d(points.front() + curve.translation()));
  return points;
}

std::string to_svg(const Weave& weave, const Execution& execution) {
  Picture picture(execution.cancellation);
  if (weave.lattice) {
    const Eigen::Matrix2d& a = *weave.lattice;
    const Eigen::Vector2d origin =
        weave.strands.empty() ? Eigen::Vector2d(0, 0) : weave.strands[0].curve.at(0).position;
    picture.line({origin, origin + a.col(0), origin + a.col(0) + a.col(1), origin + a.col(1)}, 0.1, "#999999", true);
  }
  for (const Strand& strand : weave.strands) {
    execution.cancellation.throw_if_requested();
    picture.line(polyline(strand.curve, execution), 2 * strand.radius, strand_colour);
  }
  for (const Crossing& crossing : weave.crossings) {
    execution.cancellation.throw_if_requested();
    const Eigen::Vector2d at = rest_position(weave, crossing.members.front());
    const auto slider =
        std::find_if(crossing.members.begin(), crossing.members.end(), [](const auto& m) { return m.slides; });
    const double radius = 1.6 * weave.strands[static_cast<std::size_t>(crossing.members.front().strand)].radius;
    if (slider == crossing.members.end()) {
      picture.circle(at, radius, fused_colour, true);
      continue;
    }
    picture.circle(at, radius, sliding_colour, false);
    const Eigen::Vector2d t =
        weave.strands[static_cast<std::size_t>(slider->strand)].curve.at(slider->coordinate).first;
    picture.line({at - 2 * radius * t, at + 2 * radius * t}, radius / 3, sliding_colour);
  }
  return picture.text();
}

std::string to_svg(const std::vector<std::vector<Eigen::Vector3d>>& strands, double width) {
  const CancellationToken never;
  Picture picture(never);
  for (const auto& strand : strands) {
    std::vector<Eigen::Vector2d> flat;
    flat.reserve(strand.size());
    for (const Eigen::Vector3d& p : strand) flat.emplace_back(p.head<2>());
    picture.line(flat, width, strand_colour);
  }
  return picture.text();
}

}  // namespace supple::weave
