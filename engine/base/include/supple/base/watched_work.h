#pragma once

namespace supple {

/// Finds work that nothing can stop: in a build with SUPPLE_CHECK_PACE, a thread that works for a computation for more
/// than 50 ms of its CPU time between two looks at the token is reported on the standard error, with its calls. In
/// other builds this is nothing.
///
/// A computation's own thread and those that help with it are watched during the lifetime of an object; objects may
/// nest.
class WatchedWork {
 public:
#ifdef SUPPLE_CHECK_PACE
  WatchedWork() noexcept;
  ~WatchedWork();
  /// The thread looks at the token now.
  static void looked() noexcept;
#else
  // Not defaulted, so that an object that only lives is no unused variable.
  WatchedWork() noexcept {}
  ~WatchedWork() {}
  static void looked() noexcept {}
#endif
  WatchedWork(const WatchedWork&) = delete;
  WatchedWork& operator=(const WatchedWork&) = delete;
};

}  // namespace supple
