// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/side_by_side.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <utility>

#include "core/parallel.hpp"

namespace terrane {

void side_by_side(const std::vector<double>& weights, Context& context,
                  const std::function<void(std::size_t, Context&)>& work) {
  const double all = std::accumulate(weights.begin(), weights.end(), 1.0);
  std::vector<std::vector<Warning>> warnings(weights.size());
  std::mutex one_at_a_time;
  parallel_tasks(context, weights.size(), [&](std::size_t i) {
    Context own;
    own.threads = std::max(1, static_cast<int>(std::lround(context.threads * weights[i] / all)));
    own.on_progress = [&](std::string_view stage, double fraction) {
      const std::lock_guard lock(one_at_a_time);
      context.progress(stage, fraction);
    };
    work(i, own);
    warnings[i] = std::move(own.warnings);
  });
  for (std::vector<Warning>& of_one : warnings)
    for (Warning& warning : of_one) context.warn(std::move(warning));
}

}  // namespace terrane
