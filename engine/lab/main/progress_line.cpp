#include "progress_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>

namespace supple::lab {
namespace {

constexpr auto terminal_interval = std::chrono::milliseconds(200);
constexpr auto log_interval = std::chrono::seconds(60);

std::string duration(double seconds) {
  const auto whole = static_cast<std::int64_t>(seconds);
  if (whole >= 3600) return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
  if (whole >= 60) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} s", whole);
}

}  // namespace

ProgressLine::ProgressLine(bool quiet)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1), start_(Clock::now()), shown_(start_) {}

ProgressLine::~ProgressLine() {
  if (drawn_) fmt::print(stderr, "\n");
}

void ProgressLine::started(std::int64_t designs, std::int64_t already_finished, std::int64_t states_per_design) {
  const std::lock_guard lock(mutex_);
  designs_ = designs;
  already_finished_ = already_finished;
  states_per_design_ = states_per_design;
  start_ = Clock::now();
  if (already_finished > 0 && !quiet_)
    fmt::print(stderr, "going on: {} of {} designs are done\n", already_finished, designs);
}

void ProgressLine::state_reached() {
  const std::lock_guard lock(mutex_);
  ++pending_states_;
  show(false);
}

void ProgressLine::design_done(const dataset::Design& design) {
  const std::lock_guard lock(mutex_);
  ++done_;
  if (design.rejected()) ++rejected_;
  for (const auto& path : design.paths)
    if (path.stopped != "converged") ++stopped_paths_;
  const auto rows = static_cast<std::int64_t>(design.rows.size());
  rows_ += rows;
  finished_states_ += states_per_design_;
  pending_states_ = std::max<std::int64_t>(0, pending_states_ - rows);
  show(done_ + already_finished_ == designs_);
}

void ProgressLine::show(bool force) {
  const auto now = Clock::now();
  const auto interval = terminal_ ? Clock::duration(terminal_interval) : Clock::duration(log_interval);
  if (quiet_ || (!force && now - shown_ < interval)) return;
  shown_ = now;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  const double states = static_cast<double>(finished_states_ + pending_states_);
  const double all = static_cast<double>((designs_ - already_finished_) * states_per_design_);
  const std::string remaining =
      states > 0 ? duration(std::max(0.0, all - states) * seconds / states) + " to go" : "just begun";
  fmt::print(stderr, "{}{}/{} designs, {} rows, {:.2f} rows/s, {} rejected, {} paths stopped early, {}, {}{}",
             terminal_ ? "\r\033[K" : "", done_ + already_finished_, designs_, rows_ + pending_states_,
             static_cast<double>(rows_ + pending_states_) / std::max(seconds, 1e-3), rejected_, stopped_paths_,
             duration(seconds), remaining, terminal_ ? "" : "\n");
  std::fflush(stderr);
  drawn_ = terminal_;
}

}  // namespace supple::lab
