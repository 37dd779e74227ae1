#include "open_connections.h"

#include <algorithm>

#include "durations.h"
#include "limit_refusal.h"

namespace supple::http {
namespace {

std::int64_t max_arriving_bytes(const ServerOptions& options) {
  constexpr double arriving_bodies_fraction = 0.75;  // fraction of the memory of requests
  return options.memory
             ? static_cast<std::int64_t>(arriving_bodies_fraction * static_cast<double>(options.memory->total()))
             : 0;
}

}  // namespace

/// A connection that is counted for as long as it exists.
class OpenConnections::CountedConnection final : public Connection {
 public:
  CountedConnection(OpenConnections& all, int socket, const std::string& client)
      : Connection(socket, client, all.memory_, all.bodies_, all.timeouts_), all_(all) {
    const std::lock_guard lock(all_.mutex_);
    all_.counts_.add(client);
  }
  ~CountedConnection() {
    const std::lock_guard lock(all_.mutex_);
    all_.counts_.remove(client());
  }
  CountedConnection(const CountedConnection&) = delete;
  CountedConnection& operator=(const CountedConnection&) = delete;

 private:
  OpenConnections& all_;
};

OpenConnections::OpenConnections(const ServerOptions& options)
    : timeouts_{duration_of(options.idle_seconds), duration_of(std::min(options.head_seconds, options.request_seconds)),
                duration_of(options.request_seconds)},
      memory_(options.memory),
      max_connections_(options.max_connections),
      max_of_client_(max_of_client(options.max_client_fraction, options.max_connections)),
      bodies_(
          max_arriving_bytes(options),
          static_cast<std::int64_t>(options.max_client_fraction * static_cast<double>(max_arriving_bytes(options)))) {}

OpenConnections::Opened OpenConnections::open(int socket, const std::string& client) {
  auto connection = std::make_shared<CountedConnection>(*this, socket, client);
  const std::lock_guard lock(mutex_);
  return {std::move(connection), counts_.total() > max_connections_, counts_.of(client) > max_of_client_};
}

void OpenConnections::count_eviction() {
  const std::lock_guard lock(mutex_);
  ++evicted_;
}

std::exception_ptr OpenConnections::refusal() const {
  return limit_refusal("server.too_many_connections",
                       "The server has " + std::to_string(max_connections_) + " connections, its limit",
                       max_connections_, "--max-connections", 1);
}

int OpenConnections::count() const {
  const std::lock_guard lock(mutex_);
  return counts_.total();
}

std::uint64_t OpenConnections::evicted() const {
  const std::lock_guard lock(mutex_);
  return evicted_;
}

}  // namespace supple::http
