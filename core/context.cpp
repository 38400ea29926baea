// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/context.hpp"

#include "core/error.hpp"

namespace terrane {

void Context::stop_if_cancelled() const {
  if (cancelled.load(std::memory_order_relaxed)) throw Error(ErrorKind::cancelled, "cancelled", "cancelled");
}

void Context::progress(std::string_view stage, double fraction) {
  stop_if_cancelled();
  if (on_progress) on_progress(stage, fraction);
}

}  // namespace terrane
