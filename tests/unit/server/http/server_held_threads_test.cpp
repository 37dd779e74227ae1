#include <chrono>
#include <mutex>
#include <string>
#include <thread>

#include "server_fixture.h"

namespace supple::http {
namespace {

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

TEST_F(HttpServerTest, ARequestThatWaitsInTheBackgroundLeavesItsSlotAndItsThreadToOthers) {
  options_.max_requests = 1;
  start();
  Client client(port_);
  client.send(get("/background") + get("/hello/next"));
  while (waiting_ == 0) std::this_thread::sleep_for(1ms);
  EXPECT_TRUE(answer(get("/hello/a")).ends_with("hello a!"));
  EXPECT_TRUE(answer(get("/background")).ends_with("problem server.busy!")) << "such requests have one slot, too";
  EXPECT_TRUE(answer(get("/hello/b")).ends_with("hello b!"));
  release_ = true;
  EXPECT_NE(client.read_until("hello next!").find("waited!"), std::string::npos);
  while (server_->load().answering > 0) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(waiting_, 1);
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

}  // namespace
}  // namespace supple::http
