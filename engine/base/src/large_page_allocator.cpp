#include "supple/base/large_page_allocator.h"

#include <sys/mman.h>

#include <cstdlib>

namespace supple {
namespace {

constexpr std::size_t large_page = std::size_t{2} << 20;
/// Below this, rounding up to whole large pages would waste a noticeable fraction.
constexpr std::size_t min_bytes_in_large_pages = 4 * large_page;

}  // namespace

void* allocate_large(std::size_t bytes) {
  if (bytes < min_bytes_in_large_pages) {
    if (void* memory = std::malloc(bytes > 0 ? bytes : 1)) return memory;
    throw std::bad_alloc();
  }
  const std::size_t rounded = (bytes + large_page - 1) / large_page * large_page;
  if (rounded < bytes) throw std::bad_alloc();
  void* memory = std::aligned_alloc(large_page, rounded);
  if (!memory) throw std::bad_alloc();
  madvise(memory, rounded, MADV_HUGEPAGE);  // a hint: without large pages everything works, only slower
  return memory;
}

void free_large(void* memory) noexcept { std::free(memory); }

}  // namespace supple
