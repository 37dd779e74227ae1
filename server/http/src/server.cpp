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

constexpr double share_of_arriving_bodies = 0.75;  // of the memory of requests
constexpr std::size_t quick_threads = 4;           // answer probes and refusals
constexpr int reserve_connections = 16;            // beyond the limit, for probes and refusals
constexpr int listen_backlog = 512;
constexpr std::chrono::milliseconds accept_period{500};  // in which the thread that accepts is seen at least once
// How long a thread stays with a connection that it has answered on. A client that asks one thing after another is
// spared the way through the lobby; 20 ms hold no thread from others, since it leaves when one is in demand.
constexpr int looks_at_next = 10;
constexpr int look_milliseconds = 2;

Clock::duration seconds(double value) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(value));
}

/// The request that this thread answers.
struct Exchange {
  Connection* connection = nullptr;
  ConnectionStream* stream = nullptr;
  std::atomic<bool> claimed{false};  ///< by who answers: its handler, or what stands in for that
  int status = 0;
  std::string location;
  std::string key;  ///< that the handler names
  bool close_after_answer = false;
};
thread_local Exchange* current = nullptr;

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

/// The library runs what it accepts on the thread that listens, which hands it to the lobby.
class RunAtOnce final : public httplib::TaskQueue {
 public:
  explicit RunAtOnce(std::function<void()> idle) : idle_(std::move(idle)) {}
  void enqueue(std::function<void()> task) override { task(); }
  void on_idle() override { idle_(); }
  void shutdown() override {}

 private:
  const std::function<void()> idle_;
};

/// 16 hexadecimal digits that no other request of this process has, and hardly one of another process: a number that
/// counts on from a random one. It names a request in the log and is no secret.
std::string next_request_id() {
  static std::atomic<std::uint64_t> next{std::uint64_t{std::random_device{}()} << 32U};
  constexpr std::size_t length = 16;
  std::array<char, length> digits{};
  char* const end = std::to_chars(digits.data(), digits.data() + length, next++, 16).ptr;
  std::string text(digits.data(), end);
  return text.insert(0, length - text.size(), '0');
}

/// The address of the other end. An IPv6 address is cut to its first 64 bits, which one customer has to himself.
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

/// The head as the library reads it: without what this server has dealt with already. Answers are neither compressed,
/// which costs more than it saves near the server, nor partial.
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

