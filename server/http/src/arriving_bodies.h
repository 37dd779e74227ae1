#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>

namespace supple::http {

/// Bytes of bodies that have not arrived completely, of each client and of all. They wait for their senders and nobody
/// computes with them, so that they may take a part of the memory only. Any thread may call.
class ArrivingBodies {
 public:
  /// Of each body so many bytes are not counted: a small one arrives whatever others send.
  static constexpr std::size_t small = 64 * 1024;

  /// `all` bytes of all clients together and `each` of one; 0: any number.
  ArrivingBodies(std::int64_t all, std::int64_t each) : all_(all), each_(each) {}

  /// The bytes of one body; they come back when it has arrived or is given up.
  class Share {
   public:
    Share() = default;
    Share(ArrivingBodies& bodies, const std::string& client) : bodies_(&bodies), client_(&client) {}
    ~Share() { release(); }
    Share(const Share&) = delete;
    Share& operator=(const Share&) = delete;

    /// Counts so many bytes more. Throws ProblemError "server.client_share" or "server.out_of_memory" (503), and counts
    /// nothing then.
    void add(std::int64_t bytes);
    void release() noexcept;

   private:
    ArrivingBodies* bodies_ = nullptr;
    const std::string* client_ = nullptr;
    std::int64_t bytes_ = 0;
  };

 private:
  const std::int64_t all_;
  const std::int64_t each_;
  std::mutex mutex_;
  std::int64_t used_ = 0;
  std::map<std::string, std::int64_t> of_client_;
};

}  // namespace supple::http
