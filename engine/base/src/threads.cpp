#include "supple/base/threads.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <memory>
#include <mutex>

#include "supple/base/background_threads.h"
#include "supple/base/memory_account.h"
#include "supple/base/watched_work.h"
#ifdef SUPPLE_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace supple {
namespace {

std::mutex control_mutex;
std::unique_ptr<tbb::global_control> control;

// What a thread does before `publish` happens before what another one does after `observe` of the same address. TBB
// guarantees that order, but the thread sanitizer cannot see into TBB's library and is told here.
void publish([[maybe_unused]] const void* address) {
#ifdef SUPPLE_THREAD_SANITIZER
  __tsan_release(const_cast<void*>(address));
#endif
}
void observe([[maybe_unused]] const void* address) {
#ifdef SUPPLE_THREAD_SANITIZER
  __tsan_acquire(const_cast<void*>(address));
#endif
}

struct PublishAtEnd {
  const void* address;
  ~PublishAtEnd() { publish(address); }
};
struct ObserveAtEnd {
  const void* address;
  ~ObserveAtEnd() { observe(address); }
};

}  // namespace

void set_thread_count(int count) {
  const std::lock_guard lock(control_mutex);
  const int wanted = count < 1 ? tbb::info::default_concurrency() : count;
  control.reset();
  control = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<std::size_t>(wanted));
}

int thread_count() {
  return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

void parallel_for(int n, const std::function<void(int)>& body) {
  if (is_background_thread()) return background_parallel_for(n, body);
  const char finished = 0;
  const ObserveAtEnd all_parts{&finished};
  publish(&body);
  MemoryAccount* const account = MemoryAccount::of_this_thread();
  // A thread that waits for the end of this loop helps with this loop only. Otherwise it might begin further parts of
  // an outer loop, and return only after them.
  tbb::this_task_arena::isolate([&] {
    // An exception in a loop around this one would otherwise end this one too, without a word to its caller, who would
    // go on with what has not been computed.
    tbb::task_group_context context(tbb::task_group_context::isolated);
    const auto part_of_loop = [&](int i) {
      observe(&body);
      const MemoryAccount::Use use(account);
      const WatchedWork watched;
      const PublishAtEnd part{&finished};
      body(i);
    };
    tbb::parallel_for(0, n, part_of_loop, context);
  });
}

}  // namespace supple
