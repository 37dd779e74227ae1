#pragma once

namespace supple {

/// Finds work that cannot be stopped: in a build with SUPPLE_CHECK_PACE, a thread that works for a computation for more
/// than 50 ms of its CPU time between two checks of the token is reported on the standard error, with its call stack.
/// In other builds this does nothing.
///
/// A computation's own thread and those that help with it are watched during the lifetime of an object; objects may
/// nest.
class WatchedWork {
 public:
#ifdef SUPPLE_CHECK_PACE
  WatchedWork() noexcept;
  ~WatchedWork();
  /// Notes that the thread checks the token now.
  static void checked() noexcept;
#else
  // These are not defaulted, so that compilers do not take an object for an unused variable.
  WatchedWork() noexcept {}
  ~WatchedWork() {}
  static void checked() noexcept {}
#endif
  WatchedWork(const WatchedWork&) = delete;
  WatchedWork& operator=(const WatchedWork&) = delete;
};

}  // namespace supple
