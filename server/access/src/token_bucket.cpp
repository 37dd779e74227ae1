#include "supple/access/token_bucket.h"

#include <algorithm>

namespace supple::access {

TokenBucket::TokenBucket(int per_minute, Clock::time_point now)
    : per_minute_(per_minute), tokens_(per_minute), last_update_(now) {}

double TokenBucket::take(Clock::time_point now) {
  const double per_second = per_minute_ / 60.0;
  const double elapsed = std::chrono::duration<double>(now - last_update_).count();
  tokens_ = std::min<double>(per_minute_, tokens_ + per_second * std::max(0.0, elapsed));
  last_update_ = now;
  if (tokens_ < 1) return (1 - tokens_) / per_second;
  tokens_ -= 1;
  return 0;
}

}  // namespace supple::access
