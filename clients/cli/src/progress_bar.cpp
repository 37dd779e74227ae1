#include "progress_bar.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace supple::cli {
namespace {

constexpr auto quiet_time = std::chrono::milliseconds(500);
constexpr int bar_width = 30;

}  // namespace

ProgressBar::ProgressBar(bool enabled)
    : enabled_(enabled && isatty(STDERR_FILENO) == 1), start_(std::chrono::steady_clock::now()) {}

ProgressBar::~ProgressBar() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
}

void ProgressBar::show(double fraction, std::optional<double> remaining, const std::string& stage) {
  const auto elapsed = std::chrono::steady_clock::now() - start_;
  if (!enabled_ || elapsed < quiet_time) return;
  const double clamped = std::clamp(fraction, 0.0, 1.0);
  const int filled = static_cast<int>(std::lround(clamped * bar_width));
  const auto left = remaining ? fmt::format(", {:.0f} s left", *remaining) : std::string();
  fmt::print(stderr, "\r\033[K[{:#<{}}{:.<{}}] {:3.0f} %  {:.0f} s{}  {}", "", filled, "", bar_width - filled,
             100 * clamped, std::chrono::duration<double>(elapsed).count(), left, stage);
  std::fflush(stderr);
  drawn_ = true;
}

void ProgressBar::print_above(const std::string& line) {
  if (!enabled_) return;
  fmt::print(stderr, "\r\033[K{}\n", line);
  std::fflush(stderr);
}

}  // namespace supple::cli
