#include "supple/http/server.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <new>
#include <thread>

namespace supple::http {
namespace {

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

std::string get(const std::string& path) { return "GET " + path + " HTTP/1.1\r\nHost: x\r\n\r\n"; }
std::string post(const std::string& path, const std::string& body) {
  return "POST " + path + " HTTP/1.1\r\nHost: x\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
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
  std::atomic<int> returned_{0};
  std::atomic<int> streamed_{0};
  std::atomic<bool> release_{false};
  std::mutex report_mutex_;  ///< needed because the server reports on threads of its own
  std::string reported_;
  AnsweredRequest last_;  ///< last answer to a request with the key "mine"
};

TEST_F(HttpServerTest, AnswersManyRequestsOnOneConnection) {
  start();
  Client client(port_);
  for (int i = 0; i < 50; ++i) {
    client.send(get("/hello/" + std::to_string(i)));
    EXPECT_TRUE(client.read_until("!").ends_with("hello " + std::to_string(i) + "!"));
  }
}

TEST_F(HttpServerTest, AnswersPipelinedRequestsInTheirOrder) {
  start();
  Client client(port_);
  client.send(get("/hello/a") + post("/echo", "b") + get("/hello/c"));
  EXPECT_TRUE(client.read_until("!").ends_with("hello a!"));
  EXPECT_TRUE(client.read_until("!").ends_with("b!"));
  EXPECT_TRUE(client.read_until("!").ends_with("hello c!"));
}

TEST_F(HttpServerTest, TurnsEveryErrorIntoAProblem) {
  start();
  EXPECT_NE(answer(get("/nothing")).find("404 Not Found"), std::string::npos);
  EXPECT_TRUE(answer(get("/nothing")).ends_with("problem http.not_found!"));
  EXPECT_NE(answer(get("/echo")).find("Allow: POST"), std::string::npos);
  EXPECT_TRUE(answer("NONSENSE\r\n\r\n").ends_with("problem http.bad_request!"));
  EXPECT_TRUE(answer("BREW / HTTP/1.1\r\nHost: x\r\n\r\n").ends_with("problem http.bad_request!"));
  EXPECT_TRUE(answer(get("/" + std::string(3000, 'x'))).ends_with("problem http.uri_too_long!"));
  EXPECT_TRUE(answer(get("/" + std::string(9000, 'x'))).ends_with("problem http.uri_too_long!"));
}

TEST_F(HttpServerTest, KeepsTheTextOfAnUnexpectedExceptionFromTheClient) {
  start();
  EXPECT_TRUE(answer(get("/broken")).ends_with("problem server.internal!"));
  const std::lock_guard lock(report_mutex_);
  EXPECT_EQ(reported_, "GET /broken: secret");
}

TEST_F(HttpServerTest, SaysByItsStatusThatThereIsNoMemoryForAProblem) {
  start();
  Client client(port_);
  client.send(get("/unmakeable"));
  const auto text = client.read_until("\r\n\r\n");
  EXPECT_TRUE(text.starts_with("HTTP/1.1 503 ")) << text;
  EXPECT_EQ(text.find("bad_alloc"), std::string::npos) << text;
}

TEST_F(HttpServerTest, RefusesABodyBeyondTheRoutesLimitWhicheverWayItIsSent) {
  start();
  EXPECT_TRUE(answer(post("/echo", std::string(1000, 'x'))).ends_with("xx!"));
  EXPECT_TRUE(answer(post("/echo", std::string(1001, 'x'))).ends_with("problem request.body_too_large!"));
  const std::string chunk = "400\r\n" + std::string(1024, 'x') + "\r\n";
  EXPECT_TRUE(answer("POST /echo HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n" + chunk + "0\r\n\r\n")
                  .ends_with("problem request.body_too_large!"));
  EXPECT_TRUE(answer("POST /echo HTTP/1.1\r\nHost: x\r\nContent-Length: 999999999999\r\n\r\n")
                  .ends_with("problem request.body_too_large!"));
}

TEST_F(HttpServerTest, TakesAFormOfAnySizeAsBytes) {
  start();
  const std::string body(900, 'x');
  EXPECT_TRUE(answer("POST /echo HTTP/1.1\r\nHost: x\r\nContent-Type: "
                     "application/x-www-form-urlencoded\r\nContent-Length: 900\r\n\r\n" +
                     body)
                  .ends_with("xx!"));
}

TEST_F(HttpServerTest, DropsARequestThatDoesNotArriveInTime) {
  options_.request_seconds = 0.1;
  start();
  EXPECT_TRUE(answer("POST /echo HTTP/1.1\r\nHost: x\r\nContent-Length: 10\r\n\r\nabc")
                  .ends_with("problem http.request_timeout!"));
  Client slow(port_);
  slow.send("GET /hello/a HT");
  EXPECT_EQ(slow.read_all().find("200 OK"), std::string::npos);
}

TEST_F(HttpServerTest, DropsAHeadWithoutEnd) {
  start();
  Client client(port_);
  client.send("GET / HTTP/1.1\r\nX: " + std::string(70'000, 'x'));
  EXPECT_EQ(client.read_all().find("200 OK"), std::string::npos);
}

TEST_F(HttpServerTest, TellsAHandlerThatItsClientHungUp) {
  start();
  Client client(port_);
  client.send(get("/slow"));
  while (slow_ == 0) std::this_thread::sleep_for(1ms);
  client.hang_up();
  for (int i = 0; i < 5000 && hung_up_ == 0; ++i) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(hung_up_, 1);
}

TEST_F(HttpServerTest, StreamsAnAnswer) {
  start();
  Client client(port_);
  client.send(get("/stream"));
  const auto text = client.read_until("0\r\n\r\n");
  for (const char* piece : {"data: 0", "data: 1", "data: 2", "chunked"})
    EXPECT_NE(text.find(piece), std::string::npos) << text;
}

TEST_F(HttpServerTest, SendsPiecesWithTheirLengthAndWithoutHoldingThem) {
  start();
  Client client(port_);
  client.send(get("/pieces"));
  const auto text = client.read_until("end!");
  EXPECT_NE(text.find("Content-Length: " + std::to_string(length_of_pieces)), std::string::npos);
  EXPECT_EQ(text.find("chunked"), std::string::npos);
  const auto body = text.substr(text.find("\r\n\r\n") + 4);
  ASSERT_EQ(body.size(), length_of_pieces);
  for (std::size_t i = 0; i + 4 < body.size(); ++i) ASSERT_EQ(body[i], letter(i)) << i;
  client.send(get("/hello/a"));
  EXPECT_TRUE(client.read_until("!").ends_with("hello a!")) << "the connection goes on";
  EXPECT_LE(largest_piece_, 1U << 20);
  EXPECT_GE(pieces_, 5);
}

TEST_F(HttpServerTest, CutsAnAnswerOffWhosePiecesCannotBeRead) {
  start();
  Client client(port_);
  client.send(get("/broken-pieces"));
  const auto text = client.read_all();
  EXPECT_TRUE(text.starts_with("HTTP/1.1 200"));
  EXPECT_LT(text.size(), length_of_pieces);
  const std::lock_guard lock(report_mutex_);
  EXPECT_EQ(reported_, "GET /broken-pieces: the disk");
}

TEST_F(HttpServerTest, CutsAStreamOffThatThrowsAndGoesOnServing) {
  start();
  Client client(port_);
  client.send(get("/broken-stream"));
  const auto text = client.read_all();
  EXPECT_NE(text.find("data: 0"), std::string::npos) << text;
  EXPECT_FALSE(text.ends_with("0\r\n\r\n")) << "the client sees that the end is missing";
  EXPECT_TRUE(answer(get("/hello/a")).ends_with("hello a!"));
  const std::lock_guard lock(report_mutex_);
  EXPECT_EQ(reported_, "GET /broken-stream: the store");
}

TEST_F(HttpServerTest, ServesSixtyFourConnectionsAtTheSameTime) {
  options_.max_connections = 64;
  start();
  std::vector<std::unique_ptr<Client>> clients;
  for (int i = 0; i < 64; ++i) {
    clients.push_back(std::make_unique<Client>(port_));
    clients.back()->send(get("/slow"));
  }
  for (int i = 0; i < 5000 && slow_ < 64; ++i) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(slow_, 64);
  release_ = true;
  for (auto& client : clients) EXPECT_TRUE(client->read_until("!").ends_with("done!"));
}

TEST_F(HttpServerTest, ClosesTheConnectionThatHasWaitedLongestWhereRoomIsNeeded) {
  options_.max_connections = 2;
  options_.max_client_fraction = 1;
  start();
  Client first(port_);
  Client second(port_);
  for (Client* client : {&first, &second}) {
    client->send(get("/hello/a"));
    client->read_until("!");
    std::this_thread::sleep_for(250ms);  // until the thread has handed the connection back to the lobby
  }
  EXPECT_TRUE(answer(get("/hello/b")).ends_with("hello b!"));
  EXPECT_EQ(first.read_all(), "");
  second.send(get("/hello/c"));
  EXPECT_TRUE(second.read_until("!").ends_with("hello c!"));
  EXPECT_EQ(server_->load().evicted, 1U);
}

TEST_F(HttpServerTest, LetsAClientWithMoreThanItsShareMakeRoomItself) {
  options_.max_connections = 4;
  options_.max_client_fraction = 0.5;
  start();
  Client other(port_, 2);
  for (int i = 0; i < 5000 && server_->connections() < 1; ++i) std::this_thread::sleep_for(1ms);
  std::this_thread::sleep_for(1100ms);  // it has waited longest, and is idle for long enough to be evicted
  std::vector<std::unique_ptr<Client>> clients;
  for (int i = 0; i < 3; ++i) clients.push_back(std::make_unique<Client>(port_));  // the limit of one client is two
  EXPECT_EQ(clients[0]->read_all(), "");
  for (Client* client : {&other, clients[2].get()}) {
    client->send(get("/hello/a"));
    EXPECT_TRUE(client->read_until("!").ends_with("hello a!"));
  }
  EXPECT_EQ(server_->load().evicted, 1U);
}

TEST_F(HttpServerTest, RefusesOneConnectionTooManyWithAProblemWhereAllAreBusy) {
  options_.max_connections = 2;
  options_.max_client_fraction = 1;
  start();
  Client first(port_);
  Client second(port_);
  for (Client* client : {&first, &second}) client->send(get("/slow"));
  for (int i = 0; i < 5000 && slow_ < 2; ++i) std::this_thread::sleep_for(1ms);
  EXPECT_TRUE(answer(get("/hello/a")).ends_with("problem server.too_many_connections!"));
  EXPECT_TRUE(answer(get("/probe")).ends_with("alive!"));
  release_ = true;
  EXPECT_TRUE(first.read_until("!").ends_with("done!"));
  first.hang_up();
  for (int i = 0; i < 5000 && server_->connections() > 1; ++i) std::this_thread::sleep_for(1ms);
  EXPECT_TRUE(answer(get("/hello/a")).ends_with("hello a!"));
}

TEST_F(HttpServerTest, AnswersProbesWhileManyRequestsAreSentHalf) {
  options_.max_connections = 64;
  options_.max_requests = 2;
  start();
  std::vector<std::unique_ptr<Client>> half;
  for (int i = 0; i < 80; ++i) {
    half.push_back(std::make_unique<Client>(port_));
    half.back()->send(i % 2 == 0 ? "GET /hello/a HT" : "POST /echo HTTP/1.1\r\nHost: x\r\nContent-Length: 9\r\n\r\nab");
  }
  EXPECT_TRUE(answer(get("/probe")).ends_with("alive!"));
  EXPECT_TRUE(answer(get("/hello/a")).ends_with("hello a!"));
}

TEST_F(HttpServerTest, WritesToNoFileThatIsOpenedAfterItHasStopped) {
  start();
  EXPECT_TRUE(answer(get("/probe")).ends_with("alive!"));
  end();
  std::vector<int> files;
  for (int i = 0; i < 64; ++i) files.push_back(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  server_.reset();
  for (const int file : files) {
    eventfd_t written = 0;
    EXPECT_NE(::eventfd_read(file, &written), 0) << written;
    ::close(file);
  }
}

TEST_F(HttpServerTest, RefusesRequestsBeyondThoseItAnswersAndBeyondAClientsShare) {
  options_.max_requests = 4;
  options_.max_client_fraction = 0.5;
  start();
  Client first(port_);
  Client second(port_);
  for (Client* client : {&first, &second}) client->send(get("/slow"));
  for (int i = 0; i < 5000 && slow_ < 2; ++i) std::this_thread::sleep_for(1ms);
  EXPECT_TRUE(answer(get("/hello/a")).ends_with("problem server.client_share!"));
  EXPECT_TRUE(answer("GET /hello/a HTTP/1.1\r\nHost: x\r\nX-Client: other\r\n\r\n").ends_with("hello a!"));
  Client third(port_);
  Client fourth(port_);
  for (Client* client : {&third, &fourth}) client->send("GET /slow HTTP/1.1\r\nHost: x\r\nX-Client: other\r\n\r\n");
  for (int i = 0; i < 5000 && slow_ < 4; ++i) std::this_thread::sleep_for(1ms);
  EXPECT_TRUE(answer("GET /hello/a HTTP/1.1\r\nHost: x\r\nX-Client: third\r\n\r\n").ends_with("problem server.busy!"));
  EXPECT_TRUE(answer(get("/probe")).ends_with("alive!"));
}

TEST_F(HttpServerTest, AsksItsGuardBeforeItReadsABody) {
  start();
  EXPECT_TRUE(answer("POST /echo HTTP/1.1\r\nHost: evil\r\nContent-Length: 900\r\n\r\n")
                  .ends_with("problem http.misdirected_request!"));
}

TEST_F(HttpServerTest, TellsItsGuardOfTheRouteAndItsObserverOfTheKey) {
  start();
  EXPECT_TRUE(
      answer("GET /probe HTTP/1.1\r\nHost: x\r\nX-Key: none\r\n\r\n").ends_with("problem access.key_required!"));
  EXPECT_TRUE(answer("GET /nowhere HTTP/1.1\r\nHost: x\r\nX-Key: none\r\n\r\n").ends_with("problem http.not_found!"));
  EXPECT_TRUE(answer("POST /made HTTP/1.1\r\nHost: x\r\nX-Key: mine\r\nContent-Length: 1\r\n\r\nx").ends_with("made!"));
  for (int i = 0; i < 5000 && observed_ < 3; ++i) std::this_thread::sleep_for(1ms);
  const std::lock_guard lock(report_mutex_);
  EXPECT_EQ(last_.key, "mine");
  EXPECT_EQ(last_.address, "127.0.0.1");
  EXPECT_EQ(last_.location, "/things/1");
  EXPECT_EQ(last_.status, 201);
}

/// The head of a request with a body of `length` bytes, and the first `sent` bytes of the body.
std::string part_of_post(const std::string& path, std::size_t length, std::size_t sent) {
  return "POST " + path + " HTTP/1.1\r\nHost: x\r\nContent-Length: " + std::to_string(length) + "\r\n\r\n" +
         std::string(sent, 'x');
}

TEST_F(HttpServerTest, ReservesOfABodyWhatHasArrived) {
  budget::MemoryBudget memory(1'000'000, 600'000);
  options_.memory = &memory;
  start();
  EXPECT_TRUE(answer(part_of_post("/size", 700'000, 0)).ends_with("problem request.too_much_memory!"));
  std::vector<std::unique_ptr<Client>> announced;
  for (int i = 0; i < 8; ++i) {
    announced.push_back(std::make_unique<Client>(port_));
    announced.back()->send(part_of_post("/size", 600'000, 10));
  }
  EXPECT_TRUE(answer(part_of_post("/size", 500'000, 500'000)).ends_with("500000!"));
  const auto comes_back = [&] {
    for (int i = 0; i < 5000 && memory.used() > 0; ++i) std::this_thread::sleep_for(1ms);
    return memory.used() == 0;
  };
  EXPECT_TRUE(comes_back()) << memory.used();
  announced.front()->send(std::string(300'000, 'x'));
  for (int i = 0; i < 5000 && memory.used() < 200'000; ++i) std::this_thread::sleep_for(1ms);
  EXPECT_GE(memory.used(), 200'000);
  EXPECT_LE(memory.used(), 600'000);
  announced.front()->hang_up();
  EXPECT_TRUE(comes_back()) << memory.used();
  end();  // before the budget is destroyed
}

// Here the limit for bodies that have not arrived completely is 750,000 bytes, and half of that for each client. Once a
// body of 200,000 bytes has more than 100,000, its buffer has 200,000 bytes, of which all but 65,536 are counted.
TEST_F(HttpServerTest, BoundsBodiesThatDoNotArriveForEachClientAndForAll) {
  budget::MemoryBudget memory(1'000'000, 600'000);
  options_.memory = &memory;
  options_.max_client_fraction = 0.5;
  start();
  std::vector<std::unique_ptr<Client>> waiting;
  const auto begin = [&](std::uint32_t client) {
    const std::int64_t before = memory.used();
    waiting.push_back(std::make_unique<Client>(port_, client));
    waiting.back()->send(part_of_post("/size", 200'000, 100'001));
    const auto has_arrived = [&] { return memory.used() - before >= 134'464; };
    for (int i = 0; i < 10'000 && !has_arrived() && !waiting.back()->has_answer(); ++i)
      std::this_thread::sleep_for(1ms);
    return has_arrived() ? "arrived" : waiting.back()->read_until("!");
  };
  for (const std::uint32_t client : {1U, 1U, 2U, 2U, 3U}) EXPECT_EQ(begin(client), "arrived");
  EXPECT_TRUE(begin(1).ends_with("problem server.client_share!"));
  EXPECT_TRUE(begin(3).ends_with("problem server.out_of_memory!"));
  EXPECT_TRUE(answer(part_of_post("/size", 60'000, 60'000)).ends_with("60000!"));
  waiting.front()->send(std::string(99'999, 'x'));
  EXPECT_TRUE(waiting.front()->read_until("!").ends_with("200000!"));
  for (int i = 0; i < 5000 && memory.used() > 4 * 134'464; ++i) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(begin(1), "arrived");
  waiting.clear();
  end();
}

TEST_F(HttpServerTest, AnswersOthersWhileOneSendsEmptyLines) {
  start();
  std::string lines;
  for (int i = 0; i < 700; ++i) lines += "\r\n";
  Client client(port_);
  client.send_until_nothing_is_taken(lines, 1000);
  EXPECT_TRUE(client.read_until("!").ends_with("problem http.bad_request!"));
  EXPECT_TRUE(answer("\r\n\r\n" + get("/probe")).ends_with("alive!"));
}

TEST_F(HttpServerTest, AnswersOthersWhileSomeReadNoAnswer) {
  start();
  std::vector<std::unique_ptr<Client>> deaf;
  std::vector<int> sent;
  for (int i = 0; i < 5; ++i) {
    deaf.push_back(std::make_unique<Client>(port_, 1, true));
    sent.push_back(deaf.back()->send_until_nothing_is_taken(get(i % 2 == 0 ? "/probe" : "/nothing"), 1'000'000));
    EXPECT_LT(sent.back(), 1'000'000);
  }
  EXPECT_TRUE(answer(get("/probe")).ends_with("alive!"));
  EXPECT_TRUE(answer(get("/nothing")).ends_with("problem http.not_found!"));
  // The rest of the answer arrives once the client reads, and then the next answers.
  const int some = std::min({sent[0], sent[1], 1500});
  EXPECT_GT(some, 500);
  EXPECT_GE(deaf[0]->read_times("alive!", some), some);
  EXPECT_GE(deaf[1]->read_times("problem http.not_found!", some), some);
}

TEST_F(HttpServerTest, ClosesWhereOneOfTheOptionsOfTheConnectionIsClose) {
  start();
  Client client(port_);
  client.send("GET /hello/a HTTP/1.1\r\nHost: x\r\nConnection: keep-alive, close\r\n\r\n");
  EXPECT_TRUE(client.read_all().ends_with("hello a!"));
}

TEST_F(HttpServerTest, SaysHowLongItHasNotLookedAtWhatArrives) {
  start();
  std::this_thread::sleep_for(200ms);
  EXPECT_LT(server_->load().reader_silence_seconds, 10);
  EXPECT_GE(server_->load().reader_silence_seconds, 0);
}

TEST_F(HttpServerTest, AnswersForAHandlerThatIsHeldAndDropsWhatItReturnsLater) {
  options_.max_requests = 1;
  start();
  const std::string head = "HEAD /late/replaced HTTP/1.1\r\nHost: x\r\n\r\n";
  int late = 0;
  for (const auto& request :
       {get("/late/replaced"), post("/late/replaced", "body"), head, get("/late/replaced") + get("/hello/never")}) {
    Client client(port_);
    client.send(request);
    const auto answer = client.read_all();
    EXPECT_EQ(answer.find("HTTP/1.1 504 "), 0U) << answer;
    EXPECT_NE(answer.find("Connection: close\r\n"), std::string::npos) << answer;
    EXPECT_NE(answer.find("Supple-Request-Id: "), std::string::npos) << answer;
    EXPECT_TRUE(answer.ends_with(request == head ? "\r\n\r\n" : "problem job.deadline_exceeded!")) << answer;
    EXPECT_EQ(returned_, 0) << "it is held";
    EXPECT_TRUE(this->answer(get("/hello/a")).ends_with("hello a!")) << "in the place and by a thread of " << late;
    while (observed_ < 2 * late + 2) std::this_thread::sleep_for(1ms);
    ++late;
  }
  end();
  EXPECT_EQ(returned_, late);
  EXPECT_EQ(streamed_, 0);
  EXPECT_EQ(observed_, 2 * late) << "what is dropped is no second answer";
  EXPECT_EQ(server_->load().answering, 0);
  EXPECT_EQ(server_->connections(), 0);
}

TEST_F(HttpServerTest, MixesNothingOfALateAnswerIntoTheOneThatIsBeingSent) {
  start();
  Client client(port_);
  client.send(get("/late/large"));
  while (!client.has_answer()) std::this_thread::sleep_for(1ms);
  release_ = true;
  while (returned_ == 0) std::this_thread::sleep_for(1ms);
  const auto answer = client.read_pieces();
  const std::string body = "problem job.deadline_exceeded" + std::string(large_problem, 'x') + "!";
  EXPECT_TRUE(answer.substr(answer.find("\r\n\r\n") + 4) == body) << answer.size() << " bytes";
}

TEST_F(HttpServerTest, KeepsThePlaceOfAHandlerThatIsHeldWhereItIsNotReplaced) {
  options_.max_requests = 1;
  start();
  Client client(port_);
  client.send(get("/late/kept"));
  EXPECT_TRUE(client.read_all().ends_with("problem job.deadline_exceeded!"));
  EXPECT_TRUE(answer(get("/hello/a")).ends_with("problem server.busy!"));
  release_ = true;
  while (server_->load().answering > 0) std::this_thread::sleep_for(1ms);
  EXPECT_TRUE(answer(get("/hello/a")).ends_with("hello a!"));
}

TEST_F(HttpServerTest, SaysWhichOfTheThreadsOnWhichAllDependIsHeldAndForHowLongItWas) {
  const std::string accepts = "the thread that accepts connections ";
  const std::string reads = "the thread that reads what arrives on connections ";
  std::mutex mutex;
  std::string told;
  options_.max_silent_seconds = 1;
  options_.max_connections = 1;
  options_.warn = [&](const std::string& line) {
    const std::lock_guard lock(mutex);
    told += line + "\n";
  };
  const auto wait_until_told = [&](const std::string& line) {
    for (int i = 0; i < 100'000; ++i) {
      {
        const std::lock_guard lock(mutex);
        if (told.find(line) != std::string::npos) return;
      }
      std::this_thread::sleep_for(1ms);
    }
    ADD_FAILURE() << line << " is not told: " << told;
  };
  start();
  for (int i = 0; i < 200 && (i < 15 || server_->load().accept_silence_seconds > 0.9); ++i)
    std::this_thread::sleep_for(100ms);
  EXPECT_LE(server_->load().accept_silence_seconds, 1) << "also where nobody comes";
  Client held(port_);
  held.send(
      "GET /hello/a HTTP/1.1\r\nHost: held\r\n\r\n");  // the guard blocks the reading thread when this head arrives
  while (in_guard_ == 0) std::this_thread::sleep_for(1ms);
  wait_until_told(reads + "has been silent for ");
  Client other(port_);  // the accepting thread now waits for an eviction
  wait_until_told(accepts + "has been silent for ");
  EXPECT_GE(server_->load().reader_silence_seconds, 1);
  EXPECT_GE(server_->load().accept_silence_seconds, 1);
  release_guard_ = true;
  wait_until_told(reads + "was silent for ");
  wait_until_told(accepts + "was silent for ");
  EXPECT_TRUE(held.read_until("!").ends_with("hello a!"));
  end();
}

TEST_F(HttpServerTest, ClosesIdleConnectionsAtOnceWhenItStops) {
  start();
  Client client(port_);
  client.send(get("/hello/a"));
  client.read_until("!");
  const auto begin = std::chrono::steady_clock::now();
  end();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::duration<double>(options_.idle_seconds) / 2);
  EXPECT_EQ(client.read_all(), "");
}

TEST_F(HttpServerTest, RefusesAPortThatIsTaken) {
  start();
  ServerOptions same;
  same.port = port_;
  Server second(same, {}, {}, {}, {});
  EXPECT_THROW(second.bind(), std::runtime_error);
}

}  // namespace
}  // namespace supple::http
