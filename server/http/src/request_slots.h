#pragma once

#include <exception>
#include <mutex>
#include <string>

#include "client_counts.h"

namespace supple::http {

/// Limits the requests that are answered at the same time, in total and for each client. Any thread may call.
class RequestSlots {
 public:
  RequestSlots(int max_requests, double max_client_fraction)
      : max_requests_(max_requests), max_of_client_(max_of_client(max_client_fraction, max_requests)) {}

  /// Takes a slot for a request of the client and returns null. If there is none, returns the problem "server.busy"
  /// (503) or, beyond the limit of one client, "server.client_share" (429).
  std::exception_ptr acquire(const std::string& client);
  /// Releases a slot that the client's request has occupied for this time.
  void release(const std::string& client, double seconds);
  /// Number of slots that are occupied.
  int occupied() const;

 private:
  /// Estimated time until a slot is free, in whole seconds. The caller holds the mutex.
  int seconds_until_slot() const;

  const int max_requests_;
  const int max_of_client_;
  mutable std::mutex mutex_;
  // The following members are guarded by the mutex.
  ClientCounts occupied_;
  double mean_seconds_ = 0;  ///< moving average of the time that an answer takes
};

}  // namespace supple::http
