#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>

#include "supple/http/server.h"

namespace supple::http {

using namespace std::chrono_literals;

/// A client that sends and receives raw bytes over one connection.
class Client {
 public:
  /// The client's own address is 127.0.0.`from`. With `little` the socket buffers are small, here and at the server, so
  /// that few bytes are in transit.
  explicit Client(int port, std::uint32_t from = 1, bool little = false) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const int buffer_bytes = 1024;
    if (little) {
      ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &buffer_bytes, sizeof buffer_bytes);
      ::setsockopt(socket_, IPPROTO_TCP, TCP_MAXSEG, &buffer_bytes, sizeof buffer_bytes);
    }
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK - 1 + from);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&own), sizeof own), 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval limit{10, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  }
  ~Client() { hang_up(); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void send(const std::string& text) {
    EXPECT_EQ(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
  }
  /// Sends the text again and again, until the server has taken nothing for 0.2 s, but at most `most` times. Returns
  /// the number of times.
  int send_until_nothing_is_taken(const std::string& text, int most) {
    const timeval patience{0, 200'000};
    ::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    int times = 0;
    while (times < most && ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size()))
      ++times;
    return times;
  }
  void hang_up() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
  }
  /// Whether bytes have arrived that have not been read.
  bool has_answer() const {
    char byte = 0;
    return ::recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT) > 0;
  }
  /// Reads until `text` has arrived `times` times, the server closes, or nothing arrives for 10 s. Returns the number
  /// of times.
  int read_times(const std::string& text, int times) {
    std::string unread;
    std::vector<char> bytes(1 << 16);
    int found = 0;
    while (found < times) {
      const auto count = ::recv(socket_, bytes.data(), bytes.size(), 0);
      if (count <= 0) break;
      unread.append(bytes.data(), static_cast<std::size_t>(count));
      std::size_t read = 0;
      for (std::size_t at = 0; (at = unread.find(text, read)) != std::string::npos; ++found) read = at + text.size();
      unread.erase(0, std::max(read, unread.size() - std::min(unread.size(), text.size() - 1)));
    }
    return found;
  }
  /// Reads until the server closes, many bytes at a time.
  std::string read_pieces() {
    std::string text;
    std::vector<char> bytes(1 << 16);
    for (ssize_t count = 0; (count = ::recv(socket_, bytes.data(), bytes.size(), 0)) > 0;)
      text.append(bytes.data(), static_cast<std::size_t>(count));
    return text;
  }
  /// Reads until the text ends with `end`, or the server closes.
  std::string read_until(const std::string& end) {
    std::string text;
    char byte = 0;
    while (!text.ends_with(end) && ::recv(socket_, &byte, 1, 0) == 1) text += byte;
    return text;
  }
  std::string read_all() { return read_until(std::string(1, '\0') + "never"); }

 private:
  int socket_;
};

inline std::string get(const std::string& path) { return "GET " + path + " HTTP/1.1\r\nHost: x\r\n\r\n"; }
inline std::string post(const std::string& path, const std::string& body) {
  return "POST " + path + " HTTP/1.1\r\nHost: x\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
}

/// The head of a request with a body of `length` bytes, and the first `sent` bytes of the body.
inline std::string part_of_post(const std::string& path, std::size_t length, std::size_t sent) {
  return "POST " + path + " HTTP/1.1\r\nHost: x\r\nContent-Length: " + std::to_string(length) + "\r\n\r\n" +
         std::string(sent, 'x');
}

class HttpServerTest : public ::testing::Test {
 protected:
  HttpServerTest() { options_.port = 0; }
  ~HttpServerTest() override { end(); }

  static constexpr std::size_t length_of_pieces = 1'500'001;
  static constexpr std::size_t large_problem = 32 << 20;  // bytes; more than the socket buffers hold
  static char letter(std::size_t place) { return static_cast<char>('a' + place % 23); }

