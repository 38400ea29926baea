// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace terrane {

/// Memory in pages of 2 MiB where the system has them and is asked (core/mesh/pages); it has to be given back with
/// std::free. Throws std::bad_alloc.
void* large_pages(std::size_t bytes);
inline constexpr std::size_t large_page = std::size_t{1} << 21;

/// For the big arrays of a computation. Leaves new elements uninitialised: they are about to be written, and the first
/// touch of their memory costs as much as most of what is computed on them, less in large pages.
template <class T>
struct UninitialisedAllocator : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = UninitialisedAllocator<U>;
  };
  using std::allocator<T>::allocator;
  T* allocate(std::size_t n) {
    return in_large_pages(n) ? static_cast<T*>(large_pages(n * sizeof(T))) : std::allocator<T>::allocate(n);
  }
  void deallocate(T* place, std::size_t n) {
    in_large_pages(n) ? std::free(place) : std::allocator<T>::deallocate(place, n);
  }
  /// Not small ones, beside which the space lost to alignment counts; nor the largest: on a virtual machine that gives
  /// free memory back to its host every large page is asked for there again, which at a gigabyte cost more than was
  /// saved.
  static bool in_large_pages(std::size_t n) {
    return n >= 4 * large_page / sizeof(T) && n <= 32 * large_page / sizeof(T);
  }
  template <class U>
  void construct(U* place) {
    if constexpr (!std::is_trivially_copyable_v<U>) ::new (static_cast<void*>(place)) U;  // else not even zero
  }
  template <class U, class... Arguments>
  void construct(U* place, Arguments&&... arguments) {
    ::new (static_cast<void*>(place)) U(std::forward<Arguments>(arguments)...);
  }
};

/// std::vector in every respect but one: resize() leaves new numbers and places uninitialised.
template <class T>
using Array = std::vector<T, UninitialisedAllocator<T>>;

}  // namespace terrane
