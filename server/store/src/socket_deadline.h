#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

namespace supple::store {

/// Shuts a socket down that was watched for too long, so that a call that reads from it fails. The limits of TCP do not
/// notice a hanging process, whose machine still acknowledges what it is sent. One socket at a time.
class SocketDeadline {
 public:
  /// Ends the watch when it is destroyed. That must be before the socket is closed, whose number may belong to another
  /// one afterwards.
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
  std::optional<Clock::time_point> expires_at_;  ///< none where nothing is watched
  bool waits_for_watch_ = false;                 ///< whether the thread sleeps until the next watch begins
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace supple::store
