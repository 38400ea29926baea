// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <new>
#include <utility>
#include <vector>

namespace terrane {

/// Memory for the big arrays of one computation. Asks for large pages, because the first touch of a small page costs
/// more than most of what we compute on it, and leaves new elements uninitialised, because they are about to be
/// written.
template <class T>
struct PageAllocator {
  using value_type = T;
  static constexpr std::size_t page = std::size_t{2} << 20, big = 2 * page;

  PageAllocator() = default;
  template <class U>
  PageAllocator(const PageAllocator<U>&) {}
  bool operator==(const PageAllocator&) const { return true; }

  T* allocate(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / 2 / sizeof(T)) throw std::bad_alloc();
    const std::size_t bytes = count * sizeof(T);
    if (bytes < big) return static_cast<T*>(::operator new(bytes));
    const std::size_t whole = (bytes + page - 1) / page * page;
    void* memory = std::aligned_alloc(page, whole);
    if (!memory) throw std::bad_alloc();
    madvise(memory, whole, MADV_HUGEPAGE);  // a wish: nothing depends on whether it is granted
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) {
    if (count * sizeof(T) < big)
      ::operator delete(memory);
    else
      std::free(memory);
  }
  template <class U>
  void construct(U* place) {
    ::new (static_cast<void*>(place)) U;
  }
  template <class U, class... Arguments>
  void construct(U* place, Arguments&&... arguments) {
    ::new (static_cast<void*>(place)) U(std::forward<Arguments>(arguments)...);
  }
};

/// std::vector in every respect but two: resize() does not initialise plain numbers, and big ones lie in large pages.
template <class T>
using Array = std::vector<T, PageAllocator<T>>;

}  // namespace terrane
