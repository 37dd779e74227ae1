#pragma once

#include <functional>

namespace supple {

/// Makes this thread compute in the background for the rest of its life: the system gives it a processor where no other
/// thread of the process needs it. Its loops (`parallel_for`) are shared among threads of the same kind and not with
/// the pool of the other computations. Such a thread cannot become an ordinary one again, since Linux lets only
/// privileged processes raise a priority. Threads and processes that it starts have its priority.
void become_background_thread();
bool is_background_thread();

/// `parallel_for` of a background thread: the calling thread and up to thread_count() - 1 further background threads,
/// which the process starts at the first call, take the iterations in turn. Loops may be nested.
void background_parallel_for(int n, const std::function<void(int)>& body);

}  // namespace supple
