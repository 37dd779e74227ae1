#include "connection.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string>

namespace supple::http {
namespace {

/// A connection whose client is the test.
class ConnectionTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, sockets_.data()), 0);
    connection_.emplace(sockets_[0], "client", nullptr, bodies_, Connection::Timeouts{});
    route_.body = {1'000'000, "--max-json"};
  }
  void TearDown() override { ::close(sockets_[1]); }

  void send(const std::string& text) {
    ASSERT_EQ(::send(sockets_[1], text.data(), text.size(), MSG_DONTWAIT), static_cast<ssize_t>(text.size()));
  }
  Connection::Arrival advance(std::size_t max_bytes) {
    return connection_->advance([this](Connection& connection) { connection.route = &route_; }, max_bytes);
  }
  /// Number of calls of `advance` until the request is complete or refused.
  int turns(std::size_t max_bytes) {
    int count = 1;
    while (advance(max_bytes) == Connection::Arrival::waiting && count < 1000) ++count;
    return count;
  }

  std::array<int, 2> sockets_{};
  ArrivingBodies bodies_{0, 0};
  Route route_;
  std::optional<Connection> connection_;
};

// The reading thread serves all connections. A client that sends as fast as the thread reads must not occupy it.
TEST_F(ConnectionTest, ReadsABodyInTurns) {
  const std::string head = "POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 100000\r\n\r\n";
  send(head + std::string(100'000, 'x'));
  EXPECT_EQ(turns(10'000), 11);
  EXPECT_EQ(connection_->request.body, std::string(100'000, 'x'));
}

TEST_F(ConnectionTest, ReadsABodyInChunksInTurns) {
  std::string sent = "POST / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n";
  for (int i = 0; i < 1000; ++i) sent += "64\r\n" + std::string(100, 'x') + "\r\n";
  send(sent + "0\r\n\r\n");
  EXPECT_EQ(turns(10'000), 11);
  EXPECT_EQ(connection_->request.body, std::string(100'000, 'x'));
}

TEST_F(ConnectionTest, ReadsAHeadInTurns) {
  send("GET / HTTP/1.1\r\nHost: x\r\nX: " + std::string(50'000, 'x') + "\r\n\r\n");
  EXPECT_EQ(turns(10'000), 6);
  EXPECT_FALSE(connection_->refusal());
}

TEST_F(ConnectionTest, ReadsAllOfASmallRequestInOneTurn) {
  send("GET / HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_EQ(turns(Connection::max_turn_bytes), 1);
}

TEST_F(ConnectionTest, DiscardsInTurns) {
  send(std::string(150'000, 'x'));
  EXPECT_TRUE(connection_->discard());
  std::array<char, 1> byte{};
  EXPECT_GT(::recv(sockets_[0], byte.data(), 1, MSG_PEEK | MSG_DONTWAIT), 0) << "something is left for the next turn";
}

}  // namespace
}  // namespace supple::http
