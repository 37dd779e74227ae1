#pragma once

#include <algorithm>
#include <map>
#include <string>

namespace supple::http {

/// The limit of one client, where `max_total` is the limit of all clients together.
inline int max_of_client(double max_client_fraction, int max_total) {
  return std::max(1, static_cast<int>(max_client_fraction * max_total));
}

/// Counts something in total and for each client. One thread at a time may use it.
class ClientCounts {
 public:
  void add(const std::string& client) {
    ++of_client_[client];
    ++total_;
  }
  void remove(const std::string& client) {
    --total_;
    if (const auto found = of_client_.find(client); --found->second == 0) of_client_.erase(found);
  }
  int total() const { return total_; }
  int of(const std::string& client) const {
    const auto found = of_client_.find(client);
    return found == of_client_.end() ? 0 : found->second;
  }

 private:
  int total_ = 0;
  std::map<std::string, int> of_client_;
};

}  // namespace supple::http
