#pragma once

#include <cstdint>

#include "supple/base/large_page_allocator.h"
#include "window.h"

namespace supple::surface {

/// Slots for the pending windows of a search, which are used again. A window's index stays valid until its release;
/// references to windows are valid until the next allocation for which no room was reserved.
class WindowPool {
 public:
  Window& operator[](std::int32_t i) { return windows_[i]; }
  const Window& operator[](std::int32_t i) const { return windows_[i]; }

  [[gnu::always_inline]] std::int32_t allocate() {
    ++created_;
    if (first_free_ >= 0) {
      const std::int32_t i = first_free_;
      first_free_ = windows_[i].link;
      return i;
    }
    windows_.emplace_back();
    return static_cast<std::int32_t>(windows_.size()) - 1;
  }
  void release(std::int32_t i) {
    windows_[i].link = first_free_;
    first_free_ = i;
  }
  /// Makes room for `count` allocations.
  void reserve(std::size_t count) {
    if (windows_.capacity() < windows_.size() + count) windows_.reserve(2 * windows_.capacity() + count);
  }

  void clear() {
    windows_.clear();
    first_free_ = -1;
    created_ = 0;
  }
  /// Frees the slots if they take more than `max_retained_bytes`. Their windows are lost.
  void give_back_memory(std::size_t max_retained_bytes) {
    if (memory_bytes() > max_retained_bytes) LargeVector<Window>().swap(windows_);
  }
  std::size_t memory_bytes() const { return windows_.capacity() * sizeof(Window); }
  std::int64_t created() const { return created_; }  ///< allocations since the last clear()

 private:
  LargeVector<Window> windows_;
  std::int32_t first_free_ = -1;
  std::int64_t created_ = 0;
};

}  // namespace supple::surface
