#include "library_server.h"

#include <sys/socket.h>

#include <stdexcept>

#include "supple/problem/problem.h"

namespace supple::http {
namespace {

constexpr int listen_backlog = 512;
constexpr std::chrono::milliseconds accept_period{500};  // the accepting thread wakes up at least this often

/// Fills the response that this thread makes. The library hands nothing of its caller to its handler.
thread_local const LibraryServer::Fill* current_fill = nullptr;

/// Runs the library's tasks on the accepting thread, because a task only hands a connection on.
class InlineTaskQueue final : public httplib::TaskQueue {
 public:
  explicit InlineTaskQueue(std::function<void()> idle) : idle_(std::move(idle)) {}
  void enqueue(std::function<void()> task) override { task(); }
  void on_idle() override { idle_(); }
  void shutdown() override {}

 private:
  const std::function<void()> idle_;
};

}  // namespace

LibraryServer::LibraryServer(const ServerOptions& options, std::function<void(int socket)> accept)
    : host_(options.host), port_(options.port), accept_(std::move(accept)) {
  new_task_queue = [this] { return new InlineTaskQueue([this] { last_accept_ = Clock::now().time_since_epoch(); }); };
  set_idle_interval(accept_period);
  set_keep_alive_timeout(static_cast<time_t>(options.idle_seconds));  // sent in the header Keep-Alive
  set_keep_alive_max_count(static_cast<std::size_t>(options.requests_per_connection));
  // The library's default also sets SO_REUSEPORT, which would let a second server share the port unnoticed.
  set_socket_options([](socket_t socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  // This handler answers every request. The library has no routes of its own.
  set_pre_routing_handler([](const httplib::Request&, httplib::Response& response) {
    (*current_fill)(response);
    return HandlerResponse::Handled;
  });
  // The response of a problem could not be made either, for example for lack of memory. The library would answer every
  // exception with 500, and send its text.
  set_exception_handler([](const httplib::Request&, httplib::Response& response, const std::exception_ptr& exception) {
    response.status = problem::status_of(problem::problem_of(exception));
  });
}

int LibraryServer::take_port() {
  int port = port_;
  if (port == 0) {
    port = bind_to_any_port(host_);
  } else if (!bind_to_port(host_, port)) {
    port = -1;
  }
  if (port <= 0) {
    throw std::runtime_error("cannot listen on " + host_ + ":" + std::to_string(port_) +
                             ": the address is not of this machine, or the port is taken");
  }
  // With the library's backlog of 5 some clients of a burst would wait for a second.
  ::listen(svr_sock_, listen_backlog);
  return port;
}

void LibraryServer::accept_connections() {
  last_accept_ = Clock::now().time_since_epoch();
  listen_after_bind();
}

void LibraryServer::end() {
  ending_ = true;
  if (is_running() && !ended_.exchange(true)) stop();
}

bool LibraryServer::answer(ConnectionStream& stream, bool is_last, bool& closed_by_client, const Fill& fill) {
  struct Reset {
    ~Reset() { current_fill = nullptr; }
  } const reset;
  current_fill = &fill;
  return process_request(stream, is_last, closed_by_client, [](httplib::Request&) {});
}

bool LibraryServer::process_and_close_socket(socket_t socket) {
  last_accept_ = Clock::now().time_since_epoch();
  accept_(socket);
  return true;
}

}  // namespace supple::http
