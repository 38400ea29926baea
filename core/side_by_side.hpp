// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "core/context.hpp"

namespace terrane {

/// Calls work(i, own) for i = 0 ... weights.size() - 1, several at a time, each with a context of its own that has of
/// the threads what it has of the weight. Progress is passed on; warnings are given in order; of what is thrown the
/// first in order is.
void side_by_side(const std::vector<double>& weights, Context& context,
                  const std::function<void(std::size_t, Context&)>& work);

}  // namespace terrane
