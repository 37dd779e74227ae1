#include "request_slots.h"

#include <algorithm>
#include <cmath>

#include "limit_refusal.h"

namespace supple::http {

std::exception_ptr RequestSlots::refusal(const ClientCounts& taken, const std::string& client,
                                         const std::string& where) const {
  if (taken.total() >= max_requests_) {
    return limit_refusal("server.busy",
                         "The server answers " + std::to_string(max_requests_) + " requests" + where + ", its limit",
                         max_requests_, "--max-requests", seconds_until_slot());
  }
  if (taken.of(client) >= max_of_client_) {
    return limit_refusal("server.client_share",
                         "The server answers " + std::to_string(max_of_client_) + " requests of this client" + where +
                             ", a client's share",
                         max_of_client_, "--client-share", seconds_until_slot());
  }
  return nullptr;
}

std::exception_ptr RequestSlots::acquire(const std::string& client) {
  const std::lock_guard lock(mutex_);
  if (auto refused = refusal(occupied_, client, "")) return refused;
  occupied_.add(client);
  return nullptr;
}

std::exception_ptr RequestSlots::move_to_background(const std::string& client) {
  const std::lock_guard lock(mutex_);
  if (auto refused = refusal(in_background_, client, " in the background")) return refused;
  in_background_.add(client);
  occupied_.remove(client);
  return nullptr;
}

void RequestSlots::release_in_background(const std::string& client) {
  const std::lock_guard lock(mutex_);
  in_background_.remove(client);
}

void RequestSlots::release(const std::string& client, double seconds) {
  constexpr double weight = 0.05;  // weight of the latest request in the moving average
  const std::lock_guard lock(mutex_);
  occupied_.remove(client);
  mean_seconds_ += weight * (seconds - mean_seconds_);
}

int RequestSlots::occupied() const {
  const std::lock_guard lock(mutex_);
  return occupied_.total() + in_background_.total();
}

int RequestSlots::seconds_until_slot() const {
  constexpr double max_seconds = 60;
  return static_cast<int>(std::ceil(std::clamp(mean_seconds_ / max_requests_, 1.0, max_seconds)));
}

}  // namespace supple::http
