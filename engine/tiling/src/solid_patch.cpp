#include "solid_patch.h"

#include <Eigen/LU>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "polygon.h"
#include "supple/base/error.h"
#include "supple/base/number_text.h"
#include "supple/tiling/tiling_error.h"

namespace supple::tiling {
namespace {

constexpr int max_cells = 100;
constexpr double max_height = 1000;  // mm

/// Length, in beam widths, below which sides of the outline become points, as in holes.
constexpr double min_outline_side = 0.005;

void check(const ExportOptions& options) {
  std::vector<Error::Detail> details;
  const auto check_count = [&](const char* where, int count) {
    if (count >= 1 && count <= max_cells) return;
    details.push_back({where, "must be from 1 to 100 cells, but is " + std::to_string(count)});
  };
  check_count("first", options.first);
  check_count("second", options.second);
  if (!(options.height > 0 && options.height <= max_height)) {
    details.push_back({"height", "must be above 0 and at most 1000 mm, but is " + number_text(options.height)});
  }
  if (details.empty()) return;
  throw TilingError("tiling.export_option", "Export option " + details[0].where + " " + details[0].message + ".",
                    details);
}

}  // namespace

std::vector<Face> solid_patch(const Structure& structure, const ExportOptions& options) {
  check(options);
  const Eigen::Matrix2d& lattice = structure.tiling.lattice;
  std::vector<Polygon> tiles;
  Eigen::Vector2d lower = Eigen::Vector2d::Constant(INFINITY), upper = -lower;
  for (int b = 0; b < options.second; ++b) {
    for (int a = 0; a < options.first; ++a) {
      for (Placement placement : structure.tiling.placements) {
        placement.offset += lattice * Eigen::Vector2d(a, b);
        tiles.push_back(placed(structure.tiling.tiles[placement.tile], placement));
        for (const Eigen::Vector2d& p : tiles.back()) {
          lower = lower.cwiseMin(p);
          upper = upper.cwiseMax(p);
        }
      }
    }
  }
  const Eigen::Vector2d centre = (lower + upper) / 2;
  for (Polygon& tile : tiles) {
    for (Eigen::Vector2d& p : tile) p -= centre;
  }
  // Beams of tiles are connected, and so is their union. With joints on both sides, beams along the rim are complete.
  std::vector<Polygon> beams;
  const auto add = [&](const std::vector<Polygon>& outlines, Joints joints) {
    for (const Polygon& outline : outlines) {
      for (Polygon& beam : beams_along(outline, structure.beam_width / 2, joints)) beams.push_back(std::move(beam));
    }
  };
  add(tiles, Joints::left);
  add(outlines_of_union(tiles), Joints::both);
  return faces_of_union(beams, min_outline_side * structure.beam_width);
}

std::string decimal(double value, int digits) {
  std::array<char, 64> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, digits).ptr;
  std::string result(text.data(), end);
  result.erase(result.find_last_not_of('0') + 1);
  if (result.back() == '.') result.pop_back();
  return result == "-0" ? "0" : result;
}

}  // namespace supple::tiling
