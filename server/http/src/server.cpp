#include "supple/http/server.h"

#include <httplib.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <limits>
#include <stdexcept>

#include "connection_stream.h"
#include "connection_threads.h"

namespace supple::http {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t max_path_bytes = 2048;
constexpr double linger_seconds = 2;
constexpr int refusal_threads = 4;  // answer 503 to connections beyond the limit
constexpr int listen_backlog = 512;

Clock::duration seconds(double value) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(value));
}

/// What the handlers of a request, which run on the connection's thread, know of the connection.
struct Connection {
  ConnectionStream* stream = nullptr;
  int socket = -1;
  bool close_after_answer = false;  ///< the request was not read to its end
  std::string pattern;              ///< of the route that answers
  Clock::time_point started{};
};
thread_local Connection* current = nullptr;

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

bool takes_body(const std::string& method) {
  return method == "POST" || method == "PUT" || method == "PATCH" || method == "DELETE";
}

/// The problem of a status that the library itself has set.
problem::Problem library_problem(int status) {
  switch (status) {
    case 404:
      return {"http.not_found", "There is nothing at this path.", {}, {}, {}};
    case 413:
      return {"request.body_too_large", "The body is too large.", {}, {}, {}};
    case 414:
      return {"http.uri_too_long", "The request target is longer than 8192 bytes.", {}, {}, {}};
    case 415:
      return {"http.unsupported_media_type", "The body's encoding or type is not supported.", {}, {}, {}};
    case 416:
      return {"http.range_not_satisfiable", "The header Range cannot be satisfied.", {}, {}, {}};
    default:
      if (status >= 500) return {"server.internal", "The server met an error that it did not expect.", {}, {}, {}};
      return {"http.bad_request", "The request line, a header or the body's framing cannot be read.", {}, {}, {}};
  }
}

}  // namespace

