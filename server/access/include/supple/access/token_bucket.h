#pragma once

#include <chrono>

namespace supple::access {

/// How many requests one may send: so many a minute on average, and after a pause a minute's worth at once.
class TokenBucket {
 public:
  using Clock = std::chrono::steady_clock;

  TokenBucket(int per_minute, Clock::time_point now);

  int per_minute() const { return per_minute_; }
  /// Takes one request's worth. Returns 0, or where there is none the seconds until there will be one.
  double take(Clock::time_point now);

 private:
  int per_minute_;
  double left_;
  Clock::time_point last_;
};

}  // namespace supple::access
