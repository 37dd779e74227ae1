#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>

#include "supple/problem/problem.h"

namespace supple::http {

/// Counts and limits the bytes of bodies that have not arrived completely, for each client and in total. A slow sender
/// occupies them for long, so they get only a part of the memory for requests. Any thread may call.
class ArrivingBodies {
 public:
  /// Bytes at the start of each body that are not counted, so that small bodies arrive whatever others send.
  static constexpr std::size_t uncounted_bytes = 64 * 1024;

  /// Limits in bytes for all clients together and for each client; 0: no limit.
  ArrivingBodies(std::int64_t max_total, std::int64_t max_per_client)
      : max_total_(max_total), max_per_client_(max_per_client) {}

  /// The bytes that are counted for one body, until it has arrived or is refused.
  class CountedBytes {
   public:
    CountedBytes(ArrivingBodies& bodies, const std::string& client) : bodies_(bodies), client_(&client) {}
    ~CountedBytes() { release(); }
    CountedBytes(const CountedBytes&) = delete;
    CountedBytes& operator=(const CountedBytes&) = delete;

    /// Counts `bytes` more. Beyond the limit of one client it throws ProblemError "server.client_share", beyond the
    /// total limit "server.out_of_memory" (503); it counts nothing then.
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
    const auto found = bytes_of_client_.find(client);
    const std::int64_t client_total = (found == bytes_of_client_.end() ? 0 : found->second) + bytes;
    if (max_per_client_ > 0 && client_total > max_per_client_)
      throw_full("server.client_share", "this client", max_per_client_, client_total);
    if (max_total_ > 0 && used_ + bytes > max_total_)
      throw_full("server.out_of_memory", "all clients", max_total_, used_ + bytes);
    bytes_of_client_[client] = client_total;
    used_ += bytes;
  }
  void remove(const std::string& client, std::int64_t bytes) noexcept {
    if (bytes == 0) return;
    const std::lock_guard lock(mutex_);
    used_ -= bytes;
    const auto found = bytes_of_client_.find(client);
    if ((found->second -= bytes) == 0) bytes_of_client_.erase(found);
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

  const std::int64_t max_total_;
  const std::int64_t max_per_client_;
  std::mutex mutex_;
  std::int64_t used_ = 0;
  std::map<std::string, std::int64_t> bytes_of_client_;
};

}  // namespace supple::http
