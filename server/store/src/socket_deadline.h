#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

namespace supple::store {

/// Shuts a socket down that has been watched for too long, so that a call which reads from it fails instead of waiting
/// for ever: the other side may hang while its machine still acknowledges what it is sent, which no limit of TCP
/// notices. One socket at a time.
class SocketDeadline {
 public:
  /// Ends the watch. It has to end before the socket is closed, whose number may be another's then.
  class Watch {
   public:
    explicit Watch(SocketDeadline& deadline) : deadline_(deadline) {}
    ~Watch() { deadline_.end(); }
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

   private:
    SocketDeadline& deadline_;
  };

  /// `limit` in seconds.
  explicit SocketDeadline(double limit);
  ~SocketDeadline();
  SocketDeadline(const SocketDeadline&) = delete;
  SocketDeadline& operator=(const SocketDeadline&) = delete;

  [[nodiscard]] Watch watch(int socket);

 private:
  using Clock = std::chrono::steady_clock;

  void end();
  void run();

  const Clock::duration limit_;
  std::mutex mutex_;
  std::condition_variable changed_;
  int socket_ = -1;
  std::optional<Clock::time_point> until_;  ///< none where nothing is watched
  bool asleep_ = false;                     ///< until the next watch begins
  bool stops_ = false;
  std::thread thread_;
};

}  // namespace supple::store
