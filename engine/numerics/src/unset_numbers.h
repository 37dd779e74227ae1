#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace supple::numerics {

/// An allocator that does not initialize values when a vector grows.
template <class Value>
struct UnsetAllocator : std::allocator<Value> {
  template <class Other>
  struct rebind {
    using other = UnsetAllocator<Other>;
  };
  void construct(Value* address) noexcept { ::new (static_cast<void*>(address)) Value; }
  template <class... Arguments>
  void construct(Value* address, Arguments&&... arguments) {
    std::construct_at(address, std::forward<Arguments>(arguments)...);
  }
};

/// Numbers that are uninitialized after `resize`. Zeroing a gigabyte takes most of a second, during which nobody checks
/// for a stop request. Uninitialized memory is first touched by the code that writes to it.
using UnsetNumbers = std::vector<double, UnsetAllocator<double>>;

/// Resizes the vector without copying: its old values are lost and the new ones uninitialized.
inline void discard_and_resize(UnsetNumbers& numbers, std::size_t size) {
  numbers.clear();
  numbers.resize(size);
}

}  // namespace supple::numerics
