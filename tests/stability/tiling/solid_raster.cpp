#include "solid_raster.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace supple::testing {
namespace {

/// Number of points outside the part on each side of its bounding box.
constexpr int margin = 2;

/// The lower envelope of parabolas with their apexes at (k, f[k]): squared distances along one line of points
/// [Felzenszwalb2012].
void squared_distances(const std::vector<float>& f, std::vector<float>& result) {
  const int n = static_cast<int>(f.size());
  std::vector<int> apex(f.size());
  std::vector<float> from(f.size() + 1);
  const auto at = [](int k) { return static_cast<std::size_t>(k); };
  int last = 0;
  apex[0] = 0;
  from[0] = -INFINITY;
  from[1] = INFINITY;
  for (int q = 1; q < n; ++q) {
    const auto meeting = [&](int p) {
      const auto fq = static_cast<float>(q), fp = static_cast<float>(p);
      return ((f[at(q)] + fq * fq) - (f[at(p)] + fp * fp)) / (2 * (fq - fp));
    };
    float s = meeting(apex[at(last)]);
    while (s <= from[at(last)]) s = meeting(apex[at(--last)]);
    apex[at(++last)] = q;
    from[at(last)] = s;
    from[at(last + 1)] = INFINITY;
  }
  for (int q = 0, k = 0; q < n; ++q) {
    while (from[at(k + 1)] < static_cast<float>(q)) ++k;
    const auto away = static_cast<float>(q - apex[at(k)]);
    result[at(q)] = away * away + f[at(apex[at(k)])];
  }
}

}  // namespace

SolidRaster::SolidRaster(const tiling::SolidFace& face, double step) : step_(step) {
  Eigen::Vector2d upper = face[0][0];
  lower_ = upper;
  for (const auto& p : face[0]) {
    lower_ = lower_.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  // The points are offset by half a step, so that they do not lie on straight sides of the outline.
  lower_ -= Eigen::Vector2d::Constant((margin - 0.5) * step);
  columns_ = static_cast<int>(std::ceil((upper - lower_).x() / step)) + margin;
  rows_ = static_cast<int>(std::ceil((upper - lower_).y() / step)) + margin;
  mark_inside(face);
  measure_distances();
}

void SolidRaster::mark_inside(const tiling::SolidFace& face) {
  distance_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0);
  std::vector<std::vector<double>> crossings(static_cast<std::size_t>(rows_));
  for (const auto& polygon : face) {
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Eigen::Vector2d a = (polygon[k] - lower_) / step_, b = (polygon[(k + 1) % polygon.size()] - lower_) / step_;
      const auto first = static_cast<int>(std::ceil(std::min(a.y(), b.y())));
      const auto last = static_cast<int>(std::ceil(std::max(a.y(), b.y())));
      for (int row = first; row < last; ++row)
        crossings[static_cast<std::size_t>(row)].push_back(a.x() + (row - a.y()) * (b.x() - a.x()) / (b.y() - a.y()));
    }
  }
  for (int row = 0; row < rows_; ++row) {
    auto& line = crossings[static_cast<std::size_t>(row)];
    std::sort(line.begin(), line.end());
    for (std::size_t k = 0; k + 1 < line.size(); k += 2) {
      const auto last = static_cast<int>(std::floor(line[k + 1]));
      for (int column = static_cast<int>(std::ceil(line[k])); column <= last; ++column)
        distance_[index(column, row)] = INFINITY;
    }
  }
  mark_outline(face);
}

// Marks points on the outline as outside, so that holes narrower than a step have points, too.
void SolidRaster::mark_outline(const tiling::SolidFace& face) {
  for (const auto& polygon : face) {
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Eigen::Vector2d a = (polygon[k] - lower_) / step_, b = (polygon[(k + 1) % polygon.size()] - lower_) / step_;
      const int pieces = static_cast<int>(2 * (b - a).norm()) + 1;
      for (int i = 0; i < pieces; ++i) {
        const Eigen::Vector2d p = a + (b - a) * i / pieces;
        distance_[index(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())))] = 0;
      }
    }
  }
}

void SolidRaster::measure_distances() {
  // The value is finite, so that differences of distances are numbers.
  constexpr float far = 1e12F;
  for (float& value : distance_) value = std::min(value, far);
  std::vector<float> line, result;
  const auto along = [&](int count, int lines, auto&& place) {
    line.resize(static_cast<std::size_t>(count));
    result.resize(line.size());
    for (int l = 0; l < lines; ++l) {
      for (int k = 0; k < count; ++k) line[static_cast<std::size_t>(k)] = distance_[place(k, l)];
      squared_distances(line, result);
      for (int k = 0; k < count; ++k) distance_[place(k, l)] = result[static_cast<std::size_t>(k)];
    }
  };
  along(rows_, columns_, [&](int k, int l) { return index(l, k); });
  along(columns_, rows_, [&](int k, int l) { return index(k, l); });
  for (float& value : distance_) value = static_cast<float>(step_) * std::sqrt(value);
}

int SolidRaster::number_regions(const std::vector<char>& marked, bool with_diagonals, std::vector<int>& region) const {
  region.assign(marked.size(), 0);
  int count = 0;
  std::vector<std::pair<int, int>> open;
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      if (!marked[index(column, row)] || region[index(column, row)] > 0) continue;
      region[index(column, row)] = ++count;
      open.emplace_back(column, row);
      while (!open.empty()) {
        const auto [x, y] = open.back();
        open.pop_back();
        for (int dy = -1; dy <= 1; ++dy) {
          for (int dx = -1; dx <= 1; ++dx) {
            if (!with_diagonals && dx != 0 && dy != 0) continue;
            const int u = x + dx, v = y + dy;
            if (u < 0 || v < 0 || u >= columns_ || v >= rows_) continue;
            if (!marked[index(u, v)] || region[index(u, v)] > 0) continue;
            region[index(u, v)] = count;
            open.emplace_back(u, v);
          }
        }
      }
    }
  }
  return count;
}

SolidRaster::Topology SolidRaster::eroded(double width, double disk) const {
  std::vector<char> solid(distance_.size());
  for (std::size_t i = 0; i < solid.size(); ++i) solid[i] = 2 * distance_[i] >= width ? 1 : 0;
  std::vector<int> region;
  const int count = number_regions(solid, true, region);
  std::vector<char> holds_disk(static_cast<std::size_t>(count) + 1, 0);
  for (std::size_t i = 0; i < solid.size(); ++i)
    if (2 * distance_[i] >= disk) holds_disk[static_cast<std::size_t>(region[i])] = 1;
  std::vector<char> empty(solid.size());
  for (std::size_t i = 0; i < solid.size(); ++i)
    empty[i] = solid[i] && holds_disk[static_cast<std::size_t>(region[i])] ? 0 : 1;
  Topology topology;
  topology.pieces = static_cast<int>(std::count(holds_disk.begin() + 1, holds_disk.end(), 1));
  topology.voids = number_regions(empty, false, region);
  return topology;
}

}  // namespace supple::testing
