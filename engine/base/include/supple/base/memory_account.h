#pragma once

#include <cstddef>
#include <cstdint>

namespace supple {

/// Counts what one computation allocates and frees, on all threads that work for it.
///
/// The engine counts nothing by itself: a program that replaces malloc tells this thread's account of each block
/// (`note_allocated`, `note_freed`), and `parallel_for` hands the account to the threads that help. A block that is
/// freed while another account, or none, is this thread's is not seen by the one that paid for it.
class MemoryAccount {
 public:
  virtual ~MemoryAccount() = default;

  /// Bytes that were allocated since the last call, less those that were freed: negative where more were freed. Any
  /// thread may call. Must not allocate.
  virtual void add(std::int64_t bytes) noexcept = 0;
  /// Whether a block of so many bytes may be allocated. Asked for large ones only. Must not allocate.
  virtual bool allows(std::int64_t bytes) noexcept = 0;

  /// The account that this thread works for; null where it works for none.
  static MemoryAccount* of_this_thread() noexcept;

  /// Makes an account this thread's for its lifetime; null for none.
  class Use {
   public:
    explicit Use(MemoryAccount* account) noexcept;
    ~Use();
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    MemoryAccount* const outer_;
    const bool changes_;
  };
};

/// A block from this size on is refused where the account does not allow it. A smaller one never is: code that cannot
/// go on without it may be anywhere, while what is this large is the data of a computation, which knows how to fail.
constexpr std::size_t large_block = std::size_t{1} << 20;

/// Whether an allocator may go on with a block of so many bytes. A few nanoseconds; does not allocate.
bool may_allocate(std::size_t bytes) noexcept;
/// An allocator's word on a block that it has given out, or is about to take back. Small sums are gathered on the
/// thread before they reach the account.
void note_allocated(std::size_t bytes) noexcept;
void note_freed(std::size_t bytes) noexcept;

}  // namespace supple
