#include "request_head.h"

#include <gtest/gtest.h>

#include "chunked_body.h"
#include "supple/base/error.h"

namespace supple::http {
namespace {

std::string refusal(const std::string& head) {
  try {
    read_head(head);
  } catch (const Error& error) {
    return error.code();
  }
  return "none";
}

std::string with(const std::string& headers) { return "POST /v1/x HTTP/1.1\r\nHost: a\r\n" + headers + "\r\n"; }

TEST(RequestHead, IsReadPartByPart) {
  const auto head = read_head(
      "POST /v1/a%20b?c=1&d HTTP/1.1\r\nHost: localhost:80\r\ncontent-length: 12\r\nX-Empty:\r\nX:  y z\t\r\nExpect: "
      "100-continue\r\n\r\n");
  EXPECT_EQ(head.method, "POST");
  EXPECT_EQ(head.path, "/v1/a b");
  EXPECT_EQ(head.query, "c=1&d");
  EXPECT_EQ(head.target, "/v1/a%20b?c=1&d");
  EXPECT_EQ(head.host, "localhost:80");
  EXPECT_EQ(head.content_length, 12U);
  EXPECT_EQ(head.header("x"), "y z");
  EXPECT_EQ(head.header("X-Empty"), "");
  EXPECT_TRUE(head.expects_continue);
  EXPECT_TRUE(head.has_body());
}

TEST(RequestHead, OfAnAbsoluteTargetNamesItsHost) {
  const auto head = read_head("GET http://one.example/a?b HTTP/1.1\r\nHost: two.example\r\n\r\n");
  EXPECT_EQ(head.host, "one.example");
  EXPECT_EQ(head.path, "/a");
  EXPECT_EQ(head.target, "/a?b");
}

TEST(RequestHead, ThatTwoReadersCouldUnderstandDifferentlyIsRefused) {
  for (const char* framing : {"Content-Length: 5\r\nContent-Length: 5\r\n",
                              "Content-Length: 5, 5\r\n",
                              "Content-Length: +5\r\n",
                              "Content-Length: -5\r\n",
                              "Content-Length: 0x5\r\n",
                              "Content-Length: 5 5\r\n",
                              "Content-Length:\r\n",
                              "Content-Length: 99999999999999999999\r\n",
                              "Content-Length : 5\r\n",
                              " Content-Length: 5\r\n",
                              "X: a\r\n b\r\n",
                              "Transfer-Encoding: chunked\r\nContent-Length: 5\r\n",
                              "Transfer-Encoding: gzip, chunked\r\n",
                              "Transfer-Encoding: identity\r\n",
                              "Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n",
                              "Host: b\r\n",
                              "X: a\nY: b\r\n",
                              "X: a\rb\r\n",
                              "X\x01: a\r\n",
                              ": a\r\n",
                              "no colon\r\n",
                              "X: a\x7f\r\n"}) {
    EXPECT_EQ(refusal(with(framing)), "http.bad_request") << framing;
  }
  EXPECT_EQ(refusal(with(std::string("X: a\0b\r\n", 8))), "http.bad_request");
  EXPECT_EQ(refusal(with("Content-Length: 5\r\n")), "none");
  EXPECT_EQ(refusal(with("Transfer-Encoding: Chunked\r\n")), "none");
}

TEST(RequestHead, WithoutTheFormOfARequestLineIsRefused) {
  for (const char* line :
       {"GET /  HTTP/1.1", "GET\t/ HTTP/1.1", "GET / HTTP/1.2", "GET / HTTP/2.0", "GET / http/1.1", "GET /",
        "get / HTTP/1.1", "GET x HTTP/1.1", "GET /a b HTTP/1.1", " GET / HTTP/1.1", "", "GET /%00 HTTP/1.1"}) {
    EXPECT_EQ(refusal(std::string(line) + "\r\nHost: a\r\n\r\n"), "http.bad_request") << line;
  }
  EXPECT_EQ(refusal("GET / HTTP/1.1\r\n\r\n"), "http.bad_request");
  EXPECT_EQ(refusal("GET / HTTP/1.0\r\n\r\n"), "none");
  EXPECT_EQ(refusal("GET / HTTP/1.0\r\nTransfer-Encoding: chunked\r\n\r\n"), "http.bad_request");
  EXPECT_EQ(refusal("GET /" + std::string(2048, 'x') + " HTTP/1.1\r\nHost: a\r\n\r\n"), "http.uri_too_long");
  EXPECT_EQ(refusal("GET /?" + std::string(8191, 'x') + " HTTP/1.1\r\nHost: a\r\n\r\n"), "http.uri_too_long");
}

TEST(RequestHead, HasAtMostAHundredHeaders) {
  std::string headers;
  for (int i = 0; i < 99; ++i) headers += "X: a\r\n";
  EXPECT_EQ(refusal(with(headers)), "none");
  EXPECT_EQ(refusal(with(headers + "X: a\r\n")), "http.bad_request");
}

TEST(Query, IsDecodedAndItsFirstValueCounts) {
  const auto query = read_query("a=1+2&b=%2B%c3%a4&a=3&&c&=d&e=%zz");
  EXPECT_EQ(query.at("a"), "1 2");
  EXPECT_EQ(query.at("b"), "+\xc3\xa4");
  EXPECT_EQ(query.at("c"), "");
  EXPECT_EQ(query.at("e"), "%zz");
  EXPECT_TRUE(read_query("").empty());
}

TEST(ChunkedBody, IsReadInPiecesOfAnySize) {
  const std::string sent = "4;name=value\r\nabcd\r\nA\r\n0123456789\r\n0\r\nTrailer: x\r\n\r\nGET /next";
  for (std::size_t piece = 1; piece <= sent.size(); ++piece) {
    ChunkedBody chunks;
    InputBuffer input;
    std::string body;
    bool done = false;
    for (std::size_t at = 0; at < sent.size(); at += piece) {
      const std::string now = sent.substr(at, piece);
      input.append(now.data(), now.size());
      if (!done) done = chunks.take(input, body);
    }
    EXPECT_TRUE(done);
    EXPECT_EQ(body, "abcd0123456789");
    EXPECT_EQ(input.view(), "GET /next");
  }
}

/// Whether a body in chunks is accepted.
bool is_taken(const std::string& sent) {
  InputBuffer input;
  input.append(sent.data(), sent.size());
  std::string body;
  try {
    ChunkedBody().take(input, body);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "http.bad_request");
    return false;
  }
  return true;
}

TEST(ChunkedBody, WithBrokenFramingIsRefused) {
  for (const char* sent : {"-1\r\n", "+4\r\nabcd\r\n", "0x4\r\nabcd\r\n", " 4\r\nabcd\r\n", "\r\n", "g\r\n",
                           "4\nabcd\r\n", "4\r\nabcde\r\n", "fffffffffffffffff\r\n"})
    EXPECT_FALSE(is_taken(sent)) << sent;
  EXPECT_FALSE(is_taken(std::string(2000, '1')));
}

TEST(ChunkedBody, ThatTwoReadersCouldUnderstandDifferentlyIsRefused) {
  using namespace std::string_literals;
  for (const std::string& sent :
       {"4 garbage\r\nabcd\r\n"s, "4\t4\r\nabcd\r\n"s, "4;a\rb\r\nabcd\r\n"s, "4;a\0b\r\nabcd\r\n"s,
        "4;a\x7f\r\nabcd\r\n"s, "0\r\nno colon\r\n\r\n"s, "0\r\n: no name\r\n\r\n"s, "0\r\nspaced : x\r\n\r\n"s,
        "0\r\n folded\r\n\r\n"s, "0\r\nA: b\0c\r\n\r\n"s})
    EXPECT_FALSE(is_taken(sent)) << sent;
  for (const std::string& sent : {"4 ;a=b\r\nabcd\r\n"s, "4;a;b=\"c\"\r\nabcd\r\n"s, "0\r\nA:\r\n\r\n"s})
    EXPECT_TRUE(is_taken(sent)) << sent;
}

TEST(RequestHead, TellsWhetherTheConnectionEnds) {
  const auto ends = [](const std::string& version, const std::string& headers) {
    return read_head("GET / HTTP/" + version + "\r\nHost: x\r\n" + headers + "\r\n").asks_to_close();
  };
  EXPECT_FALSE(ends("1.1", ""));
  EXPECT_FALSE(ends("1.1", "Connection: keep-alive\r\n"));
  EXPECT_TRUE(ends("1.1", "Connection: Close\r\n"));
  EXPECT_TRUE(ends("1.1", "Connection: keep-alive, close\r\n"));
  EXPECT_TRUE(ends("1.1", "Connection: keep-alive\r\nConnection: close\r\n"));
  EXPECT_FALSE(ends("1.1", "Connection: closer\r\n"));
  EXPECT_TRUE(ends("1.0", ""));
  EXPECT_FALSE(ends("1.0", "Connection: Keep-Alive\r\n"));
  EXPECT_TRUE(ends("1.0", "Connection: keep-alive, close\r\n"));
}

}  // namespace
}  // namespace supple::http
