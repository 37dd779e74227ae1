#include "supple/base/memory_account.h"

namespace supple {
namespace {

struct OfThread {
  MemoryAccount* account = nullptr;
  std::int64_t gathered = 0;  // bytes that the account has not heard of
};
constinit thread_local OfThread of_thread;

constexpr std::int64_t worth_telling = 256 << 10;

void tell() noexcept {
  const auto bytes = of_thread.gathered;
  of_thread.gathered = 0;
  if (bytes != 0) of_thread.account->add(bytes);
}

void gather(std::int64_t bytes) noexcept {
  of_thread.gathered += bytes;
  if (of_thread.gathered >= worth_telling || of_thread.gathered <= -worth_telling) tell();
}

}  // namespace

MemoryAccount* MemoryAccount::of_this_thread() noexcept { return of_thread.account; }

MemoryAccount::Use::Use(MemoryAccount* account) noexcept
    : outer_(of_thread.account), changes_(account != of_thread.account) {
  if (!changes_) return;
  if (outer_) tell();
  of_thread.account = account;
}

MemoryAccount::Use::~Use() {
  if (!changes_) return;
  if (of_thread.account) tell();
  of_thread.account = outer_;
}

bool may_allocate(std::size_t bytes) noexcept {
  if (bytes < large_block || !of_thread.account) return true;
  tell();
  return of_thread.account->allows(static_cast<std::int64_t>(bytes));
}

void note_allocated(std::size_t bytes) noexcept {
  if (of_thread.account) gather(static_cast<std::int64_t>(bytes));
}

void note_freed(std::size_t bytes) noexcept {
  if (of_thread.account) gather(-static_cast<std::int64_t>(bytes));
}

}  // namespace supple
