#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "supple/base/cancellation.h"

namespace supple::jobs {

/// The latest unfinished computation of each session. Any thread may call. No other mutex is locked while
/// its own one is.
class Sessions {
 public:
  /// Requests the stop of the session's earlier computation, and takes its place. Returns the number to leave with.
  std::uint64_t enter(const std::string& session, const CancellationToken& token) {
    if (session.empty()) return 0;
    const std::lock_guard lock(mutex_);
    const auto number = ++last_number_;
    const auto [entry, is_new] = latest_.try_emplace(session, number, token);
    if (!is_new) {
      entry->second.second.request(StopReason::superseded);
      entry->second = {number, token};
    }
    return number;
  }

  /// Does nothing if a later computation has taken the place.
  void leave(const std::string& session, std::uint64_t number) {
    const std::lock_guard lock(mutex_);
    const auto entry = latest_.find(session);
    if (entry != latest_.end() && entry->second.first == number) latest_.erase(entry);
  }

 private:
  std::mutex mutex_;
  std::map<std::string, std::pair<std::uint64_t, CancellationToken>> latest_;
  std::uint64_t last_number_ = 0;
};

}  // namespace supple::jobs
