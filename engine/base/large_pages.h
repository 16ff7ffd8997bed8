// Memory for large arrays that are read all over.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace engine {

/// For std::vector: arrays of some megabytes and more lie on pages of 2 MiB where the system has them to
/// give. Why: rows of frames are read in the order of their exchanges, each on another page, and with pages
/// of 4 KiB the processor looks most of them up in memory first; and a page is cleared and mapped once for
/// 512 of them.
template <class T>
struct LargePageAllocator {
  using value_type = T;

  LargePageAllocator() = default;
  template <class U>
  LargePageAllocator(const LargePageAllocator<U>&) {}

  T* allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    if (bytes < kLarge) return static_cast<T*>(::operator new(bytes));
    void* memory = std::aligned_alloc(kPage, (bytes + kPage - 1) / kPage * kPage);
    if (!memory) throw std::bad_alloc();
#if defined(__linux__)
    (void)madvise(memory, bytes, MADV_HUGEPAGE);  // a wish: without it all is as before
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) {
    if (count * sizeof(T) < kLarge)
      ::operator delete(memory);
    else
      std::free(memory);
  }
  friend bool operator==(const LargePageAllocator&, const LargePageAllocator&) {
    return true;
  }

 private:
  static constexpr std::size_t kPage = std::size_t{2} << 20, kLarge = 2 * kPage;
};

}  // namespace engine
