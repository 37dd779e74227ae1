#include "supple/base/background_threads.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "supple/base/memory_account.h"
#include "supple/base/threads.h"
#include "supple/base/watched_work.h"

namespace supple {
namespace {

/// Difference between the niceness of a background thread and that of the process. Beside an ordinary thread it gets a
/// tenth of a processor: little enough that others do not notice it, and enough that it soon releases a mutex for which
/// others wait.
constexpr int background_niceness = 10;
constexpr int max_niceness = 19;

thread_local bool is_background = false;

/// A loop whose iterations are taken in turn.
struct Loop {
  const int n;
  const std::function<void(int)>& body;
  MemoryAccount* const account;
  std::atomic<int> next{0};
  int helpers = 0;               // threads that help; guarded by the mutex of the team
  std::exception_ptr failure{};  // the first one; guarded by the mutex of the team

  bool has_iterations() const { return next < n; }
};

/// The threads that help background computations with their loops.
class Team {
 public:
  explicit Team(int helpers) {
    try {
      for (int i = 0; i < helpers; ++i) threads_.emplace_back([this] { help(); });
    } catch (const std::exception&) {
      // The system gives no further thread now. Loops do with those that there are.
    }
  }
  ~Team() {
    {
      const std::lock_guard lock(mutex_);
      is_ending_ = true;
    }
    work_.notify_all();
    for (auto& thread : threads_) thread.join();
  }
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  void run(int n, const std::function<void(int)>& body) {
    Loop loop{n, body, MemoryAccount::of_this_thread()};
    {
      const std::lock_guard lock(mutex_);
      loops_.push_back(&loop);
    }
    work_.notify_all();
    compute(loop);
    std::unique_lock lock(mutex_);
    std::erase(loops_, &loop);
    done_.wait(lock, [&] { return loop.helpers == 0; });
    if (loop.failure) std::rethrow_exception(loop.failure);
  }

 private:
  void compute(Loop& loop) {
    const MemoryAccount::Use use(loop.account);
    const WatchedWork watched;
    try {
      for (int i = loop.next++; i < loop.n; i = loop.next++) loop.body(i);
    } catch (...) {
      loop.next = loop.n;
      const std::lock_guard lock(mutex_);
      if (!loop.failure) loop.failure = std::current_exception();
    }
  }

  void help() {
    become_background_thread();
    std::unique_lock lock(mutex_);
    while (true) {
      Loop* loop = nullptr;
      work_.wait(lock, [&] { return is_ending_ || (loop = open_loop()); });
      if (!loop) return;
      ++loop->helpers;
      lock.unlock();
      compute(*loop);
      lock.lock();
      if (--loop->helpers == 0) done_.notify_all();
    }
  }

  /// The latest loop that has iterations left, which is mostly an inner one, for whose end an outer one waits.
  Loop* open_loop() const {
    const auto found =
        std::find_if(loops_.rbegin(), loops_.rend(), [](const Loop* loop) { return loop->has_iterations(); });
    return found == loops_.rend() ? nullptr : *found;
  }

  std::mutex mutex_;
  std::condition_variable work_;
  std::condition_variable done_;
  std::vector<Loop*> loops_;
  bool is_ending_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace

void become_background_thread() {
  is_background = true;
  // Relative to the process, which may be nice itself. A thread that was started by a background thread is nice
  // already.
  const int niceness = ::getpriority(PRIO_PROCESS, static_cast<id_t>(::getpid())) + background_niceness;
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), std::min(niceness, max_niceness));
}

bool is_background_thread() { return is_background; }

void background_parallel_for(int n, const std::function<void(int)>& body) {
  if (n <= 1) {
    if (n == 1) body(0);
    return;
  }
  static Team team(thread_count() - 1);
  team.run(n, body);
}

}  // namespace supple
