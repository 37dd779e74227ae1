#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "supple/base/execution.h"
#include "supple/weave/weave.h"

namespace supple::weave {

/// Bounding boxes of the pieces of a curve, each enlarged by a small margin; mm. O(pieces log pieces).
std::vector<Eigen::AlignedBox2d> piece_boxes(const StrandCurve& curve);

/// The pieces of all strands in a hierarchy of bounding boxes. However long the strands are, a search for the pieces
/// near a given box inspects few others. O(n log n) to build for n pieces, about 60 bytes for each.
class PieceTree {
 public:
  /// The tree keeps no reference to the strands. Checks for a stop request every few thousand pieces.
  PieceTree(const std::vector<Strand>& strands, const Execution& execution);

  /// Bounding box of all pieces.
  const Eigen::AlignedBox2d& box() const { return branches_.front().box; }

  /// Calls visit(strand, piece, box of the piece after the move) for every piece of the strands from `first_strand` on
  /// whose box, moved by `shift`, intersects `box`.
  template <class Visit>
  void for_each_near(const Eigen::AlignedBox2d& box, const Eigen::Vector2d& shift, std::int32_t first_strand,
                     const Visit& visit) const {
    // Branches that are still to be visited, at most two for each level. A tree of 2^31 pieces has 28 levels.
    std::int32_t stack[64];
    int stack_size = 0;
    stack[stack_size++] = 0;
    while (stack_size > 0) {
      const Branch& branch = branches_[static_cast<std::size_t>(stack[--stack_size])];
      if (branch.last_strand < first_strand || !box.intersects(moved(branch.box, shift))) continue;
      if (branch.children != 0) {
        stack[stack_size++] = branch.children + 1;
        stack[stack_size++] = branch.children;
        continue;
      }
      for (std::int32_t i = branch.first; i < branch.end; ++i) {
        const Entry& entry = entries_[static_cast<std::size_t>(i)];
        if (entry.strand < first_strand) continue;
        const Eigen::AlignedBox2d moved_box = moved(entry.box, shift);
        if (box.intersects(moved_box)) visit(entry.strand, entry.piece, moved_box);
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
    std::int32_t children = 0;  ///< index of the first of its two children; 0 for a leaf
  };

  static Eigen::AlignedBox2d moved(const Eigen::AlignedBox2d& box, const Eigen::Vector2d& shift) {
    return {box.min() + shift, box.max() + shift};
  }
  void divide(std::int32_t branch, const Execution& execution);

  std::vector<Entry> entries_;
  std::vector<Branch> branches_;
};

}  // namespace supple::weave
