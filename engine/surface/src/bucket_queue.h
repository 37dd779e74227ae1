#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace supple::surface {

/// A monotone priority queue of 32-bit items in buckets of equal width. Items of one bucket leave it in the order in
/// which they were pushed.
///
/// An item whose key is below the current bucket goes into the current one. A label-correcting search stays correct
/// then, only its order gets worse. The caller stores for each item the bucket in which it is queued, and skips entries
/// from other buckets, which are out of date.
class BucketQueue {
 public:
  using Bucket = std::int32_t;
  static constexpr Bucket not_queued = std::numeric_limits<Bucket>::max();

  /// Empties the queue. O(buckets touched since the last start).
  void start(double first_key, double width) {
    for (Bucket b = current_; b < used_; ++b) buckets_[b].clear();
    current_ = 0;
    used_ = 0;
    position_ = 0;
    origin_ = first_key;
    inverse_width_ = 1 / width;
    width_ = width;
  }

  Bucket bucket_of(double key) const {
    const double b = (key - origin_) * inverse_width_;
    return b < last_bucket ? std::max(current_, static_cast<Bucket>(b)) : last_bucket;
  }

  void push(std::int32_t item, Bucket bucket) {
    if (bucket >= used_) {
      used_ = bucket + 1;
      if (static_cast<std::size_t>(used_) > buckets_.size()) buckets_.resize(std::max<std::size_t>(64, 2 * used_));
    }
    buckets_[bucket].push_back(item);
  }

  /// Takes the next item, and the bucket from which it comes. Returns false if the queue is empty.
  bool pop(std::int32_t& item, Bucket& bucket) {
    while (current_ < used_) {
      std::vector<std::int32_t>& items = buckets_[current_];
      if (position_ < items.size()) {
        item = items[position_++];
        bucket = current_;
        return true;
      }
      if (items.capacity() > max_retained_items)
        std::vector<std::int32_t>().swap(items);
      else
        items.clear();
      position_ = 0;
      ++current_;
    }
    return false;
  }

  /// The item that pop() will return after `ahead` others of the current bucket, or `fallback` past the bucket's end.
  std::int32_t upcoming(std::size_t ahead, std::int32_t fallback) const {
    const std::vector<std::int32_t>& items = buckets_[current_];
    return position_ + ahead < items.size() ? items[position_ + ahead] : fallback;
  }

  /// Lower bound of the keys that are queued, and of those that a monotone search will push.
  double min_key() const { return origin_ + current_ * width_; }

  /// Frees all buckets if they hold more than `max_retained_bytes`. O(buckets that were ever used).
  void give_back_memory(std::size_t max_retained_bytes) {
    if (memory_bytes() <= max_retained_bytes) return;
    std::vector<std::vector<std::int32_t>>().swap(buckets_);
    current_ = used_ = 0;
  }
  std::size_t memory_bytes() const {
    std::size_t bytes = buckets_.capacity() * sizeof(std::vector<std::int32_t>);
    for (const std::vector<std::int32_t>& bucket : buckets_) bytes += bucket.capacity() * sizeof(std::int32_t);
    return bytes;
  }

 private:
  /// Index of the last bucket, which takes all larger keys.
  static constexpr Bucket last_bucket = 1 << 22;
  /// Buckets with room for more items are freed once they are empty: a large search passes through thousands of them.
  static constexpr std::size_t max_retained_items = 1 << 12;

  std::vector<std::vector<std::int32_t>> buckets_;
  Bucket current_ = 0;
  Bucket used_ = 0;
  std::size_t position_ = 0;
  double origin_ = 0;
  double inverse_width_ = 1;
  double width_ = 1;
};

}  // namespace supple::surface
