#pragma once

#include <vector>

#include "supple/tiling/part.h"

namespace supple::testing {

/// A part as points of a square grid, each with its distance to the nearest point outside of the part. It shares
/// nothing with the code that makes parts and measures them, so that tests can hold these against it.
class SolidRaster {
 public:
  /// `step`: distance of the points in mm. Distances are right but for about one step.
  SolidRaster(const tiling::SolidFace& face, double step);

  struct Topology {
    int pieces = 0;  ///< of the eroded solid
    int voids = 0;   ///< connected regions outside of it: holes, and what surrounds it
    bool operator==(const Topology& other) const = default;
  };
  /// The solid eroded by half of `width`. Pieces count where a disk of the diameter `disk` fits in. Both in mm.
  Topology eroded(double width, double disk) const;

 private:
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  void mark_inside(const tiling::SolidFace& face);
  void mark_outline(const tiling::SolidFace& face);
  void measure_distances();
  /// Numbers the connected regions of the points that are marked, from 1 on, and returns how many there are.
  int number_regions(const std::vector<char>& marked, bool with_diagonals, std::vector<int>& region) const;

  double step_;
  Eigen::Vector2d lower_ = Eigen::Vector2d::Zero();
  int columns_ = 0, rows_ = 0;
  std::vector<float> distance_;  ///< mm
};

}  // namespace supple::testing
