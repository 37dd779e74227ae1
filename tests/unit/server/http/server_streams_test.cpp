#include <mutex>
#include <string>

#include "server_fixture.h"

namespace supple::http {
namespace {

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

}  // namespace
}  // namespace supple::http
