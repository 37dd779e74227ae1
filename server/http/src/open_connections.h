#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "arriving_bodies.h"
#include "client_counts.h"
#include "connection.h"
#include "supple/http/server.h"

namespace supple::http {

/// Makes the connections of a server and counts those that are open. Any thread may call. The connections must be
/// destroyed before this object.
class OpenConnections {
 public:
  explicit OpenConnections(const ServerOptions& options);

  struct Opened {
    std::shared_ptr<Connection> connection;
    bool total_exceeded = false;   ///< whether more connections are open than all clients together may have
    bool client_exceeded = false;  ///< whether the client has more connections than one client may have
  };
  /// Makes the connection that owns the socket. It is counted until it is destroyed, even if it exceeds a limit.
  Opened open(int socket, const std::string& client);
  /// Counts a connection that was closed to make room for another one.
  void count_eviction();
  /// The problem "server.too_many_connections" (503) of a connection beyond the limit.
  std::exception_ptr refusal() const;
  int count() const;
  std::uint64_t evicted() const;

 private:
  class CountedConnection;

  const Connection::Timeouts timeouts_;
  budget::MemoryBudget* const memory_;
  const int max_connections_;
  const int max_of_client_;
  ArrivingBodies bodies_;
  mutable std::mutex mutex_;
  // The following members are guarded by the mutex.
  ClientCounts counts_;
  std::uint64_t evicted_ = 0;
};

}  // namespace supple::http
