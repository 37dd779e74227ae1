#pragma once

#include <string_view>

namespace supple {

/// Receives how far a computation has come. Called from the computing thread; implementations return quickly.
class ProgressSink {
 public:
  virtual ~ProgressSink() = default;
  /// `fraction` in [0, 1] is the estimated share of the work that is done; `stage` names what runs now.
  virtual void report(double fraction, std::string_view stage) = 0;
  /// An intermediate result in the form that its receiver knows; the latest counts. Most receivers have no use for it.
  virtual void publish(std::string_view /*partial*/) {}
};

}  // namespace supple
