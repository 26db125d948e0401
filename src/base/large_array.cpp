#include "base/large_array.h"

#include <cstdint>
#include <cstdlib>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace kairos {

namespace {
constexpr size_t kCacheLine = 64, kLargePage = size_t{2} << 20;
/// Below this the part of the last page that nobody uses would be too large a share.
constexpr size_t kLeastForLargePages = 4 * kLargePage;
}  // namespace

void* allocate_large(size_t bytes) {
  const size_t alignment = bytes < kLeastForLargePages ? kCacheLine : kLargePage;
  if (bytes > static_cast<size_t>(PTRDIFF_MAX) - alignment) throw std::bad_alloc();
  void* const memory = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
  // Advice: where it is not taken, nothing is lost.
  if (alignment == kLargePage) static_cast<void>(madvise(memory, bytes, MADV_HUGEPAGE));
#endif
  return memory;
}

void free_large(void* memory) noexcept { std::free(memory); }

}  // namespace kairos
