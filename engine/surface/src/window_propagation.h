#pragma once

#include <cstdint>
#include <vector>

#include "search_front.h"

namespace supple::surface {

/// Passes the windows that wait at a halfedge on through its face.
class WindowPropagation {
 public:
  /// `front` must outlive the object.
  explicit WindowPropagation(SearchFront& front) : front_(front) {}

  /// Trims all pending windows of a halfedge to their lower envelope, updates the targets and the opposite corner of
  /// its face, and hands windows to the other two edges.
  void process(std::int32_t h, const CancellationToken& cancellation);

 private:
  void gather(std::int32_t h);
  void trim_small_batch(double touching);
  void trim_large_batch(double touching, const CancellationToken& cancellation);

  SearchFront& front_;
  std::vector<std::int32_t> batch_;      ///< pool indices of the windows that are processed together
  std::vector<std::int32_t> remaining_;  ///< the windows of a large batch that trimming has left
};

}  // namespace supple::surface
