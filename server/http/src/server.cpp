#include "supple/http/server.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <httplib.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <random>
#include <stdexcept>

#include "connection.h"
#include "connection_stream.h"
#include "connection_threads.h"
#include "lobby.h"
#include "supple/log/context.h"
#include "thread_watch.h"

namespace supple::http {
namespace {

using Clock = std::chrono::steady_clock;
using Arrival = Connection::Arrival;

constexpr double arriving_bodies_fraction = 0.75;  // fraction of the memory of requests
constexpr std::size_t quick_threads = 4;           // number of threads that answer probes and refusals
constexpr int reserve_connections = 16;            // connections beyond the limit, for probes and refusals
constexpr int listen_backlog = 512;
constexpr std::chrono::milliseconds accept_period{500};  // the accepting thread wakes up at least this often
// After an answer the thread polls the connection for its next request, which saves the way through the lobby. It stops
// when another request needs a thread.
constexpr int max_polls = 10;
constexpr int poll_milliseconds = 2;

Clock::duration seconds(double value) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(value));
}

/// The request that a thread answers, and its answer.
struct Exchange {
  Connection* connection = nullptr;
  ConnectionStream* stream = nullptr;
  std::atomic<bool> claimed{false};  ///< set by whichever answers first: the handler or its stand-in
  int status = 0;
  std::string location;
  std::string key;  ///< id of the key that the handler has found (Response::key)
  bool close_after_answer = false;
};
thread_local Exchange* current = nullptr;  // the request that this thread answers

class ChunkWriter final : public StreamWriter {
 public:
  ChunkWriter(httplib::DataSink& sink, Peer peer) : sink_(sink), peer_(peer) {}
  bool write(std::string_view text) override {
    return gone_ ? false : !(gone_ = peer_.hung_up() || !sink_.write(text.data(), text.size()));
  }
  bool client_gone() override { return gone_ || (gone_ = peer_.hung_up()); }

 private:
  httplib::DataSink& sink_;
  Peer peer_;
  bool gone_ = false;
};

/// Runs the library's tasks on the accepting thread, because a task only hands a connection to the lobby.
class InlineTaskQueue final : public httplib::TaskQueue {
 public:
  explicit InlineTaskQueue(std::function<void()> idle) : idle_(std::move(idle)) {}
  void enqueue(std::function<void()> task) override { task(); }
  void on_idle() override { idle_(); }
  void shutdown() override {}

 private:
  const std::function<void()> idle_;
};

/// A new id of a request, 16 hexadecimal digits. Ids count on from a random number, so that they are unique in this
/// process and very probably among all processes. They are not secret.
std::string next_request_id() {
  static std::atomic<std::uint64_t> next{std::uint64_t{std::random_device{}()} << 32U};
  constexpr std::size_t length = 16;
  std::array<char, length> digits{};
  char* const end = std::to_chars(digits.data(), digits.data() + length, next++, 16).ptr;
  std::string text(digits.data(), end);
  return text.insert(0, length - text.size(), '0');
}

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

/// The head for the library, without the headers that this server handles itself. Without Range and Accept-Encoding
/// answers are whole and not compressed, which would cost more than it saves near the server.
std::string head_for_library(const RequestHead& head) {
  std::string text = head.method + " " + head.target + " HTTP/1." + std::to_string(head.minor_version) + "\r\n";
  text += head.asks_to_close() ? "Connection: close\r\n" : "Connection: Keep-Alive\r\n";
  if (const auto accept = head.header("Accept"); !accept.empty()) text.append("Accept: ").append(accept).append("\r\n");
  return text + "\r\n";
}

void check_body(const Request& request) {
  if (media_type(request.header("Content-Type")) == "multipart/form-data") {
    throw Error("http.unsupported_media_type",
                "Forms (multipart/form-data) are not read; send the content itself as the body.");
  }
  const auto encoding = request.header("Content-Encoding");
  if (!encoding.empty() && encoding != "identity") {
    throw Error("http.unsupported_media_type",
                "Compressed bodies are not read; send the body without Content-Encoding.");
  }
}

