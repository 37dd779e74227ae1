#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <unordered_map>
#include <vector>

#include "connection.h"

namespace supple::http {

/// Where connections wait: for their next request, and for all of its bytes. One thread watches all of them, so that a
/// client which sends slowly, or nothing, keeps no thread from others.
class Lobby {
 public:
  /// Gets connections with a request that has arrived or is refused. Called from the lobby's thread.
  using Deliver = std::function<void(std::shared_ptr<Connection>, Connection::Arrival)>;

  Lobby(Connection::Admit admit, Deliver deliver);
  ~Lobby() { stop(); }
  Lobby(const Lobby&) = delete;
  Lobby& operator=(const Lobby&) = delete;

  /// Takes a connection to wait, or to linger. Any thread may call. Closes it where the lobby has stopped.
  void take(std::shared_ptr<Connection> connection);
  /// Closes a connection, if there is one: that has been answered, that has waited longest without a byte of a request,
  /// or of the client with most connections here the one that has waited longest for the rest. One that has just come
  /// is not the first to go. Any thread but the lobby's may call; returns once it has happened.
  void make_room();
  /// Closes every connection that waits and returns once the thread has ended.
  void stop();

 private:
  void run();
  void add(std::shared_ptr<Connection> connection);
  void look_at(Connection& connection);
  void hand_over(int socket, Connection::Arrival arrival);
  void close_expired();
  void close_one();

  const Connection::Admit admit_;
  const Deliver deliver_;
  const int poll_;
  const int wake_;
  std::unordered_map<int, std::shared_ptr<Connection>> waiting_;  // the thread's alone
  std::mutex mutex_;
  std::vector<std::shared_ptr<Connection>> taken_;
  std::condition_variable room_made_;
  std::uint64_t rooms_asked_for_ = 0;
  std::uint64_t rooms_made_ = 0;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace supple::http
