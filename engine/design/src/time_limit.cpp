#include "time_limit.h"

namespace supple::design {
namespace {

/// Delay at which a stop request of the whole computation is noticed.
constexpr std::chrono::milliseconds check_interval{10};

}  // namespace

TimeLimit::TimeLimit(const CancellationToken& whole, double seconds)
    : whole_(whole),
      end_(Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds))),
      watch_("the watch over a time limit",
             [this] {
               request_stop_when_due();
               return check_interval;
             },
             {}) {
  request_stop_when_due();
}

void TimeLimit::request_stop_when_due() const {
  if (whole_.requested())
    token_.request(whole_.reason());
  else if (Clock::now() >= end_)
    token_.request(StopReason::deadline);
}

}  // namespace supple::design
