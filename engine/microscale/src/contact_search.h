#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "contact_outline.h"

namespace supple::microscale {

/// Segments sorted into bins over one period of a deformed lattice, by their midpoints. Bins are parallelograms in
/// lattice coordinates: which images are near follows from the lattice, however it is stretched or sheared.
class SegmentGrid {
 public:
  /// `points` are deformed positions of the outline's points (anywhere in the plane), `lattice` has the deformed
  /// translations as columns and must be invertible. `radius`: the typical one of `visit`. O(segments).
  void build(const ContactOutline& outline, const Eigen::Matrix2d& lattice, const Eigen::Matrix2Xd& points,
             double radius);

  /// Calls visitor(segment, shift) once for each image of a segment that comes within `radius` of `position`, and for
  /// some others (by less than a segment's length).
  template <class Visitor>
  void visit(const Eigen::Vector2d& position, double radius, Visitor&& visitor) const;

 private:
  struct Entry {
    Eigen::Vector2d middle;  ///< in the cell at the origin
    double half_length = 0;
    int segment = 0;
    Eigen::Vector2i wrap;  ///< the midpoint lies at middle + lattice * wrap
  };

  int bin_of(const Eigen::Vector2d& coordinates) const;

  Eigen::Matrix2d lattice_;
  Eigen::Matrix2d inverse_;
  Eigen::Array2d heights_;  ///< distances between opposite sides of the cell
  Eigen::Array2i bins_;
  double longest_half_ = 0;
  std::vector<Entry> entries_;  ///< bin by bin
  std::vector<int> begin_;      ///< for each bin, and the end
  std::vector<Entry> unsorted_;
  std::vector<int> bin_;
};

template <class Visitor>
void SegmentGrid::visit(const Eigen::Vector2d& position, double radius, Visitor&& visitor) const {
  const Eigen::Array2d centre = (inverse_ * position).array();
  // A little more, so that rounding loses no midpoint on a bin's border.
  const Eigen::Array2d extent = (radius + longest_half_) / heights_ + 1e-12;
  const Eigen::Array2i low = ((centre - extent) * bins_.cast<double>()).floor().cast<int>();
  const Eigen::Array2i high = ((centre + extent) * bins_.cast<double>()).floor().cast<int>();
  const auto cell_of = [](int bin, int count) { return bin >= 0 ? bin / count : -((count - 1 - bin) / count); };
  for (int i = low[0]; i <= high[0]; ++i) {
    const int first_cell = cell_of(i, bins_[0]);
    const int row = (i - first_cell * bins_[0]) * bins_[1];
    // Bins that follow each other in one cell are one range of entries.
    for (int j = low[1]; j <= high[1];) {
      const int second_cell = cell_of(j, bins_[1]);
      const int end = std::min(high[1] + 1, (second_cell + 1) * bins_[1]);
      const Eigen::Vector2i cell(first_cell, second_cell);
      const Eigen::Vector2d seen = position - lattice_ * cell.cast<double>();
      const int last = begin_[static_cast<std::size_t>(row + end - second_cell * bins_[1])];
      for (int e = begin_[static_cast<std::size_t>(row + j - second_cell * bins_[1])]; e < last; ++e) {
        const Entry& entry = entries_[static_cast<std::size_t>(e)];
        const double reach = radius + entry.half_length;
        if ((entry.middle - seen).squaredNorm() <= reach * reach)
          visitor(entry.segment, Eigen::Vector2i(cell - entry.wrap));
      }
      j = end;
    }
  }
}

}  // namespace supple::microscale
