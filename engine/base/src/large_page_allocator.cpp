#include "supple/base/large_page_allocator.h"

#include <sys/mman.h>

#include <cstdlib>

namespace supple {
namespace {

constexpr std::size_t kPage = std::size_t{2} << 20;
/// Below this, whole large pages would waste a noticeable share.
constexpr std::size_t kWorthIt = 4 * kPage;

}  // namespace

void* allocate_large(std::size_t bytes) {
  if (bytes < kWorthIt) {
    if (void* memory = std::malloc(bytes > 0 ? bytes : 1)) return memory;
    throw std::bad_alloc();
  }
  const std::size_t rounded = (bytes + kPage - 1) / kPage * kPage;
  if (rounded < bytes) throw std::bad_alloc();
  void* memory = std::aligned_alloc(kPage, rounded);
  if (!memory) throw std::bad_alloc();
  madvise(memory, rounded, MADV_HUGEPAGE);  // a hint: without large pages everything works, only slower
  return memory;
}

void free_large(void* memory) noexcept { std::free(memory); }

}  // namespace supple
