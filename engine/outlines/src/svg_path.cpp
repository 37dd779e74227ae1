#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "svg_attributes.h"

namespace supple::outlines {
namespace {

/// An arc by its radii, the turn of its axes (radians) and its two flags, as the SVG specification's appendix of
/// implementation notes computes its centre.
Piece arc_between(const Point& a, const Point& b, double rx, double ry, double turn, bool large, bool sweep) {
  rx = std::abs(rx);
  ry = std::abs(ry);
  if (rx == 0 || ry == 0) return Line{b};
  const Eigen::Matrix2d axes = Eigen::Rotation2Dd(turn).toRotationMatrix();
  // In coordinates in which the ellipse is the unit circle.
  const Point half = (axes.transpose() * (a - b) / 2).cwiseQuotient(Point(rx, ry));
  const double squared = half.squaredNorm();
  if (squared > 1) {  // radii too small to reach: the ellipse is scaled until it does
    rx *= std::sqrt(squared);
    ry *= std::sqrt(squared);
  }
  const Point p = squared > 1 ? Point(half / std::sqrt(squared)) : half;
  const double reach = std::sqrt(std::max(0.0, 1 / p.squaredNorm() - 1));
  const Point centre = (large != sweep ? reach : -reach) * Point(p.y(), -p.x());
  const Point from = p - centre, to = -p - centre;
  // The centre is turned to the side on which the arc is the large or the small one.
  const double start = std::atan2(from.y(), from.x());
  double angle = std::atan2(to.y(), to.x()) - start;
  if (sweep && angle < 0) angle += 2 * std::numbers::pi;
  if (!sweep && angle > 0) angle -= 2 * std::numbers::pi;
  const Point cosine = axes.col(0) * rx, sine = axes.col(1) * ry;
  return Arc{(a + b) / 2 + cosine * centre.x() + sine * centre.y(), cosine, sine, start, angle, b};
}

/// The commands of path data, one after another.
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
      obey(command);
    }
    std::erase_if(curves_, [](const Curve& curve) { return curve.pieces.empty(); });
    return std::move(curves_);
  }

 private:
  [[noreturn]] void refuse_here(const char* what) const {
    throw std::invalid_argument(in_quotes(rest_.substr(0, 10)) + " at character " +
                                std::to_string(text_.size() - rest_.size() + 1) + " " + what);
  }

  void skip_blanks() { rest_ = without_spaces(rest_); }
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
    return Point(x, y) + (relative_ ? at_ : Point::Zero());
  }
  bool more_numbers() {
    skip_separator();
    return !rest_.empty() && std::string_view("+-.0123456789").find(rest_.front()) != std::string_view::npos;
  }

  void begin_curve(const Point& begin) {
    curves_.emplace_back().begin = begin;
    at_ = begin;
  }
  template <class AnyPiece>
  void add(AnyPiece piece, const Point& to) {
    // What is drawn after Z begins where the closed curve did.
    if (curves_.back().closed) begin_curve(at_);
    check_pieces(++pieces_);
    curves_.back().pieces.emplace_back(std::move(piece));
    at_ = to;
  }
  void cubic(const Point& first, const Point& second, const Point& to) {
    add(Cubic{first, second, to}, to);
    cubic_handle_ = second;
  }
  void quadratic(const Point& handle, const Point& to) {
    add(Cubic{at_ + 2.0 / 3 * (handle - at_), to + 2.0 / 3 * (handle - to), to}, to);
    quadratic_handle_ = handle;
  }

  void obey(char command) {
    relative_ = command >= 'a';
    const char kind = relative_ ? static_cast<char>(command - 'a' + 'A') : command;
    if (kind == 'Z') {
      curves_.back().closed = true;
      at_ = curves_.back().begin;
      previous_ = kind;
      return skip_separator();
    }
    bool first = true;
    do {
      step(kind, first);
      // Further pairs of a move are lines.
      previous_ = kind == 'M' && !first ? 'L' : kind;
      first = false;
    } while (more_numbers());
  }

  void step(char kind, bool first) {
    switch (kind) {
      case 'M':
        if (first) return begin_curve(point());
        [[fallthrough]];
      case 'L':
        return line(point());
      case 'H': {
        const double x = number();
        return line({relative_ ? at_.x() + x : x, at_.y()});
      }
      case 'V': {
        const double y = number();
        return line({at_.x(), relative_ ? at_.y() + y : y});
      }
      case 'C': {
        const Point a = point(), b = point();
        return cubic(a, b, point());
      }
      case 'S': {
        const Point a = previous_ == 'C' || previous_ == 'S' ? Point(2 * at_ - cubic_handle_) : at_;
        const Point b = point();
        return cubic(a, b, point());
      }
      case 'Q': {
        const Point handle = point();
        return quadratic(handle, point());
      }
      case 'T': {
        const Point handle = previous_ == 'Q' || previous_ == 'T' ? Point(2 * at_ - quadratic_handle_) : at_;
        return quadratic(handle, point());
      }
      default: {
        const double rx = number(), ry = number(), turn = number() * std::numbers::pi / 180;
        const bool large = flag(), sweep = flag();
        const Point to = point();
        // An arc without length is left out.
        if (to != at_) add(arc_between(at_, to, rx, ry, turn, large, sweep), to);
      }
    }
  }

  void line(const Point& to) { add(Line{to}, to); }

  std::string_view text_, rest_;
  std::vector<Curve> curves_;
  Point at_ = Point::Zero(), cubic_handle_ = Point::Zero(), quadratic_handle_ = Point::Zero();
  std::size_t pieces_ = 0;
  char previous_ = 0;
  bool relative_ = false;
};

}  // namespace

std::vector<Curve> read_path(std::string_view text) { return PathReader(text).read(); }

}  // namespace supple::outlines
