// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace terrane {

/// Leaves new elements uninitialised: the big arrays of a computation are about to be written, and the first touch of
/// their memory costs as much as most of what is computed on them.
template <class T>
struct UninitialisedAllocator : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = UninitialisedAllocator<U>;
  };
  using std::allocator<T>::allocator;
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
