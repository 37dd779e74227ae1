#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "immediate_answer.h"
#include "supple/json/answers.h"
#include "supple/routes/routes.h"
#include "supple/store/local_store.h"
#include "support/temporary_folder.h"
#include "unit/server/held_computation.h"

namespace supple::routes {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

/// Sends the text on a connection of its own and reads until the server closes.
std::string ask(int port, const std::string& text) {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(::connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  EXPECT_EQ(::send(socket, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
  std::string answer;
  char byte = 0;
  while (::recv(socket, &byte, 1, 0) == 1) answer += byte;
  ::close(socket);
  return answer;
}

/// A server that answers one request at a time, within one slot, and a route whose computation never checks for a stop
/// request.
class LateComputationTest : public ::testing::Test {
 protected:
  LateComputationTest() {
    store_ = std::make_unique<store::LocalStore>(folder_);
    jobs::QueueOptions queue;
    queue.workers = 1;
    queue.immediate = 1;
    jobs_ = std::make_unique<jobs::JobQueue>(*store_, queue, json::write_problem, [](const store::JobRecord&) {});
    services_.jobs = jobs_.get();
    services_.metrics = &metrics_;
    http::Router router;
    router.add({"GET",
                "/held",
                [this](const http::Request& request) {
                  return answer_immediately(services_, request, computation(0.25, [this] { gate_.pass(); }), 0);
                },
                {}});
    router.add({"GET",
                "/quick",
                [this](const http::Request& request) {
                  return answer_immediately(services_, request, computation(60, [] {}), 0);
                },
                {}});
    http::ServerOptions options;
    options.port = 0;
    options.max_requests = 1;
    server_ = std::make_unique<http::Server>(
        options, std::move(router), problem_response,
        [this](const http::AnsweredRequest& answered) {
          const std::lock_guard lock(mutex_);
          answered_.push_back(answered);
          changed_.notify_all();
        },
        [](const std::string&) {});
    port_ = server_->bind();
    thread_ = std::thread([this] { server_->run(); });
  }
  ~LateComputationTest() override {
    gate_.open(1000);
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
    server_.reset();
    jobs_.reset();
  }

  static jobs::Computation computation(double deadline, const std::function<void()>& run) {
    return {.kind = "geodesics", .mesh = {}, .deadline = deadline, .run = [run](const Execution&) {
              run();
              return store::Result{"text/plain", {}, "42"};
            }};
  }
  std::string get(const std::string& path) const {
    return ask(port_, "GET " + path + " HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
  }
  const testing::TemporaryFolder temporary_folder_;
  const fs::path folder_ = temporary_folder_.path();
  std::unique_ptr<store::Store> store_;
  metrics::Metrics metrics_{"0"};
  Services services_;
  std::unique_ptr<jobs::JobQueue> jobs_;
  std::unique_ptr<http::Server> server_;
  int port_ = 0;
  std::thread thread_;
  Gate gate_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<http::AnsweredRequest> answered_;
};

/// The problem of an answer, without what differs from one request to the next.
std::string body_of(const std::string& answer) { return answer.substr(answer.find("\r\n\r\n") + 4); }

TEST_F(LateComputationTest, TheClientHasItsProblemWhileTheComputationIsHeldAndOthersAreAnswered) {
  const auto answer = get("/held");
  EXPECT_EQ(answer.find("HTTP/1.1 504 "), 0U) << answer;
  EXPECT_NE(answer.find("Content-Type: application/problem+json\r\n"), std::string::npos) << answer;
  EXPECT_NE(answer.find("Supple-Request-Id: "), std::string::npos) << answer;
  const problem::Problem deadline{
      "job.deadline_exceeded", "The computation was stopped because its deadline passed.", {}, {}, {}};
  EXPECT_EQ(body_of(answer), json::write_problem(deadline));
  EXPECT_EQ(jobs_->abandoned(), 1U) << "it is still held";
  const auto other = get("/quick");
  EXPECT_EQ(other.find("HTTP/1.1 200 "), 0U) << "in its slot, its place and its thread: " << other;
  EXPECT_EQ(body_of(other), "42");
}

TEST_F(LateComputationTest, WhatIsComputedLaterIsDroppedAndTheAnswerIsToldOfOnce) {
  get("/held");
  // An answer is told of after it has been sent, so the next request may overtake it.
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !answered_.empty(); });
  lock.unlock();
  gate_.open();
  get("/quick");
  lock.lock();
  changed_.wait(lock, [this] { return answered_.size() >= 2; });
  lock.unlock();
  while (jobs_->abandoned() > 0) std::this_thread::sleep_for(1ms);
  get("/quick");
  lock.lock();
  changed_.wait(lock, [this] { return answered_.size() >= 3; });
  EXPECT_EQ(answered_.size(), 3U);
  EXPECT_EQ(answered_.at(0).status, 504);
  EXPECT_EQ(answered_.at(0).path, "/held");
  EXPECT_GE(answered_.at(0).seconds, 1.25);
  EXPECT_EQ(answered_.at(1).status, 200);
  EXPECT_EQ(answered_.at(2).status, 200);
}

TEST_F(LateComputationTest, BeyondTheBoundTheClientIsAnsweredAndItsPlaceStaysTaken) {
  get("/held");
  const auto second = get("/held");
  EXPECT_EQ(second.find("HTTP/1.1 504 "), 0U) << second;
  EXPECT_EQ(jobs_->abandoned(), 2U);
  const auto refused = get("/quick");
  EXPECT_EQ(refused.find("HTTP/1.1 503 "), 0U) << refused;
  gate_.open(2);
  while (jobs_->abandoned() > 0 || server_->load().answering > 0) std::this_thread::sleep_for(1ms);
  const auto other = get("/quick");
  EXPECT_EQ(other.find("HTTP/1.1 200 "), 0U) << other;
}

TEST_F(LateComputationTest, ConnectionsAreCountedAsBeforeOnceTheComputationHasReturned) {
  get("/held");
  gate_.open();
  while (server_->connections() > 0) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(server_->load().answering, 0);
}

}  // namespace
}  // namespace supple::routes
