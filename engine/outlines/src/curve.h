#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace supple::outlines {

using Point = Eigen::Vector2d;
using Points = std::vector<Point>;
using Map = Eigen::Affine2d;

// What curves are made of. Each piece begins where the one before ends.

struct Line {
  Point to;
};

/// A cubic Bezier curve.
struct Cubic {
  Point first, second, to;
};

/// centre + cosine cos t + sine sin t for t from `from` to `from + sweep`: an affine image of a circle's arc.
struct Arc {
  Point centre, cosine, sine;
  double from = 0, sweep = 0;
  Point to;
};

/// A rational B-spline of control points.size() + degree + 1 knots.
struct Spline {
  int degree = 3;
  std::vector<double> knots;
  Points control_points;
  std::vector<double> weights;  ///< empty where all are 1
};

using Piece = std::variant<Line, Cubic, Arc, Spline>;

enum class FillRule { nonzero, evenodd };

struct Clip;

/// A curve of a drawing.
struct Curve {
  Point begin = Point::Zero();
  std::vector<Piece> pieces;
  bool closed = false;             ///< by a straight line, where its ends are apart
  std::vector<std::string> names;  ///< of `Outline`
  std::string group;               ///< only curves of one group are joined
  std::string what;                ///< "<path id="heel"> of line 12", for messages
  bool is_filled = false;          ///< if so, an open one is closed by a straight line unless others close it
  FillRule rule = FillRule::evenodd;
  std::size_t element = 0;  ///< filled curves of one element are filled together
  std::shared_ptr<const Clip> clip;
};

/// An area that cuts what is drawn: the union of the elements of its curves, within the one outside of it.
struct Clip {
  std::vector<Curve> curves;
  std::shared_ptr<const Clip> outer;
};

/// Calls visit(point) for points around which the piece is bent: it lies within their hull.
template <class Visit>
void for_each_control_point(const Piece& piece, const Visit& visit) {
  if (const auto* line = std::get_if<Line>(&piece)) return visit(line->to);
  if (const auto* cubic = std::get_if<Cubic>(&piece)) {
    for (const Point& p : {cubic->first, cubic->second, cubic->to}) visit(p);
  } else if (const auto* arc = std::get_if<Arc>(&piece)) {
    for (const double a : {-1, 1}) {
      for (const double b : {-1, 1}) visit(Point(arc->centre + a * arc->cosine + b * arc->sine));
    }
  } else {
    for (const Point& p : std::get<Spline>(piece).control_points) visit(p);
  }
}

/// The image of a curve.
void transform(Curve& curve, const Map& map);

/// A straight line, or a part of a circle, from a to b, whose bulge is the tangent of a quarter of its angle:
/// counterclockwise where it is positive.
Piece bulge(const Point& a, const Point& b, double bulge);

/// Turns curves into polylines, of which there are at most `most_corners` corners.
class Flattener {
 public:
  static constexpr std::size_t most_corners = 100'000;

  /// In the unit of the curves.
  explicit Flattener(double tolerance) : tolerance_(tolerance) {}

  /// The curve's corners, without a second one for a closed curve's beginning. Throws "outline.too_large".
  Points flatten(const Curve& curve);

  void set_tolerance(double tolerance) { tolerance_ = tolerance; }
  /// Of the curves since it was asked for the last time.
  double take_chord_error() { return std::exchange(chord_error_, 0.0); }

 private:
  void append(const Line& line);
  void append(const Cubic& cubic);
  void append(const Arc& arc);
  void append(const Spline& spline);
  void append_span(const Spline& spline, double t0, double t1, const Point& a, const Point& b, int depth);
  std::size_t parts(double exact) const;
  void add(const Point& point);

  double tolerance_;
  double chord_error_ = 0;
  std::size_t corners_ = 0;
  Points points_;
};

/// The spline's point at a parameter; de Boor's algorithm.
Point point_of(const Spline& spline, double t);

}  // namespace supple::outlines
