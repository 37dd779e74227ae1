#pragma once

#include <cstddef>
#include <cstdint>

namespace supple {

/// Counts what one computation allocates and frees, on all threads that work for it.
///
/// The engine does not count by itself. A program that replaces malloc reports each block to the thread's account
/// (`note_block`), and `parallel_for` hands the account to the threads that help. If a block is freed while the thread
/// has another account, or none, the account that paid for it does not see it. A thread that changes to another account
/// may leave a few kilobytes uncounted.
class MemoryAccount {
 public:
  virtual ~MemoryAccount() = default;

  /// Called with the bytes that were allocated since the last call, less those that were freed. The number is negative
  /// if more were freed. Any thread may call it. It must not allocate.
  virtual void add(std::int64_t bytes) noexcept = 0;
  /// Whether a block of `bytes` bytes may be allocated. It is asked for large blocks only, and must not allocate.
  virtual bool allows(std::int64_t bytes) noexcept = 0;

  /// The account for which this thread works, or null.
  static MemoryAccount* of_this_thread() noexcept;

  /// Makes an account that of this thread during the lifetime of this object. Null means none.
  class Use {
   public:
    explicit Use(MemoryAccount* account) noexcept;
    ~Use();
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    MemoryAccount* const outer_;
  };
};

/// Blocks from this size on are refused if the account does not allow them. Smaller blocks are never refused, because
/// code that cannot go on without them may be anywhere. A block of this size is the data of a computation, which knows
/// how to fail.
constexpr std::size_t large_block = std::size_t{1} << 20;

namespace detail {

struct ThreadMemory {
  MemoryAccount* account = nullptr;             ///< the account for which this thread works
  MemoryAccount* unreported_account = nullptr;  ///< the account of `unreported`
  std::int64_t unreported = 0;                  ///< bytes that have not been reported yet
};
extern constinit thread_local ThreadMemory thread_memory;

/// Sums below this are gathered on the thread before they are reported to the account.
constexpr std::int64_t min_reported_bytes = 256 << 10;

bool ask_account(std::size_t bytes) noexcept;
void report_to_account() noexcept;

}  // namespace detail

inline MemoryAccount* MemoryAccount::of_this_thread() noexcept { return detail::thread_memory.account; }

/// Whether an allocator may allocate a block of `bytes` bytes. Takes a nanosecond for small blocks; does not allocate.
inline bool may_allocate(std::size_t bytes) noexcept { return bytes < large_block || detail::ask_account(bytes); }

/// An allocator calls this for a block that it has given out (`bytes` positive) or is about to take back (negative),
/// while this thread has an account.
inline void note_block(std::int64_t bytes) noexcept {
  auto& memory = detail::thread_memory;
  memory.unreported += bytes;
  if (memory.unreported >= detail::min_reported_bytes || memory.unreported <= -detail::min_reported_bytes)
    detail::report_to_account();
}

}  // namespace supple
