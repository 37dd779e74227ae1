#include "answerer.h"

#include <fcntl.h>
#include <sys/socket.h>

#include <atomic>
#include <chrono>
#include <string>
#include <utility>

#include "durations.h"
#include "library_response.h"
#include "supple/log/context.h"

namespace supple::http {
namespace {

/// The head for the library, without the headers that this server handles itself. Without Range and Accept-Encoding
/// answers are whole and not compressed, which would cost more than it saves near the server.
std::string head_for_library(const RequestHead& head) {
  std::string text = head.method + " " + head.target + " HTTP/1." + std::to_string(head.minor_version) + "\r\n";
  text += head.asks_to_close() ? "Connection: close\r\n" : "Connection: Keep-Alive\r\n";
  if (const auto accept = head.header("Accept"); !accept.empty()) text.append("Accept: ").append(accept).append("\r\n");
  return text + "\r\n";
}

/// The text of an answer after which the connection closes.
std::string closing_answer(const Response& response, std::string_view reason) {
  std::string text = "HTTP/1.1 " + std::to_string(response.status) + " ";
  text.append(reason).append("\r\nConnection: close\r\nContent-Type: ").append(response.content_type).append("\r\n");
  for (const auto& [name, value] : response.headers) text.append(name).append(": ").append(value).append("\r\n");
  return text + "Content-Length: " + std::to_string(response.body.size()) + "\r\n\r\n" + response.body;
}

}  // namespace

/// The request of a connection and its answer. It is also the stand-in of the request's handler: while the handler's
/// thread still uses the connection, the stand-in's answer is sent by a second object with a duplicate descriptor.
class Answerer::Exchange final : public StandIn {
 public:
  Exchange(const Answerer& answerer, Connection& connection, bool has_slot, bool is_last)
      : answerer_(answerer),
        parts_(answerer.parts_),
        connection_(connection),
        has_slot_(has_slot),
        is_last_(is_last),
        lingers_(connection.unread() || !connection.head() || connection.surplus) {}

  After run() {
    if (connection_.head()) {
      answer_through_library();
      if (answered_by_ == AnsweredBy::stand_in) return After::answered_by_stand_in;
    } else {
      send_refusal();
    }
    observe(seconds());
    if (!is_sent_) return After::close;
    if (!unsent_.empty()) {
      connection_.send_later(std::move(unsent_), duration_of(answerer_.options_.write_seconds), lingers_ || is_last_);
      return After::send;
    }
    if (lingers_) return After::linger;
    return is_last_ ? After::close : After::next;
  }

  void answer(const problem::Problem& problem, bool releases_slot) override {
    if (!claim(AnsweredBy::stand_in)) return;
    const auto& request = connection_.request;
    auto response = answerer_.responses_.of_problem(problem, request);
    status_ = response.status;
    const double taken = seconds();
    if (releases_slot && !is_in_background_) {
      parts_.slots.release(request.client, taken);
      parts_.threads.raise_limit();
      slot_is_released_ = true;
    }
    if (request.method == "HEAD") response.body.clear();
    answerer_.send_last(connection_, closing_answer(response, "Late"));
    observe(taken);
  }

  void wait_in_background() override {
    if (auto refused = parts_.slots.move_to_background(connection_.request.client)) std::rethrow_exception(refused);
    is_in_background_ = true;
    parts_.threads.raise_limit();
  }

 private:
  using Clock = std::chrono::steady_clock;
  enum class AnsweredBy { nobody, handler, stand_in };

