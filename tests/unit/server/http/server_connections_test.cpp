#include <sys/eventfd.h>
#include <unistd.h>

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "server_fixture.h"

namespace supple::http {
namespace {

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

}  // namespace
}  // namespace supple::http
