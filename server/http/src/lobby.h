#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <unordered_map>
#include <vector>

#include "connection.h"

namespace supple::http {

/// The connections that wait for a request, for the rest of one, or to send the rest of an answer. One thread watches
/// all of them, so that a slow client occupies no thread.
class Lobby {
 public:
  /// Called on the lobby's thread with each connection whose request has arrived or is refused.
  using Deliver = std::function<void(std::shared_ptr<Connection>)>;

  Lobby(Connection::Admit admit, Deliver deliver);
  ~Lobby();
  Lobby(const Lobby&) = delete;
  Lobby& operator=(const Lobby&) = delete;

  /// Adds a connection. Any thread may call. After `stop` the connection is closed.
  void take(std::shared_ptr<Connection> connection);
  /// Closes one waiting connection of the client, or of any client if `client` is empty. The order of preference is:
  /// 1. connections that linger or still send an answer;
  /// 2. connections that have been idle for more than a second;
  /// 3. all others, beginning with those of the client that has most connections here.
  /// Within a group the one that has waited longest goes first. Returns false if there was none. It waits for the
  /// lobby's thread, and only one other thread may call it.
  bool evict_one(const std::string& client);
  /// Time since the thread last woke up: normally half a second at most.
  Connection::Clock::duration silence() const;
  /// Closes every waiting connection and returns once the thread has ended.
  void stop();

 private:
  void run();
  void add(std::shared_ptr<Connection> connection);
  /// Reads from or writes to a socket that is ready.
  void handle_ready(Connection& connection);
  /// Sends more of an answer. Returns true once all of it is sent.
  bool send_more(Connection& connection);
  /// Removes a connection, and delivers it unless it is closed.
  void hand_over(int socket, Connection::Arrival arrival);
  void close_expired();
  /// Chooses and closes one connection for `evict_one`, on the lobby's thread.
  bool close_one(const std::string& client);

  const Connection::Admit admit_;
  const Deliver deliver_;
  const int epoll_;
  const int wake_event_;                                          // eventfd that wakes the thread
  std::unordered_map<int, std::shared_ptr<Connection>> waiting_;  // by socket; used by the lobby's thread only
  std::mutex mutex_;
  std::vector<std::shared_ptr<Connection>> incoming_;
  std::condition_variable eviction_done_;
  std::optional<std::string> eviction_request_;  // argument of `evict_one`, until the thread has handled it
  bool evicted_one_ = false;                     // result of `evict_one`
  bool stopping_ = false;
  std::atomic<Connection::Clock::duration> last_wake_{Connection::Clock::now().time_since_epoch()};
  std::thread thread_;
};

}  // namespace supple::http