std::exception_ptr busy(const std::string& code, const std::string& detail, const problem::Limit& limit, int retry) {
  return std::make_exception_ptr(problem::ProblemError({code, detail, {}, limit, retry}));
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
        patience_{seconds(options.idle_seconds), seconds(std::min(options.head_seconds, options.request_seconds)),
                  seconds(options.request_seconds)},
        bodies_(memory_of_bodies(),
                static_cast<std::int64_t>(options.client_share * static_cast<double>(memory_of_bodies()))),
        threads_(static_cast<std::size_t>(options.max_requests)),
        quick_(quick_threads),
        lobby_([this](Connection& connection) { admit(connection); },
               [this](std::shared_ptr<Connection> connection, Arrival) { deliver(std::move(connection)); }) {
    new_task_queue = [this] { return new RunAtOnce([this] { accepts_at_ = Clock::now().time_since_epoch(); }); };
    set_idle_interval(accept_period);
    set_keep_alive_timeout(static_cast<time_t>(options_.idle_seconds));  // what the Keep-Alive header says
    set_keep_alive_max_count(static_cast<std::size_t>(options_.requests_per_connection));
    // The library's default also sets SO_REUSEPORT, with which a second server would silently share the port.
    set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    // Before the library looks for a route of its own, of which there are none.
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
    // The library's own backlog of 5 would make a burst of clients wait for a second.
    ::listen(svr_sock_, listen_backlog);
    return port;
  }

  void serve() {
    if (!stopping_) {
      accepts_at_ = Clock::now().time_since_epoch();
      std::optional<ThreadWatch> watch;
      if (options_.tell) {
        watch.emplace(
            std::vector<ThreadWatch::Watched>{
                {"the thread that accepts connections", [this] { return accept_silence(); }},
                {"the thread that reads what arrives on connections", [this] { return lobby_.silence(); }}},
            seconds(options_.silent_seconds), options_.tell);
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
  /// Counts a connection for as long as it exists.
  class CountedConnection final : public Connection {
   public:
    CountedConnection(Implementation& server, int socket, const std::string& client)
        : Connection(socket, client, server.options_.memory, server.bodies_, server.patience_), server_(server) {}
    ~CountedConnection() { server_.leave(client()); }
    CountedConnection(const CountedConnection&) = delete;
    CountedConnection& operator=(const CountedConnection&) = delete;

   private:
    Implementation& server_;
  };

  /// Answers while the handler is held. The handler's thread keeps the connection, whose request it reads; the answer
  /// leaves by an object and a descriptor of its own, so that neither is gone while one of both uses it.
  class Deputy final : public StandIn {
   public:
    Deputy(Implementation& server, Connection& connection, Exchange& exchange, Clock::time_point begin)
        : server_(server), connection_(connection), exchange_(exchange), begin_(begin) {}

    void answer(const problem::Problem& problem, bool is_replaced) override {
      if (exchange_.claimed.exchange(true)) return;
      answered_ = true;
      const auto& request = connection_.request;
      auto response = server_.render_(problem);
      server_.add_headers(response, request.id);
      const std::chrono::duration<double> taken = Clock::now() - begin_;
      if (is_replaced) {
        server_.leave_place(request.client, taken.count());
        server_.threads_.lend();
        replaced_ = true;
      }
      const auto status = response.status;
      if (request.method == "HEAD") response.body.clear();
      server_.send_last(connection_, text_of_last(response, "Late"));
      server_.observe(connection_, exchange_, status, taken.count());
    }
    bool has_answered() const { return answered_; }
    bool is_replaced() const { return replaced_; }

   private:
    Implementation& server_;
    Connection& connection_;
    Exchange& exchange_;
    const Clock::time_point begin_;
    bool answered_ = false;
    bool replaced_ = false;
  };

  /// Sends an answer that is the connection's last, while another thread holds the connection.
  void send_last(Connection& connection, std::string_view text) {
    const int socket = ::fcntl(connection.socket(), F_DUPFD_CLOEXEC, 0);
    if (socket < 0) {
      // There are too many open files: what the client does not take at once is lost.
      send_now(connection.socket(), text);
      ::shutdown(connection.socket(), SHUT_WR);
      return;
    }
    {
      const std::lock_guard lock(mutex_);
      ++connections_;
      ++connections_of_[connection.client()];
    }
    connection.leave_to_another();
    auto last = std::make_shared<CountedConnection>(*this, socket, connection.client());
    if (!send_now(socket, text)) return;
    if (text.empty()) {
      last->linger();
    } else {
      last->send_later(std::string(text), seconds(options_.write_seconds), true);
    }
    lobby_.take(std::move(last));
  }

  std::int64_t memory_of_bodies() const {
    return options_.memory
               ? static_cast<std::int64_t>(share_of_arriving_bodies * static_cast<double>(options_.memory->total()))
               : 0;
  }
  Clock::duration accept_silence() const { return Clock::now().time_since_epoch() - accepts_at_.load(); }
  int share_of(int all) const { return std::max(1, static_cast<int>(options_.client_share * all)); }

  bool process_and_close_socket(socket_t socket) override {
    accepts_at_ = Clock::now().time_since_epoch();
    const int yes = 1;
    ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    const auto client = peer_address(socket);
    bool all_full = false;
    bool share_full = false;
    {
      const std::lock_guard lock(mutex_);
      ++connections_;
      all_full = connections_ > options_.max_connections;
      share_full = ++connections_of_[client] > share_of(options_.max_connections);
    }
    auto connection = std::make_shared<CountedConnection>(*this, socket, client);
    // Who has more than a share makes room himself.
    bool closed_one = share_full && lobby_.make_room(client);
    if (!closed_one && all_full) closed_one = lobby_.make_room({});
    const int surplus = count_closed(closed_one) - options_.max_connections;
    connection->surplus = surplus > 0;
    if (surplus > reserve_connections) {
      connection->refuse(too_many_connections());
      deliver(std::move(connection));
      return true;
    }
    lobby_.take(std::move(connection));
    return true;
  }

  /// Returns the number of connections that there are then.
  int count_closed(bool closed_one) {
    const std::lock_guard lock(mutex_);
    if (closed_one) ++evicted_;
    return connections_;
  }

  void leave(const std::string& client) {
    const std::lock_guard lock(mutex_);
    --connections_;
    if (const auto found = connections_of_.find(client); --found->second == 0) connections_of_.erase(found);
  }

  /// On the lobby's thread, or on one that has stayed with its connection: the head has arrived.
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

  /// Takes a place among the requests that are answered; refuses the request where there is none. False for one that
  /// needs no place: a probe, or a refusal.
  bool enter(Connection& connection) {
    if (connection.refusal() || (connection.route && connection.route->probe)) return false;
    const std::lock_guard lock(mutex_);
    const auto& client = connection.request.client;
    if (connection.surplus) {
      connection.refuse(too_many_connections());
      return false;
    }
    const int share = share_of(options_.max_requests);
    const auto of_client = answering_for_.find(client);
    if (answering_ >= options_.max_requests) {
      connection.refuse(busy("server.busy",
                             "The server answers " + std::to_string(options_.max_requests) +
                                 " requests, its limit (setting --max-requests).",
                             {static_cast<double>(options_.max_requests),
                              static_cast<double>(options_.max_requests) + 1, "--max-requests"},
                             wait_for_place()));
      return false;
    }
    if (of_client != answering_for_.end() && of_client->second >= share) {
      connection.refuse(busy("server.client_share",
                             "The server answers " + std::to_string(share) +
                                 " requests of this client, a client's share (setting --client-share).",
                             {static_cast<double>(share), static_cast<double>(share) + 1, "--client-share"},
                             wait_for_place()));
      return false;
    }
    ++answering_;
    ++answering_for_[client];
    return true;
  }

  void leave_place(const std::string& client, double taken) {
    constexpr double weight = 0.05;  // of the latest request in the moving average
    const std::lock_guard lock(mutex_);
    --answering_;
    if (const auto found = answering_for_.find(client); --found->second == 0) answering_for_.erase(found);
    mean_seconds_ += weight * (taken - mean_seconds_);
  }

  /// Whole seconds until one of the requests that are answered now will probably be done. Under the mutex.
  int wait_for_place() const {
    constexpr double longest = 60;
    return static_cast<int>(std::ceil(std::clamp(mean_seconds_ / options_.max_requests, 1.0, longest)));
  }

  /// On the lobby's thread: something is to be answered.
  void deliver(std::shared_ptr<Connection> connection) {
    const bool placed = enter(*connection);
    auto& threads = placed ? threads_ : quick_;
    threads.enqueue([this, connection = std::move(connection), placed]() mutable {
      serve_connection(std::move(connection), placed);
    });
  }

  /// Answers on the connection until no further request is there, which is left to the lobby to wait for.
  void serve_connection(std::shared_ptr<Connection> connection, bool placed) {
    while (true) {
      const auto after = answer_on(*connection, placed);
      if (after == After::close || after == After::others) return;
      if (after == After::send) return lobby_.take(std::move(connection));
      if (after == After::linger) {
        connection->linger();
        return lobby_.take(std::move(connection));
      }
      connection->begin_next();
      if (!placed || !next_has_arrived(*connection)) return lobby_.take(std::move(connection));
      placed = enter(*connection);
    }
  }

  /// Stays with a connection for a moment. True once its next request has arrived or is refused.
  bool next_has_arrived(Connection& connection) {
    const auto admission = [this](Connection& c) { admit(c); };
    for (int look = 0; look < looks_at_next && !stopping_ && !threads_.in_demand(); ++look) {
      if (!connection.has_input()) {
        pollfd entry{connection.socket(), POLLIN, 0};
        if (::poll(&entry, 1, look_milliseconds) <= 0) continue;
      }
      const auto arrival = connection.advance(admission);
      if (arrival == Arrival::complete || arrival == Arrival::refused) return true;
      if (arrival == Arrival::closed || connection.has_input()) return false;
    }
    return false;
  }

  enum class After { next, send, linger, close, others };

  /// Leaves the request's place before the last bytes of a small answer are sent: a client that has them may count on
  /// it.
  After answer_on(Connection& connection, bool placed) {
    Exchange exchange;
    exchange.connection = &connection;
    exchange.close_after_answer = connection.unread() || !connection.head() || connection.surplus;
    current = &exchange;
    const auto begin = Clock::now();
    const bool last = ++connection.answered >= options_.requests_per_connection || stopping_;
    bool closed_by_client = false;
    bool sent = false;
    std::string unsent;
    const auto leave = [&] {
      if (!placed) return;
      leave_place(connection.request.client, std::chrono::duration<double>(Clock::now() - begin).count());
    };
    if (connection.head()) {
      const auto head = head_for_library(*connection.head());
      ConnectionStream stream(connection.socket(), options_.write_seconds, head);
      exchange.stream = &stream;
      if (!placed) stream.never_wait();
      Deputy deputy(*this, connection, exchange, begin);
      if (placed) connection.request.stand_in = &deputy;
      const bool answered = process_request(stream, last, closed_by_client, [](httplib::Request&) {});
      connection.request.stand_in = nullptr;
      if (deputy.has_answered()) {
        current = nullptr;
        deputy.is_replaced() ? threads_.take_back() : leave();
        return After::others;
      }
      leave();
      sent = stream.flush();
      unsent = stream.take_unsent();
      if (!answered) exchange.close_after_answer = true;
    } else {
      leave();
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
    return busy("server.too_many_connections",
                "The server has " + std::to_string(options_.max_connections) +
                    " connections, its limit (setting --max-connections).",
                {limit, limit + 1, "--max-connections"}, 1);
  }

  /// An answer after which the connection closes.
  static std::string text_of_last(const Response& response, std::string_view reason) {
    std::string text = "HTTP/1.1 " + std::to_string(response.status) + " ";
    text.append(reason).append("\r\nConnection: close\r\nContent-Type: ").append(response.content_type).append("\r\n");
    for (const auto& [name, value] : response.headers) text.append(name).append(": ").append(value).append("\r\n");
    return text + "Content-Length: " + std::to_string(response.body.size()) + "\r\n\r\n" + response.body;
  }

  /// Answers what is not even a request's head, without the library. Leaves in `unsent` what the client does not take
  /// at once.
  bool send_refusal(const Connection& connection, std::string& unsent) {
    auto response = problem_response(connection.refusal());
    add_headers(response, {});
    current->status = response.status;
    const auto text = text_of_last(response, "Refused");
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

  /// Called by the library once it has read the head: calls the handler and fills the library's response.
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
    } else if (response.pieces && response.pieces->bytes > 0) {
      const auto length = static_cast<std::size_t>(response.pieces->bytes);
      target.set_content_provider(
          length, response.content_type,
          [pieces = *std::move(response.pieces)](std::size_t offset, std::size_t count, httplib::DataSink& sink) {
            return send_pieces(pieces, offset, count, sink);
          });
    } else {
      target.body = std::move(response.body);
      if (!response.content_type.empty()) target.set_header("Content-Type", response.content_type);
    }
  }

  /// All of them in one call: between two of them the library looks whether the server ends, and would cut the answer
  /// off. False where the answer cannot go on.
  static bool send_pieces(const Pieces& pieces, std::size_t offset, std::size_t count, httplib::DataSink& sink) {
    constexpr std::size_t piece = 256 * 1024;
    std::string buffer(std::min(piece, count), '\0');
    try {
      for (const auto end = offset + count; offset < end;) {
        const auto now = std::min(piece, end - offset);
        pieces.read(offset, buffer.data(), now);
        if (!sink.write(buffer.data(), now)) return false;
        offset += now;
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
  const Connection::Patience patience_;
  ArrivingBodies bodies_;
  std::atomic<Clock::duration> accepts_at_{Clock::now().time_since_epoch()};
  std::atomic<bool> stopping_{false};
  std::atomic<bool> stopped_{false};  ///< the library's stop may be called only once
  mutable std::mutex mutex_;
  // Guarded by the mutex.
  int connections_ = 0;
  std::uint64_t evicted_ = 0;
  std::map<std::string, int> connections_of_;  ///< by client
  int answering_ = 0;
  std::map<std::string, int> answering_for_;  ///< by client
  double mean_seconds_ = 0;                   ///< that an answer takes
  // Last: what they run uses all of the others.
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
