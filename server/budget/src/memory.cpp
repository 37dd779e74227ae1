#include "supple/budget/memory.h"

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <string>
#include <utility>

#include "supple/problem/problem.h"

namespace supple::budget {
namespace {

thread_local MemoryBudget::Reservation* current = nullptr;

/// The number in a file; 0 where there is none, as with "max".
std::int64_t number_in(const std::string& path) {
  std::ifstream file(path);
  std::string text;
  std::int64_t value = 0;
  if (file >> text) std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// The least limit of this process's control group (version 2) and of the groups around it; 0 where there is none.
std::int64_t control_group_limit() {
  std::int64_t least = 0;
  const auto consider = [&least](std::int64_t limit) {
    if (limit > 0 && (least == 0 || limit < least)) least = limit;
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
  return least;
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

std::int64_t default_budget(const MemoryLimits& limits) {
  auto memory = limits.resident;
  if (limits.virtual_size > 0) memory = std::min(memory, limits.virtual_size);
  return static_cast<std::int64_t>(default_share * static_cast<double>(memory));
}

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
  if (bytes_ + bytes > budget_->each_) {
    problem::throw_limit("request.too_much_memory", "What the request needs in bytes of memory, with " + what + ",",
                         static_cast<double>(budget_->each_), static_cast<double>(bytes_ + bytes),
                         "--max-request-memory");
  }
  const std::lock_guard lock(budget_->mutex_);
  if (budget_->reserved_ + bytes > budget_->total_) {
    constexpr int soon = 5;  // seconds: requests hold what they reserve for as long as they are read and answered
    problem::Problem problem{"server.out_of_memory", {}, {}, {}, soon};
    problem.limit = problem::Limit{static_cast<double>(budget_->total_),
                                   static_cast<double>(budget_->reserved_ + bytes), "--memory"};
    problem.detail = "With " + what + " all requests together would need " +
                     std::to_string(budget_->reserved_ + bytes) + " bytes of memory, the limit is " +
                     std::to_string(budget_->total_) + " (setting --memory).";
    throw problem::ProblemError(std::move(problem));
  }
  budget_->reserved_ += bytes;
  bytes_ += bytes;
}

void MemoryBudget::Reservation::release() noexcept {
  if (!budget_ || bytes_ == 0) return;
  const std::lock_guard lock(budget_->mutex_);
  budget_->reserved_ -= std::exchange(bytes_, 0);
}

std::int64_t MemoryBudget::reserved() const {
  const std::lock_guard lock(mutex_);
  return reserved_;
}

RequestMemory::RequestMemory(MemoryBudget::Reservation& reservation) : outer_(std::exchange(current, &reservation)) {}
RequestMemory::~RequestMemory() { current = outer_; }

void reserve(std::int64_t bytes, const std::string& what) {
  if (current) current->add(bytes, what);
}

void return_free_memory() { ::malloc_trim(0); }

}  // namespace supple::budget
