#include "supple/access/token_bucket.h"

#include <algorithm>

namespace supple::access {

TokenBucket::TokenBucket(int per_minute, Clock::time_point now)
    : per_minute_(per_minute), left_(per_minute), last_(now) {}

double TokenBucket::take(Clock::time_point now) {
  const double per_second = per_minute_ / 60.0;
  const double passed = std::chrono::duration<double>(now - last_).count();
  left_ = std::min<double>(per_minute_, left_ + per_second * std::max(0.0, passed));
  last_ = now;
  if (left_ < 1) return (1 - left_) / per_second;
  left_ -= 1;
  return 0;
}

}  // namespace supple::access
