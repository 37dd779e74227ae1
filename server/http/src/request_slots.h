#pragma once

#include <exception>
#include <mutex>
#include <string>

#include "client_counts.h"

namespace supple::http {

/// Limits the requests that are answered at the same time, in total and for each client. Those that wait for work in
/// the background have slots of their own, as many again, so that they take none from others. Any thread may call.
class RequestSlots {
 public:
  RequestSlots(int max_requests, double max_client_fraction)
      : max_requests_(max_requests), max_of_client_(max_of_client(max_client_fraction, max_requests)) {}

  /// Takes a slot for a request of the client and returns null. If there is none, returns the problem "server.busy"
  /// (503) or, beyond the limit of one client, "server.client_share" (429).
  std::exception_ptr acquire(const std::string& client);
  /// Releases a slot that the client's request has occupied for this time.
  void release(const std::string& client, double seconds);
  /// Moves a request of the client, which has a slot, to one of those for requests that wait in the background, and
  /// returns null. If there is none, returns the problem as `acquire` does, and the request keeps its slot.
  std::exception_ptr move_to_background(const std::string& client);
  /// Releases the slot of a request that has waited in the background.
  void release_in_background(const std::string& client);
  /// Number of slots that are occupied, of both kinds.
  int occupied() const;

 private:
  // The caller of the following functions holds the mutex.
  /// The problem of a request of the client for which there is no slot beside these; null if there is one. `where`
  /// says in the problem's text which requests these are.
  std::exception_ptr refusal(const ClientCounts& taken, const std::string& client, const std::string& where) const;
  /// Estimated time until a slot is free, in whole seconds.
  int seconds_until_slot() const;

  const int max_requests_;
  const int max_of_client_;
  mutable std::mutex mutex_;
  // The following members are guarded by the mutex.
  ClientCounts occupied_;
  ClientCounts in_background_;
  double mean_seconds_ = 0;  ///< moving average of the time that an answer takes
};

}  // namespace supple::http
