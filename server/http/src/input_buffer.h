#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace supple::http {

/// A queue of bytes that have arrived. All calls together take time proportional to the number of bytes, however small
/// the pieces are.
class InputBuffer {
 public:
  bool empty() const { return begin_ == bytes_.size(); }
  std::size_t size() const { return bytes_.size() - begin_; }
  std::string_view view() const { return std::string_view(bytes_).substr(begin_); }
  void append(const char* data, std::size_t count) {
    // Fewer bytes are moved than have been dropped since the last move.
    if (begin_ > size()) {
      bytes_.erase(0, begin_);
      begin_ = 0;
    }
    bytes_.append(data, count);
  }
  /// Removes `count` bytes at the front.
  void drop(std::size_t count) { begin_ += count; }
  /// Frees the memory of an empty buffer if it has more than `max_retained` bytes.
  void release_memory(std::size_t max_retained) {
    if (!empty()) return;
    begin_ = 0;
    if (bytes_.capacity() > max_retained) {
      bytes_ = std::string();
    } else {
      bytes_.clear();
    }
  }

 private:
  std::string bytes_;
  std::size_t begin_ = 0;
};

}  // namespace supple::http
