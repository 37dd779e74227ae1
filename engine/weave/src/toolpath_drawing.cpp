#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "supple/weave/toolpath.h"

namespace supple::weave {
namespace {

constexpr double margin = 2;  ///< around the picture, mm

const char* colour(MoveKind kind) {
  switch (kind) {
    case MoveKind::strand:
      return "#3a6ea5";
    case MoveKind::lifted:
      return "#d08020";
    case MoveKind::channel:
      return "#b03030";
    case MoveKind::priming:
      return "#8a6fb0";
    case MoveKind::support:
      return "#888888";
    case MoveKind::travel:
      break;
  }
  return "#b8d8b8";
}

/// A length in mm, written to a micrometre.
std::string fixed_text(double x) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.3f", x);
  return text.data();
}

/// Width of the line of a move: the diameter of a round bead of the move's area, mm.
double width(const Move& move) {
  return move.kind == MoveKind::travel ? 0.08 : 2 * std::sqrt(move.area / std::numbers::pi);
}

}  // namespace

std::string to_svg(const Toolpath& toolpath) {
  Eigen::AlignedBox2d box;
  std::string body;
  for (const Move& move : toolpath.moves) {
    body += std::string(R"(<path class=")") + std::string(to_string(move.kind)) + R"(" fill="none" stroke=")" +
            colour(move.kind) + R"(" stroke-width=")" + fixed_text(width(move)) + R"(" d=")";
    for (std::size_t i = 0; i < move.points.size(); ++i) {
      body += (i == 0 ? "M" : "L") + fixed_text(move.points[i][0]) + " " + fixed_text(-move.points[i][1]);
      box.extend(Eigen::Vector2d(move.points[i].head<2>()));
    }
    body += "\"/>\n";
  }
  if (box.isEmpty()) box.extend(Eigen::Vector2d(0, 0));
  const Eigen::Vector2d size = box.sizes() + Eigen::Vector2d::Constant(2 * margin);
  return R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox=")" + fixed_text(box.min()[0] - margin) + " " +
         fixed_text(-box.max()[1] - margin) + " " + fixed_text(size[0]) + " " + fixed_text(size[1]) + R"(" width=")" +
         fixed_text(size[0]) + R"(mm" height=")" + fixed_text(size[1]) + "mm\">\n" + body + "</svg>\n";
}

}  // namespace supple::weave
