// Replaces malloc and its kin by those of the C library with a word to this thread's MemoryAccount, so that whatever a
// computation allocates is counted: containers, matrices, and what C libraries work in.
//
// The C library allows malloc to be replaced by a program's own and keeps its functions under the names below. Threads
// without an account, which is all but those that compute, pay for one look at a thread-local pointer. The sanitizers
// bring a malloc of their own: with them nothing is counted.

#include "supple/budget/counting_malloc.h"

#include <malloc.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>

#include "supple/base/memory_account.h"

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define SUPPLE_SANITIZER_ALLOCATES
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__GLIBC__)
#define SUPPLE_SANITIZER_ALLOCATES
#endif

namespace supple::budget {

#ifdef SUPPLE_SANITIZER_ALLOCATES
bool counts_allocations() { return false; }
#else
bool counts_allocations() { return true; }
#endif

}  // namespace supple::budget

#ifndef SUPPLE_SANITIZER_ALLOCATES

extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* block, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);
void __libc_free(void* block);
}

namespace {

using supple::MemoryAccount;

void* out_of_memory() noexcept {
  errno = ENOMEM;
  return nullptr;
}

/// What a block takes: what may be used of it, and what the C library keeps beside it.
std::int64_t bytes_of(void* block) noexcept {
  constexpr std::int64_t beside = 8;
  return static_cast<std::int64_t>(::malloc_usable_size(block)) + beside;
}

void* counted(void* block) noexcept {
  if (block && MemoryAccount::of_this_thread()) supple::note_block(bytes_of(block));
  return block;
}

void uncounted(void* block) noexcept {
  if (block && MemoryAccount::of_this_thread()) supple::note_block(-bytes_of(block));
}

void* aligned(std::size_t alignment, std::size_t bytes) noexcept {
  return supple::may_allocate(bytes) ? counted(__libc_memalign(alignment, bytes)) : out_of_memory();
}

}  // namespace

extern "C" {

void* malloc(std::size_t bytes) {
  return supple::may_allocate(bytes) ? counted(__libc_malloc(bytes)) : out_of_memory();
}

void* calloc(std::size_t count, std::size_t bytes) {
  std::size_t all = 0;
  if (__builtin_mul_overflow(count, bytes, &all) || !supple::may_allocate(all)) return out_of_memory();
  return counted(__libc_calloc(count, bytes));
}

void* realloc(void* block, std::size_t bytes) {
  if (!MemoryAccount::of_this_thread()) return __libc_realloc(block, bytes);
  const std::int64_t before = block ? bytes_of(block) : 0;
  const auto wanted = static_cast<std::int64_t>(bytes);
  if (wanted > before && !supple::may_allocate(static_cast<std::size_t>(wanted - before))) return out_of_memory();
  void* const moved = __libc_realloc(block, bytes);
  if (!moved && bytes > 0) return nullptr;  // the old block stays
  supple::note_block(-before);
  return counted(moved);
}

void free(void* block) {
  uncounted(block);
  __libc_free(block);
}

void* memalign(std::size_t alignment, std::size_t bytes) { return aligned(alignment, bytes); }

void* aligned_alloc(std::size_t alignment, std::size_t bytes) { return aligned(alignment, bytes); }

int posix_memalign(void** block, std::size_t alignment, std::size_t bytes) {
  if (alignment % sizeof(void*) != 0 || (alignment & (alignment - 1)) != 0 || alignment == 0) return EINVAL;
  const int before = errno;
  void* const memory = aligned(alignment, bytes);
  errno = before;  // it answers with a number, and leaves errno alone
  if (!memory) return ENOMEM;
  *block = memory;
  return 0;
}

}  // extern "C"

#endif
