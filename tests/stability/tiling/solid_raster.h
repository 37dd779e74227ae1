#pragma once

#include <vector>

#include "supple/tiling/part.h"

namespace supple::testing {

/// A part as points of a square grid, each with its distance to the nearest point outside the part. It shares no code
/// with the engine, so that tests can compare the engine with it.
class SolidRaster {
 public:
  /// `step` is the distance of the points, mm. Distances are correct to about one step.
  SolidRaster(const tiling::SolidFace& face, double step);

  struct Topology {
    int pieces = 0;  ///< connected pieces of the eroded solid
    int voids = 0;   ///< connected regions outside: its holes and its surroundings
    bool operator==(const Topology& other) const = default;
  };
  /// The topology of the solid after erosion by half of `width`. Pieces into which no disk of diameter `disk` fits do
  /// not count. Both lengths are in mm.
  Topology eroded(double width, double disk) const;

 private:
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  void mark_inside(const tiling::SolidFace& face);
  void mark_outline(const tiling::SolidFace& face);
  void measure_distances();
  /// Numbers the connected regions of marked points, from 1 on, and returns their number.
  int number_regions(const std::vector<char>& marked, bool with_diagonals, std::vector<int>& region) const;

  double step_;
  Eigen::Vector2d lower_ = Eigen::Vector2d::Zero();
  int columns_ = 0, rows_ = 0;
  std::vector<float> distance_;  ///< distance of each point from the outside, mm
};

}  // namespace supple::testing
