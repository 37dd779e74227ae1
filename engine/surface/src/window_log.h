#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "supple/base/large_page_allocator.h"
#include "window.h"

namespace supple::surface {

/// Windows in the order in which they were pushed. They lie in blocks that never move, so that the log grows without
/// being copied, and its memory is freed block by block while it is read.
class WindowLog {
 public:
  void push(const Window& window) {
    if (used_ == 0 || blocks_[used_ - 1].size() == blocks_[used_ - 1].capacity()) add_block();
    blocks_[used_ - 1].push_back(window);
    ++size_;
  }
  std::size_t size() const { return size_; }

  /// Visits the windows in order and removes them. Empty blocks of at most `max_retained_bytes` are retained.
  template <typename Visit>
  void drain(std::size_t max_retained_bytes, Visit&& visit) {
    std::size_t retained = 0;
    for (std::size_t i = 0; i < used_; ++i) {
      for (const Window& window : blocks_[i]) visit(window);
      blocks_[i].clear();
      retained += blocks_[i].capacity() * sizeof(Window);
      if (retained > max_retained_bytes) LargeVector<Window>().swap(blocks_[i]);
    }
    while (!blocks_.empty() && blocks_.back().capacity() == 0) blocks_.pop_back();
    used_ = 0;
    size_ = 0;
  }

  std::size_t memory_bytes() const {
    std::size_t bytes = 0;
    for (const LargeVector<Window>& block : blocks_) bytes += block.capacity() * sizeof(Window);
    return bytes;
  }

 private:
  /// Block sizes, in windows. They grow, so that small fields need little memory and large fields few blocks.
  static constexpr std::size_t first_block_size = 1 << 12;
  static constexpr std::size_t max_block_size = 1 << 19;

  void add_block() {
    if (used_ == blocks_.size()) {
      blocks_.emplace_back().reserve(std::min(max_block_size, first_block_size << std::min<std::size_t>(used_, 16)));
    }
    ++used_;
  }

  std::vector<LargeVector<Window>> blocks_;
  std::size_t used_ = 0;  ///< blocks that hold windows
  std::size_t size_ = 0;
};

}  // namespace supple::surface