class Server::Implementation final : public httplib::Server {
 public:
  Implementation(const ServerOptions& options, Router router, Render render, Observe observe, Report report)
      : options_(options),
        router_(std::move(router)),
        render_(std::move(render)),
        observe_(std::move(observe)),
        report_(std::move(report)),
        stop_event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (stop_event_ < 0) throw std::runtime_error("eventfd failed");
    new_task_queue = [this] {
      return new ConnectionThreads(static_cast<std::size_t>(options_.max_connections + refusal_threads));
    };
    set_keep_alive_timeout(static_cast<time_t>(options_.idle_seconds));  // what the Keep-Alive header says
    set_keep_alive_max_count(static_cast<std::size_t>(options_.requests_per_connection));
    set_payload_max_length(std::numeric_limits<std::size_t>::max());  // each route has its own limit, see read_body
    // The library's default also sets SO_REUSEPORT, with which a second server would silently share the port.
    set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      // The library matches paths by regular expressions, whose depth of recursion grows with the path.
      const bool answered = request.path.size() > max_path_bytes || !takes_body(request.method);
      if (answered) answer(request, response, nullptr);
      return answered ? HandlerResponse::Handled : HandlerResponse::Unhandled;
    });
    const auto with_body = [this](const httplib::Request& request, httplib::Response& response,
                                  const httplib::ContentReader& reader) { answer(request, response, &reader); };
    Post(".*", with_body);
    Put(".*", with_body);
    Patch(".*", with_body);
    Delete(".*", with_body);
    set_error_handler(HandlerWithResponse([this](const httplib::Request& request, httplib::Response& response) {
      if (response.body.empty()) {
        fill(response, render_(library_problem(response.status)));
        current->close_after_answer = true;
        response.set_header("Connection", "close");
        observe_("", request.method, response.status,
                 std::chrono::duration<double>(Clock::now() - current->started).count());
      }
      return HandlerResponse::Handled;
    }));
  }

  ~Implementation() override { ::close(stop_event_); }

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
    if (!stopping_) listen_after_bind();
  }

  void end() {
    stopping_ = true;
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto written = ::write(stop_event_, &one, sizeof one);
    if (is_running() && !stopped_.exchange(true)) httplib::Server::stop();
  }

  bool stopping() const { return stopping_; }
  int connections() const { return connections_; }

 private:
  bool process_and_close_socket(socket_t socket) override {
    const bool refused = ++connections_ > options_.max_connections;
    const int yes = 1;
    ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    ConnectionStream stream(socket, options_.write_seconds);
    Connection connection;
    connection.stream = &stream;
    connection.socket = socket;
    current = &connection;
    if (refused) {
      refuse(stream);
    } else {
      serve_connection(connection);
    }
    current = nullptr;
    ::shutdown(socket, SHUT_RDWR);
    ::close(socket);
    --connections_;
    return true;
  }

  void serve_connection(Connection& connection) {
    ConnectionStream& stream = *connection.stream;
    for (int left = options_.requests_per_connection; left > 0; --left) {
      if (!stream.has_buffered_input() && !wait_for_request(connection.socket)) return;
      stream.begin_request(Clock::now() + seconds(options_.request_seconds));
      connection.close_after_answer = false;
      connection.started = Clock::now();
      bool closed_by_client = false;
      const bool last = left == 1 || stopping_;
      const bool answered = process_request(stream, last, closed_by_client, [&](httplib::Request& request) {
        stream.head_is_complete();
        connection.started = Clock::now();
        // No compression (it costs more than it saves near the server) and no partial answers.
        request.headers.erase("Accept-Encoding");
        request.headers.erase("Range");
        request.ranges.clear();
        const bool has_body =
            request.get_header_value<std::uint64_t>("Content-Length") > 0 || request.has_header("Transfer-Encoding");
        if (has_body && !takes_body(request.method)) connection.close_after_answer = true;
      });
      if (!stream.flush()) return;
      if (!answered || connection.close_after_answer) return stream.linger(linger_seconds);
      if (last || closed_by_client) return;
    }
  }

  /// Waits for the first byte of a request. False where none comes, or the server stops.
  bool wait_for_request(int socket) const {
    const auto deadline = Clock::now() + seconds(options_.idle_seconds);
    while (true) {
      pollfd entries[2] = {{socket, POLLIN, 0}, {stop_event_, POLLIN, 0}};
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
      const int ready = left > 0 ? ::poll(entries, 2, static_cast<int>(left)) : 0;
      if (ready < 0 && errno == EINTR) continue;
      return ready > 0 && entries[0].revents != 0;
    }
  }

  void refuse(ConnectionStream& stream) {
    problem::Problem problem{"server.too_many_connections", {}, {}, {}, 1};
    problem.limit = problem::Limit{static_cast<double>(options_.max_connections),
                                   static_cast<double>(options_.max_connections) + 1, "--max-connections"};
    problem.detail = "The server has " + std::to_string(options_.max_connections) +
                     " connections, its limit (setting --max-connections).";
    const auto response = render_(problem);
    std::string text = "HTTP/1.1 " + std::to_string(response.status) + " Service Unavailable\r\nConnection: close\r\n" +
                       "Content-Type: " + response.content_type + "\r\n";
    for (const auto& [name, value] : response.headers) text.append(name).append(": ").append(value).append("\r\n");
    text += "Content-Length: " + std::to_string(response.body.size()) + "\r\n\r\n" + response.body;
    stream.write(text.data(), text.size());
    stream.flush();
    stream.linger(0.2);
    observe_("", "", response.status, 0);
  }

  /// Routes a request, reads its body within the route's limit, calls the handler and fills the library's response.
  void answer(const httplib::Request& source, httplib::Response& target, const httplib::ContentReader* reader) {
    Response response;
    current->pattern.clear();
    try {
      response = respond(source, reader);
    } catch (...) {
      const auto exception = std::current_exception();
      const auto problem = problem::problem_of(exception);
      if (problem.code == "server.internal") report_unexpected(exception, source);
      response = render_(problem);
      if (problem.code == "http.method_not_allowed") response.set_header("Allow", router_.allowed(source.path));
    }
    if (current->close_after_answer) response.set_header("Connection", "close");
    observe_(current->pattern, source.method, response.status,
             std::chrono::duration<double>(Clock::now() - current->started).count());
    fill(target, std::move(response));
  }

  Response respond(const httplib::Request& source, const httplib::ContentReader* reader) {
    const bool has_body = has_content(source);
    if (has_body) current->close_after_answer = true;  // until the body has been read
    if (source.path.size() > max_path_bytes) {
      throw Error("http.uri_too_long", "The path has " + std::to_string(source.path.size()) + " bytes, the limit is " +
                                           std::to_string(max_path_bytes) + ".");
    }
    auto match = router_.find(source.method, source.path);
    const Route& route = *match.route;
    current->pattern = route.pattern;
    Request request;
    request.method = source.method;
    request.path = source.path;
    request.path_parameters = std::move(match.path_parameters);
    request.query.insert(source.params.begin(), source.params.end());
    for (const auto& header : source.headers) request.headers.push_back(header);
    request.peer = Peer(current->socket);
    if (has_body && reader) {
      request.body = read_body(source, route.body, *reader);
      current->close_after_answer = false;
    }
    return route.handler(request);
  }

  static bool has_content(const httplib::Request& source) {
    return source.has_header("Transfer-Encoding") ||
           (source.has_header("Content-Length") && source.get_header_value("Content-Length") != "0");
  }

  static std::string read_body(const httplib::Request& source, const BodyLimit& limit,
                               const httplib::ContentReader& reader) {
    if (source.has_header("Transfer-Encoding") && source.has_header("Content-Length")) {
      throw Error("http.bad_request", "The request has both Transfer-Encoding and Content-Length.");
    }
    if (source.is_multipart_form_data()) {
      throw Error("http.unsupported_media_type",
                  "Forms (multipart/form-data) are not read; send the content itself as the body.");
    }
    if (limit.bytes == 0) throw Error("http.bad_request", "This request takes no body.");
    const auto encoding = source.get_header_value("Content-Encoding");
    if (!encoding.empty() && encoding != "identity") {
      throw Error("http.unsupported_media_type",
                  "Compressed bodies are not read; send the body without Content-Encoding.");
    }
    const auto announced = source.get_header_value<std::uint64_t>("Content-Length");
    const auto too_large = [&limit](double bytes) {
      problem::throw_limit("request.body_too_large", "The body's length in bytes", static_cast<double>(limit.bytes),
                           bytes, limit.setting);
    };
    if (announced > limit.bytes) too_large(static_cast<double>(announced));
    std::string body;
    bool exceeded = false;
    body.reserve(std::min<std::uint64_t>(announced, 1 << 20));
    const bool complete = reader([&](const char* data, std::size_t size) {
      if (body.size() + size > limit.bytes) {
        exceeded = true;
        return false;
      }
      body.append(data, size);
      return true;
    });
    if (exceeded) too_large(static_cast<double>(limit.bytes) + 1);
    if (!complete) {
      throw Error("http.bad_request",
                  "The body ended early, did not arrive in time, or its framing or encoding is broken.");
    }
    return body;
  }

  static void fill(httplib::Response& target, Response response) {
    target.status = response.status;
    for (auto& [name, value] : response.headers) target.set_header(name, value);
    if (response.stream) {
      const Peer peer(current->socket);
      target.set_chunked_content_provider(
          response.content_type, [stream = std::move(response.stream), peer](std::size_t, httplib::DataSink& sink) {
            ChunkWriter writer(sink, peer);
            stream(writer);
            sink.done();
            return !writer.client_gone();
          });
    } else {
      target.body = std::move(response.body);
      if (!response.content_type.empty()) target.set_header("Content-Type", response.content_type);
    }
  }

  void report_unexpected(const std::exception_ptr& exception, const httplib::Request& request) const {
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
  const int stop_event_;
  std::atomic<bool> stopping_{false};
  std::atomic<bool> stopped_{false};  ///< the library's stop may be called only once
  std::atomic<int> connections_{0};
};

Server::Server(const ServerOptions& options, Router router, Render render, Observe observe, Report report)
    : implementation_(std::make_unique<Implementation>(options, std::move(router), std::move(render),
                                                       std::move(observe), std::move(report))) {}
Server::~Server() = default;
int Server::bind() { return implementation_->take_port(); }
void Server::run() { implementation_->serve(); }
void Server::stop() { implementation_->end(); }
bool Server::stopping() const { return implementation_->stopping(); }
int Server::connections() const { return implementation_->connections(); }

}  // namespace supple::http
