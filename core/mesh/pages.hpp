// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>

#include "core/mesh/array.hpp"

namespace terrane {

/// Has the system put memory behind all pages of [begin, end) at once: a fifth cheaper than one after the other as they
/// are first written, if that happens soon, while they are in the cache. Does nothing where the system cannot.
void populate(void* begin, void* end);

/// The elements that arrays written side by side, from the front, may write before they ask again. Their memory is made
/// in steps that fit the cache.
inline std::size_t next_stop(std::size_t written, std::size_t size) {
  return std::min(size, written + std::clamp<std::size_t>(written, 64, 8192));
}
template <class T>
void populate(Array<T>& array, std::size_t begin, std::size_t end) {
  populate(array.data() + begin, array.data() + end);
}

}  // namespace terrane
