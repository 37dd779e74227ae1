#include "supple/http/server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>

#include "admission.h"
#include "answerer.h"
#include "durations.h"
#include "thread_watch.h"

namespace supple::http {
namespace {

using Arrival = Connection::Arrival;

constexpr std::size_t quick_threads = 4;  // number of threads that answer probes and refusals
constexpr int reserve_connections = 16;   // connections beyond the limit, for probes and refusals
// After an answer the thread polls the connection for its next request, which saves the way through the lobby. It stops
// when another request needs a thread.
constexpr int max_polls = 10;
constexpr int poll_milliseconds = 2;

/// The address of the client. An IPv6 address is cut to its first 64 bits, because a provider gives each customer a
/// whole /64 network.
std::string peer_address(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (::getpeername(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0) return "unknown";
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (address.ss_family == AF_INET) {
    ::inet_ntop(AF_INET, &reinterpret_cast<sockaddr_in*>(&address)->sin_addr, text.data(), text.size());
  } else if (address.ss_family == AF_INET6) {
    auto& bytes = reinterpret_cast<sockaddr_in6*>(&address)->sin6_addr;
    if (!IN6_IS_ADDR_V4MAPPED(&bytes)) std::fill(bytes.s6_addr + 8, bytes.s6_addr + 16, std::uint8_t{0});
    ::inet_ntop(AF_INET6, &bytes, text.data(), text.size());
  }
  return text.data();
}

}  // namespace

/// Passes each connection between the parts: the accepting thread, the lobby, and the threads that answer.
class Server::Implementation {
 public:
  Implementation(const ServerOptions& options, Router router, Render render, Observe observe, Report report,
                 Guard guard)
      : options_(options),
        router_(std::move(router)),
        admission_(router_, std::move(guard)),
        connections_(options),
        slots_(options.max_requests, options.max_client_fraction),
        library_(options, [this](int socket) { accept(socket); }),
        answerer_(options_, {library_, connections_, slots_, threads_, lobby_},
                  ResponseMaker(std::move(render), std::move(report), options.headers), std::move(observe)),
        threads_(static_cast<std::size_t>(options.max_requests)),
        quick_(quick_threads),
        lobby_([this](Connection& connection) { admission_.admit(connection); },
               [this](std::shared_ptr<Connection> connection) { deliver(std::move(connection)); }) {}

  int take_port() { return library_.take_port(); }

  void serve() {
    if (!stopping()) {
      std::optional<ThreadWatch> watch;
      if (options_.warn) {
        watch.emplace(
            std::vector<ThreadWatch::Watched>{
                {"the thread that accepts connections", [this] { return library_.silence(); }},
                {"the thread that reads what arrives on connections", [this] { return lobby_.silence(); }}},
            duration_of(options_.max_silent_seconds), options_.warn);
      }
      library_.accept_connections();
    }
    lobby_.stop();
    threads_.finish();
    quick_.finish();
  }

  void end() { library_.end(); }
  bool stopping() const { return library_.ending(); }

  Load load() const {
    return {connections_.count(), slots_.occupied(), connections_.evicted(),
            std::chrono::duration<double>(lobby_.silence()).count(),
            std::chrono::duration<double>(library_.silence()).count()};
  }

 private:
  /// Takes a connection, on the accepting thread, and makes room for it if there are too many.
  void accept(int socket) {
    const int yes = 1;
    ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    const auto client = peer_address(socket);
    auto [connection, total_exceeded, client_exceeded] = connections_.open(socket, client);
    // A client that exceeds its own limit loses one of its own connections.
    bool closed_one = client_exceeded && lobby_.evict_one(client);
    if (!closed_one && total_exceeded) closed_one = lobby_.evict_one({});
    if (closed_one) connections_.count_eviction();
    const int surplus = connections_.count() - options_.max_connections;
    connection->surplus = surplus > 0;
    if (surplus <= reserve_connections) return lobby_.take(std::move(connection));
    connection->refuse(connections_.refusal());
    deliver(std::move(connection));
  }

  /// Gives the request a slot, or refuses it if there is none. Returns false for probes and refusals, which need none.
  bool acquire_slot(Connection& connection) {
    if (connection.refusal() || (connection.route && connection.route->probe)) return false;
    auto refusal = connection.surplus ? connections_.refusal() : slots_.acquire(connection.request.client);
    if (refusal) connection.refuse(refusal);
    return !refusal;
  }

  /// Lets another thread answer a request that has arrived or is refused.
  void deliver(std::shared_ptr<Connection> connection) {
    const bool has_slot = acquire_slot(*connection);
    auto& threads = has_slot ? threads_ : quick_;
    threads.enqueue([this, connection = std::move(connection), has_slot]() mutable {
      serve_connection(std::move(connection), has_slot);
    });
  }

  /// Answers requests while the next one follows soon. Then the lobby waits for further ones.
  void serve_connection(std::shared_ptr<Connection> connection, bool has_slot) {
    using After = Answerer::After;
    while (true) {
      const auto after = answerer_.answer(*connection, has_slot);
      if (after == After::close || after == After::answered_by_stand_in) return;
      if (after == After::send) return lobby_.take(std::move(connection));
      if (after == After::linger) {
        connection->linger();
        return lobby_.take(std::move(connection));
      }
      connection->begin_next();
      if (!has_slot || !next_has_arrived(*connection)) return lobby_.take(std::move(connection));
      has_slot = acquire_slot(*connection);
    }
  }

  /// Waits briefly for the next request of a connection. Returns true once it has arrived or is refused.
  bool next_has_arrived(Connection& connection) {
    const auto admit = [this](Connection& c) { admission_.admit(c); };
    for (int attempt = 0; attempt < max_polls && !stopping() && !threads_.has_waiting(); ++attempt) {
      if (!connection.has_input()) {
        pollfd entry{connection.socket(), POLLIN, 0};
        if (::poll(&entry, 1, poll_milliseconds) <= 0) continue;
      }
      const auto arrival = connection.advance(admit);
      if (arrival == Arrival::complete || arrival == Arrival::refused) return true;
      if (arrival == Arrival::closed || connection.has_input()) return false;
    }
    return false;
  }

  const ServerOptions options_;
  const Router router_;
  const Admission admission_;
  OpenConnections connections_;
  RequestSlots slots_;
  LibraryServer library_;
  const Answerer answerer_;
  // The following members come last, because their threads use all of the others.
  ConnectionThreads threads_;
  ConnectionThreads quick_;
  Lobby lobby_;
};

Server::Server(const ServerOptions& options, Router router, Render render, Observe observe, Report report, Guard guard)
    : implementation_(std::make_unique<Implementation>(options, std::move(router), std::move(render),
                                                       std::move(observe), std::move(report), std::move(guard))) {}
Server::~Server() = default;
int Server::bind() { return implementation_->take_port(); }
void Server::run() { implementation_->serve(); }
void Server::stop() { implementation_->end(); }
bool Server::stopping() const { return implementation_->stopping(); }
int Server::connections() const { return implementation_->load().connections; }
Load Server::load() const { return implementation_->load(); }

}  // namespace supple::http
