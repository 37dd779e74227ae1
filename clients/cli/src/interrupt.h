#pragma once

#include <functional>

namespace supple::cli {

/// Turns Ctrl-C and SIGTERM into a call on a separate thread, which, unlike a signal handler, may do anything. The
/// watch must be constructed before any other thread, so that all threads inherit the blocked signals.
class InterruptWatch {
 public:
  InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  /// Whether Ctrl-C was pressed.
  static bool interrupted();

  /// During its lifetime an interrupt calls `action` once, from the watching thread. If scopes are nested, the
  /// innermost one's action is called. Outside of all scopes an interrupt ends the process.
  class Scope {
   public:
    explicit Scope(std::function<void()> action);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    std::function<void()> outer_;
  };
};

}  // namespace supple::cli
