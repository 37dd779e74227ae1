#pragma once

#include <chrono>
#include <string>

namespace supple::cli {

/// A bar on standard error that is redrawn in place. Draws nothing where standard error is no terminal, and nothing in
/// the first half second, so that short computations leave no flicker.
class ProgressBar {
 public:
  explicit ProgressBar(bool enabled);
  /// Erases the bar.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `fraction` in [0, 1]; `stage` says what runs now.
  void show(double fraction, const std::string& stage);

 private:
  bool enabled_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace supple::cli
