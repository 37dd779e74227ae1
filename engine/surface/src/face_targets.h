#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "search_target.h"

namespace supple::surface {

/// The targets of a search, listed by the faces in which they lie. A target at a vertex lies in all faces around it.
class FaceTargets {
 public:
  /// `mesh` must outlive the object.
  explicit FaceTargets(const TriangleMesh& mesh);
  /// Begins a search. Epochs count from 1; epoch 1 clears all faces.
  void start(std::uint32_t epoch, std::span<SearchTarget> targets);

  std::span<SearchTarget> all() const { return targets_; }
  bool are_in(std::int32_t face) const { return !targets_.empty() && faces_[face].epoch == epoch_; }
  template <typename Visit>
  void visit(std::int32_t face, Visit visit) const {
    if (faces_[face].epoch != epoch_) return;
    for (std::int32_t i = faces_[face].first_link; i >= 0; i = links_[i].next) visit(targets_[links_[i].target]);
  }
  std::size_t memory_bytes() const { return faces_.capacity() * sizeof(FaceRecord); }

 private:
  /// An element of the list of targets in a face.
  struct TargetLink {
    std::int32_t target;
    std::int32_t next;  ///< the next link of the same face; -1 for none
  };
  struct FaceRecord {
    std::uint32_t epoch;
    std::int32_t first_link;
  };
  void add(std::int32_t face, std::int32_t target);

  const TriangleMesh& mesh_;
  std::vector<FaceRecord> faces_;
  std::vector<TargetLink> links_;
  std::span<SearchTarget> targets_;
  std::uint32_t epoch_ = 0;
};

}  // namespace supple::surface
