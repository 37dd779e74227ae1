#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace supple::http {

/// Bytes that have arrived and are read from the front. Reading costs as much as there are bytes, however small the
/// pieces are in which they come and go.
class InputBuffer {
 public:
  bool empty() const { return begin_ == bytes_.size(); }
  std::size_t size() const { return bytes_.size() - begin_; }
  std::string_view view() const { return std::string_view(bytes_).substr(begin_); }
  void append(const char* data, std::size_t count) {
    // Moving the rest to the front costs no more than what has been read since the last time.
    if (begin_ > size()) {
      bytes_.erase(0, begin_);
      begin_ = 0;
    }
    bytes_.append(data, count);
  }
  /// Forgets so many bytes at the front.
  void drop(std::size_t count) { begin_ += count; }
  /// Gives memory back where nothing is left and more than this was taken.
  void give_back(std::size_t kept) {
    if (!empty()) return;
    begin_ = 0;
    if (bytes_.capacity() > kept) {
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
