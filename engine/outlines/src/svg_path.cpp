#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "svg_attributes.h"

namespace supple::outlines {
namespace {

/// The arc of an ellipse with given radii and rotation (radians) from a to b. Its centre follows from the flags, as in
/// the implementation notes of the SVG specification.
Piece arc_between(const Point& a, const Point& b, double rx, double ry, double rotation, bool large, bool sweep) {
  rx = std::abs(rx);
  ry = std::abs(ry);
  if (rx == 0 || ry == 0) return Line{b};
  const Eigen::Matrix2d axes = Eigen::Rotation2Dd(rotation).toRotationMatrix();
  // Half of the chord, in coordinates in which the ellipse is the unit circle.
  const Point half_chord = (axes.transpose() * (a - b) / 2).cwiseQuotient(Point(rx, ry));
  const double squared = half_chord.squaredNorm();
  if (squared > 1) {  // if the radii are too small for the chord, the ellipse is scaled
    rx *= std::sqrt(squared);
    ry *= std::sqrt(squared);
  }
  const Point p = squared > 1 ? Point(half_chord / std::sqrt(squared)) : half_chord;
  // The flags decide on which side of the chord the centre lies.
  const double centre_distance = std::sqrt(std::max(0.0, 1 / p.squaredNorm() - 1));
  const Point centre = (large != sweep ? centre_distance : -centre_distance) * Point(p.y(), -p.x());
  const Point from = p - centre, to = -p - centre;
  const double start = std::atan2(from.y(), from.x());
  double angle = std::atan2(to.y(), to.x()) - start;
  if (sweep && angle < 0) angle += 2 * std::numbers::pi;
  if (!sweep && angle > 0) angle -= 2 * std::numbers::pi;
  const Point cosine = axes.col(0) * rx, sine = axes.col(1) * ry;
  return Arc{(a + b) / 2 + cosine * centre.x() + sine * centre.y(), cosine, sine, start, angle, b};
}

/// Reads the commands of path data, one after another.
class PathReader {
 public:
  explicit PathReader(std::string_view text) : text_(text), rest_(text) {}

  std::vector<Curve> read() {
    skip_blanks();
    while (!rest_.empty()) {
      const char command = rest_.front();
      if (curves_.empty() && command != 'M' && command != 'm') refuse_here("must begin with M");
      if (std::string_view("MmLlHhVvCcSsQqTtAaZz").find(command) == std::string_view::npos)
        refuse_here("is no command");
      rest_.remove_prefix(1);
      execute(command);
    }
    std::erase_if(curves_, [](const Curve& curve) { return curve.pieces.empty(); });
    return std::move(curves_);
  }

 private:
  [[noreturn]] void refuse_here(const char* what) const {
    throw std::invalid_argument(in_quotes(rest_.substr(0, 10)) + " at character " +
                                std::to_string(text_.size() - rest_.size() + 1) + " " + what);
  }

  void skip_blanks() { rest_ = without_leading_spaces(rest_); }
  void skip_separator() {
    skip_blanks();
    if (!rest_.starts_with(',')) return;
    rest_.remove_prefix(1);
    skip_blanks();
  }

  double number() {
    skip_separator();
    const auto value = take_number(rest_);
    if (!value) refuse_here("must be a number");
    return *value;
  }
  bool flag() {
    skip_separator();
    if (!rest_.starts_with('0') && !rest_.starts_with('1')) refuse_here("must be a flag, 0 or 1");
    const bool value = rest_.front() == '1';
    rest_.remove_prefix(1);
    return value;
  }
  Point point() {
    const double x = number(), y = number();
    return Point(x, y) + (relative_ ? position_ : Point::Zero());
  }
  bool more_numbers() {
    skip_separator();
    return !rest_.empty() && std::string_view("+-.0123456789").find(rest_.front()) != std::string_view::npos;
  }

  void begin_curve(const Point& begin) {
    curves_.emplace_back().begin = begin;
    position_ = begin;
  }
  template <class AnyPiece>
  void add(AnyPiece piece, const Point& to) {
    // A command after Z continues from the beginning of the closed curve.
    if (curves_.back().closed) begin_curve(position_);
    check_pieces(++pieces_);
    curves_.back().pieces.emplace_back(std::move(piece));
    position_ = to;
  }
  void cubic(const Point& first, const Point& second, const Point& to) {
    add(Cubic{first, second, to}, to);
    last_cubic_control_ = second;
  }
  void quadratic(const Point& control, const Point& to) {
    add(Cubic{position_ + 2.0 / 3 * (control - position_), to + 2.0 / 3 * (control - to), to}, to);
    last_quadratic_control_ = control;
  }

  void execute(char command) {
    relative_ = command >= 'a';
    const char kind = relative_ ? static_cast<char>(command - 'a' + 'A') : command;
    if (kind == 'Z') {
      curves_.back().closed = true;
      position_ = curves_.back().begin;
      previous_ = kind;
      return skip_separator();
    }
    bool is_first = true;
    do {
      draw(kind, is_first);
      // Further points of a move command are ends of lines.
      previous_ = kind == 'M' && !is_first ? 'L' : kind;
      is_first = false;
    } while (more_numbers());
  }

  void draw(char kind, bool is_first) {
    switch (kind) {
      case 'M':
        if (is_first) return begin_curve(point());
        [[fallthrough]];
      case 'L':
        return line(point());
      case 'H': {
        const double x = number();
        return line({relative_ ? position_.x() + x : x, position_.y()});
      }
      case 'V': {
        const double y = number();
        return line({position_.x(), relative_ ? position_.y() + y : y});
      }
      case 'C': {
        const Point a = point(), b = point();
        return cubic(a, b, point());
      }
      case 'S': {
        const Point a = previous_ == 'C' || previous_ == 'S' ? Point(2 * position_ - last_cubic_control_) : position_;
        const Point b = point();
        return cubic(a, b, point());
      }
      case 'Q': {
        const Point control = point();
        return quadratic(control, point());
      }
      case 'T': {
        const Point control =
            previous_ == 'Q' || previous_ == 'T' ? Point(2 * position_ - last_quadratic_control_) : position_;
        return quadratic(control, point());
      }
      default: {
        const double rx = number(), ry = number(), rotation = number() * std::numbers::pi / 180;
        const bool large = flag(), sweep = flag();
        const Point to = point();
        // An arc without length is omitted.
        if (to != position_) add(arc_between(position_, to, rx, ry, rotation, large, sweep), to);
      }
    }
  }

  void line(const Point& to) { add(Line{to}, to); }

  std::string_view text_, rest_;
  std::vector<Curve> curves_;
  Point position_ = Point::Zero(), last_cubic_control_ = Point::Zero(), last_quadratic_control_ = Point::Zero();
  std::size_t pieces_ = 0;
  char previous_ = 0;
  bool relative_ = false;
};

}  // namespace

std::vector<Curve> read_path(std::string_view text) { return PathReader(text).read(); }

}  // namespace supple::outlines
