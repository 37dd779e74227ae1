#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace supple::cli {

/// A bar on standard error that is redrawn in place. It is not drawn if standard error is no terminal, nor in the first
/// half second, so that short computations do not flicker.
class ProgressBar {
 public:
  explicit ProgressBar(bool enabled);
  /// Erases the bar.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Draws the bar. `fraction` is in [0, 1]; `remaining` are the seconds that are left, where they are known; `stage`
  /// is a description of the current stage.
  void show(double fraction, std::optional<double> remaining, const std::string& stage);

  /// Prints a line that remains above the bar. It is not printed where the bar is not drawn.
  void print_above(const std::string& line);

 private:
  bool enabled_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace supple::cli
