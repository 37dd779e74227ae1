#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "supple/base/execution.h"
#include "supple/weave/weave.h"

namespace supple::weave {

/// Boxes around the pieces of a curve, one for each, a little larger than the pieces are; mm. O(pieces log pieces).
std::vector<Eigen::AlignedBox2d> piece_boxes(const StrandCurve& curve);

/// The pieces of all strands in a hierarchy of boxes: of those that lie near a given one only a few others are looked
/// at, however long the strands are. O(n log n) to build for n pieces, about 60 bytes for each.
class PieceTree {
 public:
  /// The tree keeps no reference to the strands. Looks for a stop request every few thousand pieces.
  PieceTree(const std::vector<Strand>& strands, const Execution& execution);

  /// Around all pieces.
  const Eigen::AlignedBox2d& box() const { return branches_.front().box; }

  /// Calls visit(strand, piece, box of the piece, moved) for every piece of the strands from `first_strand` on whose
  /// box, moved by `shift`, meets `box`.
  template <class Visit>
  void for_each_near(const Eigen::AlignedBox2d& box, const Eigen::Vector2d& shift, std::int32_t first_strand,
                     const Visit& visit) const {
    // Branches wait here, two for each level at most; a tree of 2^31 pieces has 28 levels.
    std::int32_t waiting[64];
    int count = 0;
    waiting[count++] = 0;
    while (count > 0) {
      const Branch& branch = branches_[static_cast<std::size_t>(waiting[--count])];
      if (branch.last_strand < first_strand || !box.intersects(moved(branch.box, shift))) continue;
      if (branch.children != 0) {
        waiting[count++] = branch.children + 1;
        waiting[count++] = branch.children;
        continue;
      }
      for (std::int32_t i = branch.first; i < branch.end; ++i) {
        const Entry& entry = entries_[static_cast<std::size_t>(i)];
        if (entry.strand < first_strand) continue;
        const Eigen::AlignedBox2d there = moved(entry.box, shift);
        if (box.intersects(there)) visit(entry.strand, entry.piece, there);
      }
    }
  }

 private:
  struct Entry {
    Eigen::AlignedBox2d box;
    std::int32_t strand = 0;
    std::int32_t piece = 0;
  };
  struct Branch {
    Eigen::AlignedBox2d box;
    std::int32_t last_strand = 0;
    std::int32_t first = 0;
    std::int32_t end = 0;
    std::int32_t children = 0;  ///< the first of two; 0 for a leaf
  };

  static Eigen::AlignedBox2d moved(const Eigen::AlignedBox2d& box, const Eigen::Vector2d& shift) {
    return {box.min() + shift, box.max() + shift};
  }
  void divide(std::int32_t branch, const Execution& execution);

  std::vector<Entry> entries_;
  std::vector<Branch> branches_;
};

}  // namespace supple::weave
