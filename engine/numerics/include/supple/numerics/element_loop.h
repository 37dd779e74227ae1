#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

#include "supple/base/threads.h"

namespace supple::numerics {

/// Evaluates a term's elements in parallel and adds them one after another, so that the sum has the same bits for any
/// number of threads.
///
/// evaluate(i, local) writes the complete result of element i to `local`. It runs on any thread and changes nothing
/// else. add(i, local) runs on the calling thread, in ascending order of i. If it returns false, the remaining elements
/// are skipped. `grain` is the number of elements of one task, which should take some 20 us. A parallel run takes about
/// 1 MB of memory.
template <class Local, class Evaluate, class Add>
void add_elements(std::size_t count, std::size_t grain, const Evaluate& evaluate, const Add& add) {
  static_assert(std::is_trivially_default_constructible_v<Local>, "what an element gives is left as it is until then");
  if (count <= grain || thread_count() == 1) {
    Local local;
    for (std::size_t i = 0; i < count; ++i) {
      evaluate(i, local);
      if (!add(i, std::as_const(local))) return;
    }
    return;
  }
  // The results of one batch stay in the cache until they are added.
  constexpr std::size_t bytes = 1 << 20;
  const std::size_t tasks = std::max<std::size_t>(2, bytes / (grain * sizeof(Local)));
  const std::size_t batch = std::min(count, tasks * grain);
  const auto locals = std::make_unique_for_overwrite<Local[]>(batch);
  for (std::size_t first = 0; first < count; first += batch) {
    const std::size_t size = std::min(batch, count - first);
    parallel_for(static_cast<int>((size + grain - 1) / grain), [&](int task) {
      const std::size_t begin = static_cast<std::size_t>(task) * grain;
      for (std::size_t i = begin; i < std::min(size, begin + grain); ++i) evaluate(first + i, locals[i]);
    });
    for (std::size_t i = 0; i < size; ++i)
      if (!add(first + i, std::as_const(locals[i]))) return;
  }
}

}  // namespace supple::numerics