  /// Runs the handler and sends its answer, unless the stand-in has answered.
  void answer_through_library() {
    const log::Context context("request", connection_.request.id.empty() ? "-" : connection_.request.id);
    const auto head = head_for_library(*connection_.head());
    ConnectionStream stream(connection_.socket(), answerer_.options_.write_seconds, head);
    if (has_slot_) {
      connection_.request.stand_in = this;
    } else {
      stream.never_wait();
    }
    bool closed_by_client = false;
    const bool is_complete = parts_.library.answer(stream, is_last_, closed_by_client,
                                                   [&](httplib::Response& target) { make_response(target, stream); });
    connection_.request.stand_in = nullptr;
    if (is_in_background_) {
      parts_.slots.release_in_background(connection_.request.client);
      parts_.threads.lower_limit();
    } else if (slot_is_released_) {
      parts_.threads.lower_limit();
    } else if (has_slot_) {
      parts_.slots.release(connection_.request.client, seconds());
    }
    if (answered_by_ == AnsweredBy::stand_in) return;
    is_sent_ = stream.flush();
    unsent_ = stream.take_unsent();
    lingers_ = lingers_ || !is_complete;
    is_last_ = is_last_ || closed_by_client;
  }

  void make_response(httplib::Response& target, ConnectionStream& stream) {
    auto response = answerer_.responses_.answer(connection_);
    if (!claim(AnsweredBy::handler)) {
      stream.drop();
      target.status = response.status;
      return;
    }
    if (lingers_) response.set_header("Connection", "close");
    status_ = response.status;
    key_ = response.key;
    for (const auto& [name, value] : response.headers)
      if (name == "Location") location_ = value;
    fill_response(
        target, std::move(response), stream, Peer(connection_.socket()),
        [this](const std::exception_ptr& exception) { answerer_.responses_.report(exception, connection_.request); });
  }

  /// Refuses a request whose head could not be read, without the library.
  void send_refusal() {
    const auto response = answerer_.responses_.of_exception(connection_.refusal(), connection_.request);
    status_ = response.status;
    const auto text = closing_answer(response, "Refused");
    std::string_view left = text;
    is_sent_ = send_now(connection_.socket(), left);
    unsent_ = left;
  }

  /// Returns false if the request has been answered already.
  bool claim(AnsweredBy who) {
    auto nobody = AnsweredBy::nobody;
    return answered_by_.compare_exchange_strong(nobody, who);
  }

  /// Time since the request has arrived.
  double seconds() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

  void observe(double taken) const {
    if (!answerer_.observe_) return;
    const auto& request = connection_.request;
    answerer_.observe_({request.id, connection_.client(), key_.empty() ? request.key : key_,
                        connection_.route ? connection_.route->pattern : std::string(), request.method, request.path,
                        location_, status_, taken, request.body.size()});
  }

  const Answerer& answerer_;
  const Parts& parts_;
  Connection& connection_;
  const bool has_slot_;
  const Clock::time_point begin_ = Clock::now();
  bool is_last_;                   ///< whether the connection closes after the answer
  bool lingers_;                   ///< whether it closes after its input has been discarded
  bool is_sent_ = false;           ///< whether the client has not gone
  std::string unsent_;             ///< what the client did not take at once
  bool is_in_background_ = false;  ///< whether its handler waits for work in the background; set by that
  std::atomic<AnsweredBy> answered_by_{AnsweredBy::nobody};
  // Whoever has claimed the answer, the handler's thread or the stand-in's, sets the following members. The handler
  // does not return before the stand-in has.
  bool slot_is_released_ = false;
  int status_ = 0;
  std::string location_;
  std::string key_;  ///< id of the key that the handler has found (Response::key)
};

Answerer::After Answerer::answer(Connection& connection, bool has_slot) const {
  const bool is_last = ++connection.answered >= options_.requests_per_connection || parts_.library.ending();
  return Exchange(*this, connection, has_slot, is_last).run();
}

void Answerer::send_last(Connection& connection, std::string_view text) const {
  const int socket = ::fcntl(connection.socket(), F_DUPFD_CLOEXEC, 0);
  if (socket < 0) {
    // Too many files are open. What the client does not take at once is lost.
    send_now(connection.socket(), text);
    ::shutdown(connection.socket(), SHUT_WR);
    return;
  }
  connection.skip_shutdown();
  auto last = parts_.connections.open(socket, connection.client()).connection;
  if (!send_now(socket, text)) return;
  if (text.empty()) {
    last->linger();
  } else {
    last->send_later(std::string(text), duration_of(options_.write_seconds), true);
  }
  parts_.lobby.take(std::move(last));
}

}  // namespace supple::http
