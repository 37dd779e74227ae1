#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>

#include "supple/problem/problem.h"

namespace supple::http {

/// Counts the bytes of bodies that have not arrived completely, for each client and for all together. They wait for
/// their senders and nobody computes with them, so that they may take a part of the memory only. Any thread may call.
class ArrivingBodies {
 public:
  /// The first bytes of each body, which are not counted: a small one arrives whatever others send.
  static constexpr std::size_t small = 64 * 1024;

  /// `all` bytes of all clients together and `each` of one; 0: any number.
  ArrivingBodies(std::int64_t all, std::int64_t each) : all_(all), each_(each) {}

  /// The bytes of one body; they come back when it has arrived or is given up.
  class Share {
   public:
    Share(ArrivingBodies& bodies, const std::string& client) : bodies_(bodies), client_(&client) {}
    ~Share() { release(); }
    Share(const Share&) = delete;
    Share& operator=(const Share&) = delete;

    /// Counts so many bytes more. Throws ProblemError "server.client_share" or "server.out_of_memory" (503), and counts
    /// nothing then.
    void add(std::int64_t bytes) {
      bodies_.add(*client_, bytes);
      bytes_ += bytes;
    }
    void release() noexcept {
      bodies_.remove(*client_, bytes_);
      bytes_ = 0;
    }

   private:
    ArrivingBodies& bodies_;
    const std::string* client_;
    std::int64_t bytes_ = 0;
  };

 private:
  static constexpr int seconds_to_retry = 5;

  void add(const std::string& client, std::int64_t bytes) {
    const std::lock_guard lock(mutex_);
    const auto found = of_client_.find(client);
    const std::int64_t own = (found == of_client_.end() ? 0 : found->second) + bytes;
    if (each_ > 0 && own > each_) throw_full("server.client_share", "this client", each_, own);
    if (all_ > 0 && used_ + bytes > all_) throw_full("server.out_of_memory", "all clients", all_, used_ + bytes);
    of_client_[client] = own;
    used_ += bytes;
  }
  void remove(const std::string& client, std::int64_t bytes) noexcept {
    if (bytes == 0) return;
    const std::lock_guard lock(mutex_);
    used_ -= bytes;
    const auto found = of_client_.find(client);
    if ((found->second -= bytes) == 0) of_client_.erase(found);
  }
  [[noreturn]] static void throw_full(const std::string& code, const std::string& whose, std::int64_t limit,
                                      std::int64_t wanted) {
    throw problem::ProblemError(
        {code,
         "The bodies of " + whose + " that have not arrived completely have no room left for another part of " +
             "this one: they may take " + std::to_string(limit) + " bytes (from the setting --memory).",
         {},
         problem::Limit{static_cast<double>(limit), static_cast<double>(wanted), "--memory"},
         seconds_to_retry});
  }

  const std::int64_t all_;
  const std::int64_t each_;
  std::mutex mutex_;
  std::int64_t used_ = 0;
  std::map<std::string, std::int64_t> of_client_;
};

}  // namespace supple::http
