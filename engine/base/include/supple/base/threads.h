#pragma once

#include <functional>

namespace supple {

/// Sets the number of compute threads, which is that of the process's TBB pool; `count` < 1 means the machine's number
/// of cores. No other place sets it. Call once, before the first parallel work.
void set_thread_count(int count);
int thread_count();

/// Calls body(i) for i in [0, n), in parallel on these threads. If there are exceptions, one reaches the caller. A
/// background thread has others for it (background_threads.h).
void parallel_for(int n, const std::function<void(int)>& body);

}  // namespace supple
