#include "contact_search.h"

#include <Eigen/LU>
#include <algorithm>

namespace supple::microscale {

void SegmentGrid::build(const ContactOutline& outline, const Eigen::Matrix2d& lattice, const Eigen::Matrix2Xd& points,
                        double radius) {
  const std::size_t count = outline.segments.size();
  lattice_ = lattice;
  inverse_ = lattice.inverse();
  // |row i of the inverse| is 1 / the distance between the lines on which lattice coordinate i is 0 and 1.
  heights_ = inverse_.rowwise().norm().array().inverse();
  largest_half_length_ = 0;
  unsorted_.resize(count);
  for (std::size_t s = 0; s < count; ++s) {
    const ContactOutline::Segment& segment = outline.segments[s];
    const Eigen::Vector2d tail = points.col(segment.tail);
    const Eigen::Vector2d head = points.col(segment.head) + lattice * segment.head_shift.cast<double>();
    const Eigen::Vector2d middle = (tail + head) / 2;
    const Eigen::Vector2d wrap = (inverse_ * middle).array().floor();
    unsorted_[s] = {middle - lattice * wrap, (head - tail).norm() / 2, static_cast<int>(s), wrap.cast<int>()};
    largest_half_length_ = std::max(largest_half_length_, unsorted_[s].half_length);
  }

  // A bin is half as wide as the typical extent of `visit`. The number of bins along a side is limited to about twice
  // the square root of the number of segments.
  const double size = std::max((radius + largest_half_length_) / 2, 1e-12 * heights_.maxCoeff());
  const double max_bins = 2 + 2 * std::sqrt(static_cast<double>(count));
  bins_ = (heights_ / size).min(max_bins).max(1.0).cast<int>();
  const auto bins = static_cast<std::size_t>(bins_[0]) * static_cast<std::size_t>(bins_[1]);
  begin_.assign(bins + 1, 0);
  bin_.resize(count);
  for (std::size_t s = 0; s < count; ++s) {
    bin_[s] = bin_of(inverse_ * unsorted_[s].middle);
    ++begin_[static_cast<std::size_t>(bin_[s]) + 1];
  }
  for (std::size_t b = 0; b < bins; ++b) begin_[b + 1] += begin_[b];
  entries_.resize(count);
  // A counting sort. Each bin is filled from its end, so that segments keep their order within it. This moves
  // begin_[b + 1] from the end of bin b to its beginning.
  for (std::size_t s = count; s-- > 0;)
    entries_[static_cast<std::size_t>(--begin_[static_cast<std::size_t>(bin_[s]) + 1])] = unsorted_[s];
  std::rotate(begin_.begin(), begin_.begin() + 1, begin_.end());
  begin_.back() = static_cast<int>(count);
}

int SegmentGrid::bin_of(const Eigen::Vector2d& coordinates) const {
  // A coordinate that rounding has moved out of [0, 1) belongs to the first or the last bin.
  const Eigen::Array2i bin = (coordinates.array() * bins_.cast<double>()).floor().cast<int>().max(0).min(bins_ - 1);
  return bin[0] * bins_[1] + bin[1];
}

}  // namespace supple::microscale
