#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "contact_outline.h"

namespace supple::microscale {

/// Segments sorted by their midpoints into bins over one period of a deformed lattice. Bins divide the period along its
/// two translations, so that the images near a point are found however much the lattice is stretched or sheared.
class SegmentGrid {
 public:
  /// `points` are deformed positions of the outline's points, anywhere in the plane. `lattice` has the deformed
  /// translations as columns and must be invertible. `radius` is the typical radius of `visit`, which decides the size
  /// of the bins. Takes O(segments).
  void build(const ContactOutline& outline, const Eigen::Matrix2d& lattice, const Eigen::Matrix2Xd& points,
             double radius);

  /// Calls visitor(segment, shift) once for each image of a segment that is within `radius` of `position`. It may call
  /// it for images too that are farther away by less than a segment's length.
  template <class Visitor>
  void visit(const Eigen::Vector2d& position, double radius, Visitor&& visitor) const;

 private:
  struct Entry {
    Eigen::Vector2d middle;  ///< midpoint, moved into the cell at the origin
    double half_length = 0;
    int segment = 0;
    Eigen::Vector2i wrap;  ///< the segment's own midpoint lies at middle + lattice * wrap
  };

  int bin_of(const Eigen::Vector2d& coordinates) const;

  Eigen::Matrix2d lattice_;
  Eigen::Matrix2d inverse_;
  Eigen::Array2d heights_;  ///< distances between opposite sides of the cell
  Eigen::Array2i bins_;     ///< number of bins along each translation
  double largest_half_length_ = 0;
  std::vector<Entry> entries_;   ///< sorted by bins
  std::vector<int> begin_;       ///< index of each bin's first entry, and the number of entries
  std::vector<Entry> unsorted_;  ///< entries in the order of the outline's segments
  std::vector<int> bin_;         ///< bin of each unsorted entry
};

template <class Visitor>
void SegmentGrid::visit(const Eigen::Vector2d& position, double radius, Visitor&& visitor) const {
  const Eigen::Array2d centre = (inverse_ * position).array();
  // The extent is a little larger than needed, so that rounding loses no midpoint on a bin's border.
  const Eigen::Array2d extent = (radius + largest_half_length_) / heights_ + 1e-12;
  const Eigen::Array2i low = ((centre - extent) * bins_.cast<double>()).floor().cast<int>();
  const Eigen::Array2i high = ((centre + extent) * bins_.cast<double>()).floor().cast<int>();
  const auto cell_of = [](int bin, int count) { return bin >= 0 ? bin / count : -((count - 1 - bin) / count); };
  for (int i = low[0]; i <= high[0]; ++i) {
    const int first_cell = cell_of(i, bins_[0]);
    const int row = (i - first_cell * bins_[0]) * bins_[1];
    // Consecutive bins of one cell are one range of entries.
    for (int j = low[1]; j <= high[1];) {
      const int second_cell = cell_of(j, bins_[1]);
      const int end = std::min(high[1] + 1, (second_cell + 1) * bins_[1]);
      const Eigen::Vector2i cell(first_cell, second_cell);
      const Eigen::Vector2d relative = position - lattice_ * cell.cast<double>();
      const int last = begin_[static_cast<std::size_t>(row + end - second_cell * bins_[1])];
      for (int e = begin_[static_cast<std::size_t>(row + j - second_cell * bins_[1])]; e < last; ++e) {
        const Entry& entry = entries_[static_cast<std::size_t>(e)];
        const double reach = radius + entry.half_length;
        if ((entry.middle - relative).squaredNorm() <= reach * reach)
          visitor(entry.segment, Eigen::Vector2i(cell - entry.wrap));
      }
      j = end;
    }
  }
}

}  // namespace supple::microscale
