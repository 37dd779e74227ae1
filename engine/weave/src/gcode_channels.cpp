#include "gcode_channels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "supple/base/seeded_hash.h"

namespace supple::weave {
namespace {

constexpr double min_rise = 0.2;     ///< minimum rise from the feet to the apex, mm
constexpr double same_height = 0.1;  ///< maximum height difference between feet, and from a foot to a bead below, mm
constexpr double same_level = 1e-4;  ///< a smaller rise or fall is none, mm
constexpr double max_grid_coordinate = 1e9;  ///< coordinates beyond this are not in the grid, mm

/// Beads in grids whose cells are about as large as the beads in them. Each bead is found in a few cells, whatever its
/// length.
class BeadGrid {
 public:
  explicit BeadGrid(double reach) : reach_(reach), min_cell_size_(std::max(1.0, reach)) {}

  void insert(const Bead& bead, int number) {
    const Eigen::Vector2d from = bead.from.head<2>();
    const Eigen::Vector2d to = bead.to.head<2>();
    if (from.cwiseAbs().maxCoeff() > max_grid_coordinate || to.cwiseAbs().maxCoeff() > max_grid_coordinate) return;
    const double cells = (to - from).norm() / min_cell_size_;
    const int level = cells > 1 ? static_cast<int>(std::ceil(std::log2(cells))) : 0;
    levels_ = std::max(levels_, level + 1);
    cells_[key(level, (from + to) / 2, 0, 0)].push_back(number);
  }

  /// Returns whether `test` holds for a bead whose centre is so near to the point that the bead may be within reach of
  /// it.
  template <typename Test>
  bool any(const Eigen::Vector2d& point, Test&& test) const {
    if (point.cwiseAbs().maxCoeff() > max_grid_coordinate) return false;
    for (int level = 0; level < levels_; ++level) {
      // Half the length of a bead plus the reach is at most one and a half cells.
      for (int i = -2; i <= 2; ++i) {
        for (int j = -2; j <= 2; ++j) {
          const auto cell = cells_.find(key(level, point, i, j));
          if (cell != cells_.end() && std::any_of(cell->second.begin(), cell->second.end(), test)) return true;
        }
      }
    }
    return false;
  }
  double reach() const { return reach_; }

 private:
  std::uint64_t key(int level, const Eigen::Vector2d& at, int i, int j) const {
    const double size = std::ldexp(min_cell_size_, level);
    const auto x = static_cast<std::int64_t>(std::floor(at[0] / size)) + i;
    const auto y = static_cast<std::int64_t>(std::floor(at[1] / size)) + j;
    // A collision only costs time, since each bead is tested.
    return SeededHash::of(x, y, level);
  }

  double reach_;
  double min_cell_size_;
  int levels_ = 0;
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

double distance(const Eigen::Vector2d& point, const Bead& bead) {
  const Eigen::Vector2d from = bead.from.head<2>();
  const Eigen::Vector2d along = bead.to.head<2>() - from;
  const double square = along.squaredNorm();
  const double fraction = square > 0 ? std::clamp((point - from).dot(along) / square, 0.0, 1.0) : 0;
  return (from + fraction * along - point).norm();
}

/// Whether the beads [begin, end) first rise and then fall to the same height.
bool is_hump(const std::vector<Bead>& beads, std::size_t begin, std::size_t end) {
  const auto rise = [&](std::size_t i) { return beads[i].to[2] - beads[i].from[2]; };
  if (end - begin < 2 || rise(begin) <= same_level || rise(end - 1) >= -same_level) return false;
  if (std::abs(beads[end - 1].to[2] - beads[begin].from[2]) > same_height) return false;
  bool falling = false;
  for (std::size_t i = begin; i < end; ++i) {
    if (rise(i) < -same_level) falling = true;
    if (falling && rise(i) > same_level) return false;
  }
  return true;
}

}  // namespace

std::vector<FoundChannel> find_channels(const std::vector<Bead>& beads, double strand_width,
                                        const CancellationToken& cancellation) {
  std::vector<FoundChannel> found;
  BeadGrid grid(strand_width);
  for (std::size_t begin = 0, end = 0; begin < beads.size(); begin = end) {
    cancellation.throw_if_requested();
    while (end < beads.size() && beads[end].run == beads[begin].run) ++end;
    const auto stands_on_bead = [&](const Eigen::Vector3d& foot) {
      return grid.any(foot.head<2>(), [&](int i) {
        const Bead& lower = beads[static_cast<std::size_t>(i)];
        return std::max(lower.from[2], lower.to[2]) <= foot[2] + same_height &&
               distance(foot.head<2>(), lower) <= grid.reach();
      });
    };
    if (is_hump(beads, begin, end) && stands_on_bead(beads[begin].from) && stands_on_bead(beads[end - 1].to)) {
      FoundChannel channel{beads[begin].line, beads[begin].from, beads[begin].from, beads[end - 1].to, 0};
      for (std::size_t i = begin; i < end; ++i) {
        if (beads[i].to[2] > channel.apex[2]) channel.apex = beads[i].to;
        channel.length += (beads[i].to - beads[i].from).norm();
      }
      if (channel.apex[2] - std::max(channel.start[2], channel.end[2]) >= min_rise) found.push_back(channel);
    }
    for (std::size_t i = begin; i < end; ++i) grid.insert(beads[i], static_cast<int>(i));
  }
  return found;
}

}  // namespace supple::weave
