#pragma once

#include <string_view>

namespace supple {

/// Receives the progress of a computation. It is called from the computing thread, and implementations return quickly.
class ProgressSink {
 public:
  virtual ~ProgressSink() = default;
  /// `fraction` in [0, 1] is the estimated fraction of the work that is done; `stage` names what runs now.
  virtual void report(double fraction, std::string_view stage) = 0;
  /// Receives an intermediate result, in a form that the receiver knows. The latest one counts. Most receivers ignore
  /// it.
  virtual void publish(std::string_view /*partial*/) {}
  /// Hears that the next start of the computation goes on with what has been computed so far, even after a crash.
  virtual void saved() {}
};

}  // namespace supple
