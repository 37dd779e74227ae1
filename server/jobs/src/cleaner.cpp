#include "cleaner.h"

#include "supple/store/clock.h"

namespace supple::jobs {

std::chrono::milliseconds Cleaner::clean_up() {
  constexpr std::chrono::milliseconds interval{250};
  constexpr std::chrono::seconds write_interval{1};
  constexpr std::chrono::minutes removal_interval{1};
  for (const auto& job : scheduler_.stopped_jobs()) runner_.end_stopped(job);
  runner_.abandon_late_jobs();
  if (options_.memory) options_.memory->return_what_is_free();
  if (const auto now = Clock::now(); now >= next_write_) {
    next_write_ = now + write_interval;
    journal_.write_refused_ends();
    store_.refill_reserve();
  }
  if (const auto now = Clock::now(); now >= next_removal_) {
    next_removal_ = now + removal_interval;
    remove_expired();
  }
  return interval;
}

void Cleaner::remove_expired() {
  try {
    store_.jobs().remove_expired_jobs(store::now_milliseconds(), options_.max_jobs);
    if (options_.clean_up_too) options_.clean_up_too();
  } catch (const Error&) {
    // Nothing is logged: every request that needs the store reports it. The next removal is a minute later.
  }
}

}  // namespace supple::jobs
