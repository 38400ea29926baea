// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/pages.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>

namespace terrane {

void populate(void* begin, void* end) {
#ifdef MADV_POPULATE_WRITE
  static const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const std::uintptr_t first = (reinterpret_cast<std::uintptr_t>(begin) + page - 1) / page * page;
  const std::uintptr_t last = reinterpret_cast<std::uintptr_t>(end) / page * page;
  if (last > first) madvise(reinterpret_cast<void*>(first), last - first, MADV_POPULATE_WRITE);
#endif
}

}  // namespace terrane
