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

// The pieces of curves. Each piece begins where the one before ends.

struct Line {
  Point to;
};

/// A cubic Bezier curve.
struct Cubic {
  Point first, second, to;
};

/// The arc centre + cosine cos t + sine sin t for t from `from` to `from + sweep`: an affine image of a circle's arc.
struct Arc {
  Point centre, cosine, sine;
  double from = 0, sweep = 0;
  Point to;
};

/// A rational B-spline of control_points.size() + degree + 1 knots.
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
  bool closed = false;             ///< closed by a straight line if its ends differ
  std::vector<std::string> names;  ///< those of its `Outline`
  std::string group;               ///< curves of one group are joined before those of several
  std::string description;         ///< for messages: "<path> "heel" of line 12"
  bool is_filled = false;          ///< if so, an open curve is closed by a straight line unless others close it
  FillRule rule = FillRule::evenodd;
  std::size_t element = 0;  ///< number of its element, whose filled curves are filled together
  std::shared_ptr<const Clip> clip;
};

/// A clipping area: the union of its filled elements, intersected with the clipping area of the group around.
struct Clip {
  std::vector<Curve> curves;
  std::shared_ptr<const Clip> outer;  ///< null for none
};

/// Calls visit(point) for points whose convex hull, with the piece's first point, contains the piece.
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

/// Replaces a curve by its image under an affine map.
void transform(Curve& curve, const Map& map);

/// The circular arc from a to b whose bulge is the tangent of a quarter of its angle; a straight line if the bulge is
/// about 0. Arcs of positive bulge run counterclockwise.
Piece bulge(const Point& a, const Point& b, double bulge);

/// Turns curves into polylines, which have at most `max_corners` corners in all.
class Flattener {
 public:
  static constexpr std::size_t max_corners = 100'000;

  /// `tolerance` is the largest distance of a chord from its curve, in the unit of the curves.
  explicit Flattener(double tolerance) : tolerance_(tolerance) {}

  /// The curve's corners; the first one of a closed curve is not repeated. Throws "outline.too_large".
  Points flatten(const Curve& curve);

  void set_tolerance(double tolerance) { tolerance_ = tolerance; }
  /// The largest distance of a chord from its curve since the last call.
  double take_chord_error() { return std::exchange(chord_error_, 0.0); }

 private:
  void append(const Line& line);
  void append(const Cubic& cubic);
  void append(const Arc& arc);
  void append(const Spline& spline);
  void append_span(const Spline& spline, double t0, double t1, const Point& a, const Point& b, int depth);
  std::size_t part_count(double real_count) const;
  void add(const Point& point);

  double tolerance_;
  double chord_error_ = 0;
  std::size_t corners_ = 0;
  Points points_;
};

/// The spline's point at a parameter, by de Boor's algorithm.
Point point_of(const Spline& spline, double t);

}  // namespace supple::outlines
