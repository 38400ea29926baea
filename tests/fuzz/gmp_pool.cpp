// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmp.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>

// Exact numbers ask for a few limbs millions of times, and each time the sanitizer notes who asked. What GMP does
// inside its numbers is not what we look for, so small ones are handed on: a third of the time of an execution.
namespace {

constexpr std::size_t classes = 16, step = 32;  // bytes; up to 512
thread_local void* unused[classes + 1] = {};

std::size_t class_of(std::size_t bytes) { return bytes == 0 ? 1 : (bytes + step - 1) / step; }

void* take(std::size_t bytes) {
  const std::size_t c = class_of(bytes);
  if (c > classes) return std::malloc(bytes);
  void* block = unused[c];
  if (block == nullptr) return std::malloc(c * step);
  std::memcpy(&unused[c], block, sizeof(void*));
  return block;
}

void put_back(void* block, std::size_t bytes) {
  const std::size_t c = class_of(bytes);
  if (c > classes) return std::free(block);
  std::memcpy(block, &unused[c], sizeof(void*));
  unused[c] = block;
}

void* resized(void* block, std::size_t before, std::size_t after) {
  if (class_of(before) == class_of(after) && class_of(after) <= classes) return block;
  void* moved = take(after);
  std::memcpy(moved, block, before < after ? before : after);
  put_back(block, before);
  return moved;
}

[[maybe_unused]] const bool installed = (mp_set_memory_functions(take, resized, put_back), true);

}  // namespace
