#include "supple/base/threads.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <memory>
#include <mutex>

namespace supple {
namespace {

std::mutex control_mutex;
std::unique_ptr<tbb::global_control> control;

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
  tbb::parallel_for(0, n, [&](int i) { body(i); });
}

}  // namespace supple
