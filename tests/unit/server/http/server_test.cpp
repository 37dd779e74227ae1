#include <chrono>
#include <mutex>
#include <string>
#include <thread>

#include "server_fixture.h"

namespace supple::http {
namespace {

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

TEST_F(HttpServerTest, ClosesWhereOneOfTheOptionsOfTheConnectionIsClose) {
  start();
  Client client(port_);
  client.send("GET /hello/a HTTP/1.1\r\nHost: x\r\nConnection: keep-alive, close\r\n\r\n");
  EXPECT_TRUE(client.read_all().ends_with("hello a!"));
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
