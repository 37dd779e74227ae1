#include "supple/budget/memory.h"

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <string>
#include <utility>

#include "refusals.h"
#include "supple/budget/computation_memory.h"

namespace supple::budget {
namespace {

thread_local MemoryBudget::Reservation* current = nullptr;  // reservation of the request that this thread answers

/// The number in a file; 0 if there is none, for example if the file contains "max".
std::int64_t number_in(const std::string& path) {
  std::ifstream file(path);
  std::string text;
  std::int64_t value = 0;
  if (file >> text) std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// The smallest memory limit of this process's control group and its parents, in bytes (version 2 or 1); 0 if there is
/// none.
std::int64_t control_group_limit() {
  std::int64_t min_limit = 0;
  const auto consider = [&min_limit](std::int64_t limit) {
    if (limit > 0 && (min_limit == 0 || limit < min_limit)) min_limit = limit;
  };
  std::ifstream groups("/proc/self/cgroup");
  std::string line;
  while (std::getline(groups, line)) {
    const bool version_2 = line.starts_with("0::");
    const auto memory = line.find(":memory:");
    if (!version_2 && memory == std::string::npos) continue;
    const std::string root = version_2 ? "/sys/fs/cgroup" : "/sys/fs/cgroup/memory";
    const std::string file = version_2 ? "/memory.max" : "/memory.limit_in_bytes";
    auto group = version_2 ? line.substr(3) : line.substr(memory + 8);
    while (true) {
      auto path = root;
      path.append(group == "/" ? "" : group).append(file);
      consider(number_in(path));
      const auto slash = group.rfind('/');
      if (slash == std::string::npos || group.size() <= 1) break;
      group.resize(std::max<std::size_t>(slash, 1));
    }
  }
  return min_limit;
}

}  // namespace

MemoryUse memory_use() {
  std::ifstream file("/proc/self/statm");
  std::int64_t pages = 0;
  std::int64_t resident = 0;
  if (!(file >> pages >> resident)) return {};
  static const std::int64_t page = ::sysconf(_SC_PAGESIZE);
  return {resident * page, pages * page};
}

MemoryLimits memory_limits() {
  MemoryLimits limits;
  limits.resident = static_cast<std::int64_t>(::sysconf(_SC_PHYS_PAGES)) * ::sysconf(_SC_PAGESIZE);
  if (const auto group = control_group_limit(); group > 0) limits.resident = std::min(limits.resident, group);
  rlimit space{};
  if (::getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY) {
    limits.virtual_size = static_cast<std::int64_t>(space.rlim_cur);
  }
  return limits;
}

MemoryDefaults memory_defaults(const MemoryLimits& limits) {
  auto memory = limits.resident;
  if (limits.virtual_size > 0) memory = std::min(memory, limits.virtual_size);
  constexpr std::int64_t gibibyte = 1LL << 30;
  return {memory / 2, std::max(memory / 4, gibibyte), std::min(memory / 8, 2 * gibibyte),
          std::min(memory / 4, 8 * gibibyte), memory / 16 * 11};
}

void limit_arenas(int cores) { ::mallopt(M_ARENA_MAX, 2 * cores); }

MemoryBudget::Reservation::Reservation(Reservation&& other) noexcept
    : budget_(other.budget_), bytes_(std::exchange(other.bytes_, 0)) {}

MemoryBudget::Reservation& MemoryBudget::Reservation::operator=(Reservation&& other) noexcept {
  if (this != &other) {
    release();
    budget_ = other.budget_;
    bytes_ = std::exchange(other.bytes_, 0);
  }
  return *this;
}

void MemoryBudget::Reservation::add(std::int64_t bytes, const std::string& what) {
  if (!budget_ || bytes <= 0) return;
  budget_->check_one(bytes_ + bytes, what);
  if (const auto resident = budget_->resident_beyond_limit(); resident > 0) refuse_process(resident, what);
  std::int64_t all = 0;
  {
    const std::lock_guard lock(budget_->mutex_);
    all = budget_->in_use() + bytes;
    if (all <= budget_->total_) budget_->reserved_ += bytes;
  }
  // The mutex is released, because counting the allocations for the text locks it.
  if (all > budget_->total_) refuse_all(budget_->total_, all, what);
  bytes_ += bytes;
}

void MemoryBudget::Reservation::release() noexcept {
  if (!budget_ || bytes_ == 0) return;
  const std::lock_guard lock(budget_->mutex_);
  budget_->note_release(bytes_);
  budget_->reserved_ -= std::exchange(bytes_, 0);
}

void MemoryBudget::check_one(std::int64_t bytes, const std::string& what) const {
  if (bytes > max_per_request_) refuse_one(max_per_request_, bytes, what);
}

std::int64_t MemoryBudget::used() const {
  const std::lock_guard lock(mutex_);
  return in_use();
}

std::int64_t MemoryBudget::resident_beyond_limit() const {
  if (max_resident_ <= 0 || memory_use().resident <= max_resident_) return 0;
  return_free_memory();
  const auto resident = memory_use().resident;
  return resident > max_resident_ ? resident : 0;
}

void MemoryBudget::relieve() {
  const auto resident = resident_beyond_limit();
  if (resident == 0) return;
  const std::lock_guard lock(mutex_);
  ComputationMemory::stop_largest_in(*this, resident, max_resident_);
}

void MemoryBudget::note_release(std::int64_t bytes) noexcept {
  constexpr std::int64_t min_trim_bytes = 16 << 20;
  if (bytes >= min_trim_bytes) may_trim_ = true;
}

void MemoryBudget::return_what_is_free() {
  {
    const std::lock_guard lock(mutex_);
    if (!may_trim_ || !computations_.empty()) return;
    may_trim_ = false;
  }
  return_free_memory();
}

RequestMemory::RequestMemory(MemoryBudget::Reservation& reservation) : outer_(std::exchange(current, &reservation)) {}
RequestMemory::~RequestMemory() { current = outer_; }

void reserve(std::int64_t bytes, const std::string& what) {
  if (current) current->add(bytes, what);
}

void return_free_memory() { ::malloc_trim(0); }

}  // namespace supple::budget
