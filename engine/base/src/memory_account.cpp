#include "supple/base/memory_account.h"

namespace supple {
namespace detail {

constinit thread_local ThreadMemory thread_memory;

void report_to_account() noexcept {
  const auto bytes = thread_memory.unreported;
  thread_memory.unreported = 0;
  if (thread_memory.account) thread_memory.account->add(bytes);
}

bool ask_account(std::size_t bytes) noexcept {
  if (!thread_memory.account) return true;
  report_to_account();
  return thread_memory.account->allows(static_cast<std::int64_t>(bytes));
}

}  // namespace detail

namespace {

/// A thread that leaves an account reports sums from this size on. It keeps smaller ones in case it comes back: parts
/// of a loop are many and short, and reporting takes a lock.
constexpr std::int64_t min_bytes_reported_at_end = 16 << 10;

void switch_account(MemoryAccount* account) noexcept {
  auto& memory = detail::thread_memory;
  if (memory.account &&
      (memory.unreported >= min_bytes_reported_at_end || memory.unreported <= -min_bytes_reported_at_end)) {
    detail::report_to_account();
  }
  memory.account = account;
  if (!account || account == memory.unreported_account) return;
  memory.unreported_account = account;
  memory.unreported = 0;
}

}  // namespace

MemoryAccount::Use::Use(MemoryAccount* account) noexcept : outer_(of_this_thread()) {
  if (account != outer_) switch_account(account);
}

MemoryAccount::Use::~Use() {
  if (outer_ != of_this_thread()) switch_account(outer_);
}

}  // namespace supple
