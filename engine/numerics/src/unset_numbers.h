#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace supple::numerics {

/// Makes room for a vector's values without setting them.
template <class Value>
struct UnsetAllocator : std::allocator<Value> {
  template <class Other>
  struct rebind {
    using other = UnsetAllocator<Other>;
  };
  void construct(Value* at) noexcept { ::new (static_cast<void*>(at)) Value; }
  template <class... Arguments>
  void construct(Value* at, Arguments&&... arguments) {
    std::construct_at(at, std::forward<Arguments>(arguments)...);
  }
};

/// Numbers that a larger size leaves unset. Zeroing a gigabyte takes most of a second, in which nobody looks for a stop
/// request; here whoever writes to a page first is the first to touch it.
using UnsetNumbers = std::vector<double, UnsetAllocator<double>>;

/// Room for so many numbers; those that were there are lost.
inline void make_room(UnsetNumbers& numbers, std::size_t size) {
  numbers.clear();
  numbers.resize(size);
}

}  // namespace supple::numerics
