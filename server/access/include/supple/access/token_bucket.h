#pragma once

#include <chrono>

namespace supple::access {

/// A token bucket that limits the rate of requests. On average it allows `per_minute` requests a minute; after a pause
/// that many may come at once.
class TokenBucket {
 public:
  using Clock = std::chrono::steady_clock;

  TokenBucket(int per_minute, Clock::time_point now);

  int per_minute() const { return per_minute_; }
  /// Takes a token for one request and returns 0. If there is none, returns the seconds until there will be one.
  double take(Clock::time_point now);

 private:
  int per_minute_;
  double tokens_;  ///< number of requests that may be sent at once
  Clock::time_point last_update_;
};

}  // namespace supple::access