  void start() {
    Router router;
    router.add({"GET",
                "/hello/{name}",
                [](const Request& r) { return text("hello " + r.path_parameters.at("name") + "!"); },
                {}});
    router.add({"POST", "/echo", [](const Request& r) { return text(r.body + "!"); }, {1000, "--max-body"}});
    router.add(
        {"POST", "/size", [](const Request& r) { return text(std::to_string(r.body.size()) + "!"); }, {1'000'000, ""}});
    router.add({"GET", "/broken", [](const Request&) -> Response { throw std::runtime_error("secret"); }, {}});
    router.add({"GET", "/unmakeable", [](const Request&) -> Response { throw Error("mesh.not_found", "large"); }, {}});
    router.add({"GET",
                "/slow",
                [this](const Request& r) {
                  ++slow_;
                  while (!r.peer.hung_up() && !release_) std::this_thread::sleep_for(1ms);
                  if (r.peer.hung_up()) ++hung_up_;
                  return text("done!");
                },
                {}});
    for (const char* const method : {"GET", "POST"}) {
      router.add({method,
                  "/late/{how}",
                  [this](const Request& r) {
                    // The stand-in is called on another thread, as a watchdog would do.
                    std::thread([&] {
                      const auto& how = r.path_parameters.at("how");
                      const std::string detail(how == "large" ? large_problem : 5, 'x');
                      r.stand_in->answer({"job.deadline_exceeded", detail, {}, {}, {}}, how != "kept");
                    }).join();
                    while (!release_) std::this_thread::sleep_for(1ms);
                    ++returned_;
                    auto response = text(std::string(1 << 20, 'l') + "late!");
                    if (r.method == "POST") response.stream = [this](StreamWriter&) { ++streamed_; };
                    return response;
                  },
                  {1000, "--max-body"}});
    }
    router.add({"POST",
                "/made",
                [](const Request&) {
                  auto response = text("made!");
                  response.status = 201;
                  response.set_header("Location", "/things/1");
                  return response;
                },
                {10, "--max"},
                false,
                true});
    router.add({"GET",
                "/background",
                [this](const Request& r) {
                  r.stand_in->wait_in_background();
                  ++waiting_;
                  while (!release_) std::this_thread::sleep_for(1ms);
                  return text("waited!");
                },
                {}});
    router.add({"GET", "/probe", [](const Request&) { return text("alive!"); }, {}, true});
    router.add({"GET",
                "/stream",
                [](const Request&) {
                  Response response;
                  response.content_type = "text/event-stream";
                  response.stream = [](StreamWriter& out) {
                    for (int i = 0; i < 3; ++i) out.write("data: " + std::to_string(i) + "\n\n");
                  };
                  return response;
                },
                {}});
    router.add({"GET",
                "/broken-stream",
                [](const Request&) {
                  Response response;
                  response.content_type = "text/event-stream";
                  response.stream = [](StreamWriter& out) {
                    out.write("data: 0\n\n");
                    throw std::runtime_error("the store");
                  };
                  return response;
                },
                {}});
    for (const bool broken : {false, true}) {
      const auto read = [this, broken](std::uint64_t offset, char* to, std::size_t count) {
        if (broken && offset > length_of_pieces / 2) throw std::runtime_error("the disk");
        ++pieces_;
        largest_piece_ = std::max(largest_piece_.load(), count);
        for (std::size_t i = 0; i < count; ++i) {
          const auto left = length_of_pieces - offset - i;
          to[i] = left > 4 ? letter(offset + i) : "end!"[4 - left];
        }
      };
      router.add({"GET",
                  broken ? "/broken-pieces" : "/pieces",
                  [read](const Request&) {
                    Response response;
                    response.content_type = "text/plain";
                    response.piecewise_body = PiecewiseBody{length_of_pieces, read};
                    return response;
                  },
                  {}});
    }
    server_ = std::make_unique<Server>(
        options_, std::move(router),
        [](const problem::Problem& problem) {
          if (problem.detail == "large") throw std::bad_alloc();
          auto response = text("problem " + problem.code + (problem.detail.size() > 1000 ? problem.detail : "") + "!");
          response.status = problem::status_of(problem);
          response.set_header("Allow", problem.allowed_methods);
          return response;
        },
        [this](const AnsweredRequest& answered) {
          const std::lock_guard lock(report_mutex_);
          if (answered.key == "mine") last_ = answered;
          ++observed_;
        },
        [this](const std::string& text) {
          const std::lock_guard lock(report_mutex_);
          reported_ = text;
        },
        [this](Request& request, const Route* route) {
          if (request.host == "held") {
            ++in_guard_;
            while (!release_guard_) std::this_thread::sleep_for(1ms);
          }
          if (request.host == "evil") throw Error("http.misdirected_request", "Not this server.");
          request.key = request.header("X-Key");
          if (request.key == "none" && route && !route->needs_no_key) throw Error("access.key_required", "No key.");
          if (const auto client = request.header("X-Client"); !client.empty()) request.client = client;
        });
    port_ = server_->bind();
    thread_ = std::thread([this] { server_->run(); });
  }

  void end() {
    release_ = true;
    release_guard_ = true;
    if (!thread_.joinable()) return;
    std::atomic<bool> ended{false};
    std::thread stopper([&] {
      while (!ended) {
        server_->stop();
        std::this_thread::sleep_for(1ms);
      }
    });
    thread_.join();
    ended = true;
    stopper.join();
  }

  static Response text(std::string body) {
    Response response;
    response.content_type = "text/plain";
    response.body = std::move(body);
    return response;
  }

  std::string answer(const std::string& request) {
    Client client(port_);
    client.send(request);
    return client.read_until("!");
  }

  ServerOptions options_;
  std::unique_ptr<Server> server_;
  int port_ = 0;
  std::thread thread_;
  std::atomic<int> pieces_ = 0;
  std::atomic<std::size_t> largest_piece_ = 0;  // bytes of the largest piece that was read at once
  std::atomic<int> slow_{0};
  std::atomic<int> hung_up_{0};
  std::atomic<int> observed_{0};
  std::atomic<int> in_guard_{0};
  std::atomic<bool> release_guard_{false};
  std::atomic<int> waiting_{0};
  std::atomic<int> returned_{0};
  std::atomic<int> streamed_{0};
  std::atomic<bool> release_{false};
  std::mutex report_mutex_;  ///< needed because the server reports on threads of its own
  std::string reported_;
  AnsweredRequest last_;  ///< last answer to a request with the key "mine"
};

}  // namespace supple::http
