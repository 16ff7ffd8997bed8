// Memory for large arrays that are read all over.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <new>
#include <utility>

namespace engine {

/// For std::vector of what is zero where all its bytes are: arrays of some megabytes and more lie on pages of
/// 2 MiB where the system has them to give. Why: rows of frames are read in the order of their exchanges,
/// each on another page, and with pages of 4 KiB the processor looks most of them up in memory first.
///
/// Memory comes zero from the system, and elements that are made without a value are not written again: they
/// are first touched by the threads that use them. A vector may therefore not shrink and grow again.
template <class T>
struct ZeroedLargePages {
  using value_type = T;

  ZeroedLargePages() = default;
  template <class U>
  ZeroedLargePages(const ZeroedLargePages<U>&) {}

  T* allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    if (bytes < kLarge) {
      if (void* memory = std::calloc(count, sizeof(T))) return static_cast<T*>(memory);
      throw std::bad_alloc();
    }
    void* memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
    (void)madvise(memory, bytes, MADV_HUGEPAGE);  // a wish: without it all is as before
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) {
    if (count * sizeof(T) < kLarge)
      std::free(memory);
    else
      munmap(memory, count * sizeof(T));
  }
  template <class U>
  void construct(U*) {}
  template <class U, class... Values>
  void construct(U* at, Values&&... values) {
    ::new (static_cast<void*>(at)) U(std::forward<Values>(values)...);
  }
  friend bool operator==(const ZeroedLargePages&, const ZeroedLargePages&) {
    return true;
  }

 private:
  static constexpr std::size_t kLarge = std::size_t{4} << 20;
};

}  // namespace engine
