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

/// Where connections wait: for their next request, and for all of its bytes. One thread watches all of them, so that a
/// client which sends slowly, or nothing, keeps no thread from others.
class Lobby {
 public:
  /// Gets connections with a request that has arrived or is refused. Called from the lobby's thread.
  using Deliver = std::function<void(std::shared_ptr<Connection>, Connection::Arrival)>;

  Lobby(Connection::Admit admit, Deliver deliver);
  ~Lobby();
  Lobby(const Lobby&) = delete;
  Lobby& operator=(const Lobby&) = delete;

  /// Takes a connection to wait, or to linger. Any thread may call. Closes it where the lobby has stopped.
  void take(std::shared_ptr<Connection> connection);
  /// Closes a connection of this client, of any where it is empty: one that has been answered, that has waited longest
  /// without a byte of a request, or of the client with most connections here the one that has waited longest for the
  /// rest. One that has just come is not the first to go. Returns whether there was one, once it has been closed. For
  /// one thread, not the lobby's.
  bool make_room(const std::string& client);
  /// How long the thread has not looked at what waits: half a second at most, unless something holds it.
  Connection::Clock::duration silence() const;
  /// Closes every connection that waits and returns once the thread has ended.
  void stop();

 private:
  void run();
  void add(std::shared_ptr<Connection> connection);
  void look_at(Connection& connection);
  /// Sends more of an answer. False where the connection has been closed or goes on waiting.
  bool send_more(Connection& connection);
  void hand_over(int socket, Connection::Arrival arrival);
  void close_expired();
  bool close_one(const std::string& client);

  const Connection::Admit admit_;
  const Deliver deliver_;
  const int poll_;
  const int wake_;
  std::unordered_map<int, std::shared_ptr<Connection>> waiting_;  // the thread's alone
  std::mutex mutex_;
  std::vector<std::shared_ptr<Connection>> taken_;
  std::condition_variable room_made_;
  std::optional<std::string> room_asked_for_;  // by which client's connections, until it has been looked for
  bool closed_one_ = false;                    // whether it was found
  bool stopping_ = false;
  std::atomic<Connection::Clock::duration> looked_at_{Connection::Clock::now().time_since_epoch()};
  std::thread thread_;
};

}  // namespace supple::http