std::exception_ptr limit_refusal(const std::string& code, const std::string& detail, const problem::Limit& limit,
                                 int retry_seconds) {
  return std::make_exception_ptr(problem::ProblemError({code, detail, {}, limit, retry_seconds}));
}

}  // namespace

class Server::Implementation final : public httplib::Server {
 public:
  Implementation(const ServerOptions& options, Router router, Render render, Observe observe, Report report,
                 Guard guard)
      : options_(options),
        router_(std::move(router)),
        render_(std::move(render)),
        observe_(std::move(observe)),
        report_(std::move(report)),
        guard_(std::move(guard)),
        timeouts_{seconds(options.idle_seconds), seconds(std::min(options.head_seconds, options.request_seconds)),
                  seconds(options.request_seconds)},
        bodies_(max_arriving_bytes(),
                static_cast<std::int64_t>(options.max_client_fraction * static_cast<double>(max_arriving_bytes()))),
        threads_(static_cast<std::size_t>(options.max_requests)),
        quick_(quick_threads),
        lobby_([this](Connection& connection) { admit(connection); },
               [this](std::shared_ptr<Connection> connection, Arrival) { deliver(std::move(connection)); }) {
    new_task_queue = [this] { return new InlineTaskQueue([this] { last_accept_ = Clock::now().time_since_epoch(); }); };
    set_idle_interval(accept_period);
    set_keep_alive_timeout(static_cast<time_t>(options_.idle_seconds));  // sent in the header Keep-Alive
    set_keep_alive_max_count(static_cast<std::size_t>(options_.requests_per_connection));
    // The library's default also sets SO_REUSEPORT, which would let a second server share the port unnoticed.
    set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    // This handler answers every request. The library has no routes of its own.
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      answer(request, response);
      return HandlerResponse::Handled;
    });
  }

  int take_port() {
    int port = options_.port;
    if (port == 0) {
      port = bind_to_any_port(options_.host);
    } else if (!bind_to_port(options_.host, port)) {
      port = -1;
    }
    if (port <= 0) {
      throw std::runtime_error("cannot listen on " + options_.host + ":" + std::to_string(options_.port) +
                               ": the address is not of this machine, or the port is taken");
    }
    // With the library's backlog of 5 some clients of a burst would wait for a second.
    ::listen(svr_sock_, listen_backlog);
    return port;
  }

  void serve() {
    if (!stopping_) {
      last_accept_ = Clock::now().time_since_epoch();
      std::optional<ThreadWatch> watch;
      if (options_.warn) {
        watch.emplace(
            std::vector<ThreadWatch::Watched>{
                {"the thread that accepts connections", [this] { return accept_silence(); }},
                {"the thread that reads what arrives on connections", [this] { return lobby_.silence(); }}},
            seconds(options_.max_silent_seconds), options_.warn);
      }
      listen_after_bind();
    }
    lobby_.stop();
    threads_.finish();
    quick_.finish();
  }

  void end() {
    stopping_ = true;
    if (is_running() && !stopped_.exchange(true)) httplib::Server::stop();
  }

  bool stopping() const { return stopping_; }
  Load load() const {
    const std::lock_guard lock(mutex_);
    return {connections_, answering_, evicted_, std::chrono::duration<double>(lobby_.silence()).count(),
            std::chrono::duration<double>(accept_silence()).count()};
  }

 private:
  /// A connection that is counted for as long as it exists.
  class CountedConnection final : public Connection {
   public:
    CountedConnection(Implementation& server, int socket, const std::string& client)
        : Connection(socket, client, server.options_.memory, server.bodies_, server.timeouts_), server_(server) {}
    ~CountedConnection() { server_.uncount_connection(client()); }
    CountedConnection(const CountedConnection&) = delete;
    CountedConnection& operator=(const CountedConnection&) = delete;

   private:
    Implementation& server_;
  };

  /// Answers in place of a handler that has not returned in time. The handler's thread still uses the connection, so
  /// that the answer is sent by a second object with a duplicate descriptor.
  class HandlerStandIn final : public StandIn {
   public:
    HandlerStandIn(Implementation& server, Connection& connection, Exchange& exchange, Clock::time_point begin)
        : server_(server), connection_(connection), exchange_(exchange), begin_(begin) {}

    void answer(const problem::Problem& problem, bool releases_slot) override {
      if (exchange_.claimed.exchange(true)) return;
      answered_ = true;
      const auto& request = connection_.request;
      auto response = server_.render_(problem);
      server_.add_headers(response, request.id);
      const std::chrono::duration<double> taken = Clock::now() - begin_;
      if (releases_slot) {
        server_.release_slot(request.client, taken.count());
        server_.threads_.raise_limit();
        slot_is_released_ = true;
      }
      const auto status = response.status;
      if (request.method == "HEAD") response.body.clear();
      server_.send_last(connection_, closing_answer(response, "Late"));
      server_.observe(connection_, exchange_, status, taken.count());
    }
    bool has_answered() const { return answered_; }
    bool slot_is_released() const { return slot_is_released_; }

   private:
    Implementation& server_;
    Connection& connection_;
    Exchange& exchange_;
    const Clock::time_point begin_;
    bool answered_ = false;
    bool slot_is_released_ = false;
  };

  /// Sends the last answer on a connection that another thread still uses.
  void send_last(Connection& connection, std::string_view text) {
    const int socket = ::fcntl(connection.socket(), F_DUPFD_CLOEXEC, 0);
    if (socket < 0) {
      // Too many files are open. What the client does not take at once is lost.
      send_now(connection.socket(), text);
      ::shutdown(connection.socket(), SHUT_WR);
      return;
    }
    {
      const std::lock_guard lock(mutex_);
      ++connections_;
      ++connections_of_[connection.client()];
    }
    connection.skip_shutdown();
    auto last = std::make_shared<CountedConnection>(*this, socket, connection.client());
    if (!send_now(socket, text)) return;
    if (text.empty()) {
      last->linger();
    } else {
      last->send_later(std::string(text), seconds(options_.write_seconds), true);
    }
    lobby_.take(std::move(last));
  }

  std::int64_t max_arriving_bytes() const {
    return options_.memory
               ? static_cast<std::int64_t>(arriving_bodies_fraction * static_cast<double>(options_.memory->total()))
               : 0;
  }
  Clock::duration accept_silence() const { return Clock::now().time_since_epoch() - last_accept_.load(); }
  int max_per_client(int all) const { return std::max(1, static_cast<int>(options_.max_client_fraction * all)); }

  bool process_and_close_socket(socket_t socket) override {
    last_accept_ = Clock::now().time_since_epoch();
    const int yes = 1;
    ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    const auto client = peer_address(socket);
    bool all_full = false;
    bool client_full = false;
    {
      const std::lock_guard lock(mutex_);
      ++connections_;
      all_full = connections_ > options_.max_connections;
      client_full = ++connections_of_[client] > max_per_client(options_.max_connections);
    }
    auto connection = std::make_shared<CountedConnection>(*this, socket, client);
    // A client that exceeds its own limit loses one of its own connections.
    bool closed_one = client_full && lobby_.evict_one(client);
    if (!closed_one && all_full) closed_one = lobby_.evict_one({});
    const int surplus = count_eviction(closed_one) - options_.max_connections;
    connection->surplus = surplus > 0;
    if (surplus > reserve_connections) {
      connection->refuse(too_many_connections());
      deliver(std::move(connection));
      return true;
    }
    lobby_.take(std::move(connection));
    return true;
  }

  /// Returns the number of connections.
  int count_eviction(bool closed_one) {
    const std::lock_guard lock(mutex_);
    if (closed_one) ++evicted_;
    return connections_;
  }

  void uncount_connection(const std::string& client) {
    const std::lock_guard lock(mutex_);
    --connections_;
    if (const auto found = connections_of_.find(client); --found->second == 0) connections_of_.erase(found);
  }

  /// Called on the lobby's thread or in `next_has_arrived`, when the head of a request has arrived.
  void admit(Connection& connection) {
    const auto& head = *connection.head();
    auto& request = connection.request;
    request.id = next_request_id();
    request.method = head.method;
    request.path = head.path;
    request.host = head.host;
    request.query = read_query(head.query);
    request.headers = head.headers;
    request.peer = Peer(connection.socket());
    request.client = connection.client();
    std::exception_ptr no_route;
    try {
      auto match = router_.find(head.method, head.path);
      connection.route = match.route;
      request.path_parameters = std::move(match.path_parameters);
    } catch (const Error&) {
      no_route = std::current_exception();
    }
    if (guard_) guard_(request, connection.route);
    if (no_route) std::rethrow_exception(no_route);
    if (head.has_body()) check_body(request);
  }

  /// Counts the request among those being answered, and refuses it if there are too many. Returns false for probes and
  /// refusals, which need no slot.
  bool acquire_slot(Connection& connection) {
    if (connection.refusal() || (connection.route && connection.route->probe)) return false;
    const std::lock_guard lock(mutex_);
    const auto& client = connection.request.client;
    if (connection.surplus) {
      connection.refuse(too_many_connections());
      return false;
    }
    const int client_limit = max_per_client(options_.max_requests);
    const auto of_client = answering_for_.find(client);
    if (answering_ >= options_.max_requests) {
      connection.refuse(limit_refusal("server.busy",
                                      "The server answers " + std::to_string(options_.max_requests) +
                                          " requests, its limit (setting --max-requests).",
                                      {static_cast<double>(options_.max_requests),
                                       static_cast<double>(options_.max_requests) + 1, "--max-requests"},
                                      seconds_until_slot()));
      return false;
    }
    if (of_client != answering_for_.end() && of_client->second >= client_limit) {
      connection.refuse(
          limit_refusal("server.client_share",
                        "The server answers " + std::to_string(client_limit) +
                            " requests of this client, a client's share (setting --client-share).",
                        {static_cast<double>(client_limit), static_cast<double>(client_limit) + 1, "--client-share"},
                        seconds_until_slot()));
      return false;
    }
    ++answering_;
    ++answering_for_[client];
    return true;
  }

  void release_slot(const std::string& client, double taken) {
    constexpr double weight = 0.05;  // weight of the latest request in the moving average
    const std::lock_guard lock(mutex_);
    --answering_;
    if (const auto found = answering_for_.find(client); --found->second == 0) answering_for_.erase(found);
    mean_seconds_ += weight * (taken - mean_seconds_);
  }

  /// Estimated time until a slot is free, in whole seconds. The caller holds the mutex.
  int seconds_until_slot() const {
    constexpr double max_seconds = 60;
    return static_cast<int>(std::ceil(std::clamp(mean_seconds_ / options_.max_requests, 1.0, max_seconds)));
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
    while (true) {
      const auto after = answer_on(*connection, has_slot);
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
    const auto admission = [this](Connection& c) { admit(c); };
    for (int attempt = 0; attempt < max_polls && !stopping_ && !threads_.has_waiting(); ++attempt) {
      if (!connection.has_input()) {
        pollfd entry{connection.socket(), POLLIN, 0};
        if (::poll(&entry, 1, poll_milliseconds) <= 0) continue;
      }
      const auto arrival = connection.advance(admission);
      if (arrival == Arrival::complete || arrival == Arrival::refused) return true;
      if (arrival == Arrival::closed || connection.has_input()) return false;
    }
    return false;
  }

  /// What happens to the connection after an answer.
  enum class After {
    next,                 ///< its next request is read
    send,                 ///< the lobby sends the rest of the answer
    linger,               ///< it closes after its input has been discarded
    close,                ///< it closes at once
    answered_by_stand_in  ///< the stand-in has answered and closes it
  };

  /// Answers one request. The slot is released before the end of a small answer is sent, so that a client that has the
  /// answer finds it free.
  After answer_on(Connection& connection, bool has_slot) {
    Exchange exchange;
    exchange.connection = &connection;
    exchange.close_after_answer = connection.unread() || !connection.head() || connection.surplus;
    current = &exchange;
    const auto begin = Clock::now();
    const bool last = ++connection.answered >= options_.requests_per_connection || stopping_;
    bool closed_by_client = false;
    bool sent = false;
    std::string unsent;
    const auto release = [&] {
      if (!has_slot) return;
      release_slot(connection.request.client, std::chrono::duration<double>(Clock::now() - begin).count());
    };
    if (connection.head()) {
      const auto head = head_for_library(*connection.head());
      ConnectionStream stream(connection.socket(), options_.write_seconds, head);
      exchange.stream = &stream;
      if (!has_slot) stream.never_wait();
      HandlerStandIn handler_stand_in(*this, connection, exchange, begin);
      if (has_slot) connection.request.stand_in = &handler_stand_in;
      const bool answered = process_request(stream, last, closed_by_client, [](httplib::Request&) {});
      connection.request.stand_in = nullptr;
      if (handler_stand_in.has_answered()) {
        current = nullptr;
        handler_stand_in.slot_is_released() ? threads_.lower_limit() : release();
        return After::answered_by_stand_in;
      }
      release();
      sent = stream.flush();
      unsent = stream.take_unsent();
      if (!answered) exchange.close_after_answer = true;
    } else {
      release();
      sent = send_refusal(connection, unsent);
    }
    current = nullptr;
    observe(connection, exchange, exchange.status, std::chrono::duration<double>(Clock::now() - begin).count());
    if (!sent) return After::close;
    if (!unsent.empty()) {
      connection.send_later(std::move(unsent), seconds(options_.write_seconds),
                            exchange.close_after_answer || last || closed_by_client);
      return After::send;
    }
    if (exchange.close_after_answer) return After::linger;
    return last || closed_by_client ? After::close : After::next;
  }

  void observe(const Connection& connection, const Exchange& exchange, int status, double taken) const {
    if (!observe_) return;
    const auto& request = connection.request;
    observe_({request.id, connection.client(), exchange.key.empty() ? request.key : exchange.key,
              connection.route ? connection.route->pattern : std::string(), request.method, request.path,
              exchange.location, status, taken, request.body.size()});
  }

  std::exception_ptr too_many_connections() const {
    const double limit = options_.max_connections;
    return limit_refusal("server.too_many_connections",
                         "The server has " + std::to_string(options_.max_connections) +
                             " connections, its limit (setting --max-connections).",
                         {limit, limit + 1, "--max-connections"}, 1);
  }

  /// The text of an answer after which the connection closes.
  static std::string closing_answer(const Response& response, std::string_view reason) {
    std::string text = "HTTP/1.1 " + std::to_string(response.status) + " ";
    text.append(reason).append("\r\nConnection: close\r\nContent-Type: ").append(response.content_type).append("\r\n");
    for (const auto& [name, value] : response.headers) text.append(name).append(": ").append(value).append("\r\n");
    return text + "Content-Length: " + std::to_string(response.body.size()) + "\r\n\r\n" + response.body;
  }

  /// Refuses a request whose head could not be read, without the library. `unsent` is what the client does not take at
  /// once.
  bool send_refusal(const Connection& connection, std::string& unsent) {
    auto response = problem_response(connection.refusal());
    add_headers(response, {});
    current->status = response.status;
    const auto text = closing_answer(response, "Refused");
    std::string_view left = text;
    const bool sent = send_now(connection.socket(), left);
    unsent = left;
    return sent;
  }

  Response problem_response(const std::exception_ptr& exception) {
    const auto problem = problem::problem_of(exception);
    if (problem.code == "server.internal") report_unexpected(exception, current->connection->request);
    auto response = render_(problem);
    if (problem.code == "http.method_not_allowed") {
      response.set_header("Allow", router_.allowed(current->connection->request.path));
    }
    return response;
  }

  /// Called by the library once it has parsed the head: runs the handler and fills the library's response.
  void answer(const httplib::Request&, httplib::Response& target) {
    auto& connection = *current->connection;
    const log::Context context("request", connection.request.id.empty() ? "-" : connection.request.id);
    Response response;
    try {
      if (connection.refusal()) std::rethrow_exception(connection.refusal());
      const budget::RequestMemory memory(connection.memory());
      response = connection.route->handler(connection.request);
    } catch (...) {
      response = problem_response(std::current_exception());
    }
    if (current->claimed.exchange(true)) {
      current->stream->drop();
      target.status = response.status;
      return;
    }
    if (current->close_after_answer) response.set_header("Connection", "close");
    add_headers(response, connection.request.id);
    current->status = response.status;
    current->key = response.key;
    for (const auto& [name, value] : response.headers)
      if (name == "Location") current->location = value;
    fill(target, std::move(response));
  }

  void add_headers(Response& response, const std::string& id) const {
    for (const auto& [name, value] : options_.headers) {
      const bool is_set = std::any_of(response.headers.begin(), response.headers.end(),
                                      [&, name = &name](const auto& header) { return header.first == *name; });
      if (!is_set) response.set_header(name, value);
    }
    if (!id.empty()) response.set_header("Supple-Request-Id", id);
  }

  static void fill(httplib::Response& target, Response response) {
    target.status = response.status;
    for (auto& [name, value] : response.headers) target.set_header(name, value);
    if (response.stream) {
      current->stream->send_at_once();
      const Peer peer(current->connection->socket());
      target.set_chunked_content_provider(
          response.content_type, [stream = std::move(response.stream), peer](std::size_t, httplib::DataSink& sink) {
            ChunkWriter writer(sink, peer);
            stream(writer);
            sink.done();
            return !writer.client_gone();
          });
    } else if (response.piecewise_body && response.piecewise_body->bytes > 0) {
      const auto length = static_cast<std::size_t>(response.piecewise_body->bytes);
      target.set_content_provider(
          length, response.content_type,
          [body = *std::move(response.piecewise_body)](std::size_t offset, std::size_t count, httplib::DataSink& sink) {
            return send_piecewise(body, offset, count, sink);
          });
    } else {
      target.body = std::move(response.body);
      if (!response.content_type.empty()) target.set_header("Content-Type", response.content_type);
    }
  }

  /// Sends all pieces in one call, because between two calls the library would cut the answer off if the server stops.
  /// Returns false if a piece cannot be read or sent.
  static bool send_piecewise(const PiecewiseBody& body, std::size_t offset, std::size_t count,
                             httplib::DataSink& sink) {
    constexpr std::size_t piece = 256 * 1024;
    std::string buffer(std::min(piece, count), '\0');
    try {
      for (const auto end = offset + count; offset < end;) {
        const auto bytes = std::min(piece, end - offset);
        body.read(offset, buffer.data(), bytes);
        if (!sink.write(buffer.data(), bytes)) return false;
        offset += bytes;
      }
      return true;
    } catch (...) {
      return false;
    }
  }

  void report_unexpected(const std::exception_ptr& exception, const Request& request) const {
    std::string text = "an exception of unknown type";
    try {
      std::rethrow_exception(exception);
    } catch (const std::exception& error) {
      text = error.what();
    } catch (...) {
    }
    report_(request.method + " " + request.path + ": " + text);
  }

  const ServerOptions options_;
  const Router router_;
  const Render render_;
  const Observe observe_;
  const Report report_;
  const Guard guard_;
  const Connection::Timeouts timeouts_;
  ArrivingBodies bodies_;
  std::atomic<Clock::duration> last_accept_{Clock::now().time_since_epoch()};
  std::atomic<bool> stopping_{false};
  std::atomic<bool> stopped_{false};  ///< whether the library's stop was called, which is allowed once
  mutable std::mutex mutex_;
  // The following members are guarded by the mutex.
  int connections_ = 0;
  std::uint64_t evicted_ = 0;
  std::map<std::string, int> connections_of_;  ///< by client
  int answering_ = 0;                          ///< slots that are taken
  std::map<std::string, int> answering_for_;   ///< the same by client
  double mean_seconds_ = 0;                    ///< moving average of the time that an answer takes
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
