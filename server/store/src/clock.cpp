#include "supple/store/clock.h"

#include <ctime>
#include <fstream>
#include <utility>

namespace supple::store {
namespace {

std::int64_t milliseconds_of(clockid_t clock) {
  timespec time{};
  ::clock_gettime(clock, &time);
  return std::int64_t{time.tv_sec} * 1000 + time.tv_nsec / 1'000'000;
}

const ProcessClock& process_clock() {
  static const ProcessClock clock;
  return clock;
}

}  // namespace

ProcessClock::ProcessClock()
    : ProcessClock([] { return milliseconds_of(CLOCK_REALTIME); }, [] { return milliseconds_of(CLOCK_BOOTTIME); }) {}

ProcessClock::ProcessClock(const Source& wall, Source elapsed)
    : elapsed_(std::move(elapsed)), origin_(wall() - elapsed_()) {}

std::int64_t now_milliseconds() { return process_clock().now(); }

std::int64_t machine_start_time() { return process_clock().origin(); }

std::string machine_start_id() {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string id;
  file >> id;
  return id;
}

}  // namespace supple::store
