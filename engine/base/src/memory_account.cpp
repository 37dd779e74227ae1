#include "supple/base/memory_account.h"

namespace supple {
namespace detail {

constinit thread_local ThreadMemory thread_memory;

void tell_account() noexcept {
  const auto bytes = thread_memory.gathered;
  thread_memory.gathered = 0;
  if (thread_memory.account) thread_memory.account->add(bytes);
}

bool ask_account(std::size_t bytes) noexcept {
  if (!thread_memory.account) return true;
  tell_account();
  return thread_memory.account->allows(static_cast<std::int64_t>(bytes));
}

}  // namespace detail

namespace {

/// Below this a thread that turns away from an account keeps the sum, in case it comes back: parts of a loop are many
/// and short, and telling takes a lock.
constexpr std::int64_t worth_telling_at_the_end = 16 << 10;

void turn_to(MemoryAccount* account) noexcept {
  auto& memory = detail::thread_memory;
  if (memory.account && (memory.gathered >= worth_telling_at_the_end || memory.gathered <= -worth_telling_at_the_end)) {
    detail::tell_account();
  }
  memory.account = account;
  if (!account || account == memory.gathered_for) return;
  memory.gathered_for = account;
  memory.gathered = 0;
}

}  // namespace

MemoryAccount::Use::Use(MemoryAccount* account) noexcept : outer_(of_this_thread()) {
  if (account != outer_) turn_to(account);
}

MemoryAccount::Use::~Use() {
  if (outer_ != of_this_thread()) turn_to(outer_);
}

}  // namespace supple
