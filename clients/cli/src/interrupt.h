#pragma once

#include <functional>

namespace supple::cli {

/// Turns Ctrl-C and SIGTERM into a call on a thread of its own, where, unlike in a signal handler, everything is
/// allowed. Construct the watch before any other thread, so that all of them inherit the blocked signals.
class InterruptWatch {
 public:
  InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  /// Whether Ctrl-C was pressed.
  static bool interrupted();

  /// While it lives, an interrupt calls `action` once from the watching thread. Scopes nest; the innermost one is
  /// called. Outside of all scopes an interrupt ends the process.
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
