// Arrays of many megabytes: not filled before they are written to, and on large pages where the system has them.
#pragma once

#include <cstddef>
#include <new>
#include <utility>
#include <vector>

namespace kairos {

/// Memory aligned to a cache line at least. From a few megabytes on it asks for pages of two megabytes, which take
/// fewer faults to make and fewer entries of the processor's tables to look up. Throws std::bad_alloc.
void* allocate_large(size_t bytes);
void free_large(void* memory) noexcept;

/// Leaves elements that are made by resize() without a value: whoever resizes writes them, in parallel if he likes.
template <class T>
struct LargeAllocator {
  using value_type = T;

  LargeAllocator() = default;
  template <class U>
  LargeAllocator(const LargeAllocator<U>&) {}  // NOLINT(google-explicit-constructor): allocators convert

  T* allocate(size_t count) {
    if (count > static_cast<size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
    return static_cast<T*>(allocate_large(count * sizeof(T)));
  }
  void deallocate(T* memory, size_t) noexcept { free_large(memory); }

  template <class U>
  void construct(U* element) {
    ::new (static_cast<void*>(element)) U;
  }
  template <class U, class... Arguments>
  void construct(U* element, Arguments&&... arguments) {
    ::new (static_cast<void*>(element)) U(std::forward<Arguments>(arguments)...);
  }
  friend bool operator==(const LargeAllocator&, const LargeAllocator&) { return true; }
};

template <class T>
using LargeArray = std::vector<T, LargeAllocator<T>>;

}  // namespace kairos
