// Replaces malloc and related functions by ones that also report each block to the MemoryAccount of the thread, so that
// all memory of a computation is counted: containers, matrices, and what C libraries allocate.
//
// The C library allows this, and offers its own functions under the names below. A thread that does not compute has no
// account, and only reads one thread-local pointer. The sanitizers have their own malloc; with them nothing is counted.

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

/// Size of a block in bytes: its usable size and the header of the C library.
std::int64_t bytes_of(void* block) noexcept {
  constexpr std::int64_t header_bytes = 8;
  return static_cast<std::int64_t>(::malloc_usable_size(block)) + header_bytes;
}

void* count_block(void* block) noexcept {
  if (block && MemoryAccount::of_this_thread()) supple::note_block(bytes_of(block));
  return block;
}

void uncount_block(void* block) noexcept {
  if (block && MemoryAccount::of_this_thread()) supple::note_block(-bytes_of(block));
}

void* allocate_aligned(std::size_t alignment, std::size_t bytes) noexcept {
  return supple::may_allocate(bytes) ? count_block(__libc_memalign(alignment, bytes)) : out_of_memory();
}

}  // namespace

extern "C" {

void* malloc(std::size_t bytes) {
  return supple::may_allocate(bytes) ? count_block(__libc_malloc(bytes)) : out_of_memory();
}

void* calloc(std::size_t count, std::size_t bytes) {
  std::size_t total = 0;
  if (__builtin_mul_overflow(count, bytes, &total) || !supple::may_allocate(total)) return out_of_memory();
  return count_block(__libc_calloc(count, bytes));
}

void* realloc(void* block, std::size_t bytes) {
  if (!MemoryAccount::of_this_thread()) return __libc_realloc(block, bytes);
  const std::int64_t before = block ? bytes_of(block) : 0;
  const auto wanted = static_cast<std::int64_t>(bytes);
  if (wanted > before && !supple::may_allocate(static_cast<std::size_t>(wanted - before))) return out_of_memory();
  void* const moved = __libc_realloc(block, bytes);
  if (!moved && bytes > 0) return nullptr;  // the old block remains valid
  supple::note_block(-before);
  return count_block(moved);
}

void free(void* block) {
  uncount_block(block);
  __libc_free(block);
}

void* memalign(std::size_t alignment, std::size_t bytes) { return allocate_aligned(alignment, bytes); }

void* aligned_alloc(std::size_t alignment, std::size_t bytes) { return allocate_aligned(alignment, bytes); }

int posix_memalign(void** block, std::size_t alignment, std::size_t bytes) {
  if (alignment % sizeof(void*) != 0 || (alignment & (alignment - 1)) != 0 || alignment == 0) return EINVAL;
  const int before = errno;
  void* const memory = allocate_aligned(alignment, bytes);
  errno = before;  // posix_memalign returns its error and leaves errno unchanged
  if (!memory) return ENOMEM;
  *block = memory;
  return 0;
}

}  // extern "C"

#endif
