#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace supple {

/// A thread that takes a step again and again. Whatever a step throws, the thread goes on with the next one; of
/// failures in a row, the log gets the first.
class RepeatingThread {
 public:
  /// Returns the time to wait before the next step.
  using Step = std::function<std::chrono::milliseconds()>;
  using Log = std::function<void(const std::string&)>;

  /// `task` begins the line of the log: "the cleaner". `log` may be empty.
  RepeatingThread(std::string task, Step step, Log log);
  /// Waits for the step that is being taken.
  ~RepeatingThread();
  RepeatingThread(const RepeatingThread&) = delete;
  RepeatingThread& operator=(const RepeatingThread&) = delete;

 private:
  static constexpr std::chrono::milliseconds wait_after_failure{500};

  void run();
  std::chrono::milliseconds try_step() noexcept;
  void note_failure(const char* reason) noexcept;

  const std::string task_;
  const Step step_;
  const Log log_;
  bool has_failed_ = false;  // the latest step; used by the thread alone
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace supple
