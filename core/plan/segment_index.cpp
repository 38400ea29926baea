// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/plan/segment_index.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/box.hpp"

namespace terrane {

SegmentIndex::SegmentIndex(std::vector<std::array<Point2, 2>> segments, double reach) : segments_(std::move(segments)) {
  Box box = no_box;
  double length = 0;
  for (const auto& [p, q] : segments_) {
    box = around(around(box, p), q);
    length += std::hypot(q.x - p.x, q.y - p.y);
  }
  if (segments_.empty()) return;
  origin_ = {box.xmin, box.ymin};
  size_ = std::max({length / static_cast<double>(segments_.size()), reach,
                    1e-9 * std::max(box.xmax - box.xmin, box.ymax - box.ymin)});
  if (!(size_ > 0)) size_ = 1;
  for (Index i = 0; i < static_cast<Index>(segments_.size()); ++i) {
    Point2 p = segments_[i][0], q = segments_[i][1];
    if (p.y > q.y) std::swap(p, q);
    // Row by row, the columns the segment passes there, a little widened against rounding.
    for (std::int64_t row = at(p.y, origin_.y); row <= at(q.y, origin_.y); ++row) {
      const double low = origin_.y + size_ * static_cast<double>(row), high = low + size_;
      const auto x = [&](double y) {
        return q.y > p.y ? p.x + (q.x - p.x) * std::clamp((y - p.y) / (q.y - p.y), 0.0, 1.0) : p.x;
      };
      const double x0 = q.y > p.y ? x(low) : p.x, x1 = q.y > p.y ? x(high) : q.x;
      const double slack = 1e-6 * size_;
      for (std::int64_t c = at(std::min(x0, x1) - slack, origin_.x); c <= at(std::max(x0, x1) + slack, origin_.x); ++c)
        cells_[cell(c, row)].push_back(i);
    }
  }
}

std::int64_t SegmentIndex::at(double v, double origin) const {
  return static_cast<std::int64_t>(std::floor(std::clamp((v - origin) / size_, -4e18, 4e18)));
}

void SegmentIndex::near(const Box& box, std::vector<Index>& found) const {
  found.clear();
  if (cells_.empty()) return;
  const double slack = 1e-6 * size_;
  if (!((box.xmax - box.xmin) / size_ * ((box.ymax - box.ymin) / size_) < static_cast<double>(segments_.size()))) {
    found.resize(segments_.size());  // larger than all cells together
    std::iota(found.begin(), found.end(), 0);
  } else {
    for (std::int64_t row = at(box.ymin - slack, origin_.y); row <= at(box.ymax + slack, origin_.y); ++row)
      for (std::int64_t c = at(box.xmin - slack, origin_.x); c <= at(box.xmax + slack, origin_.x); ++c)
        if (const auto it = cells_.find(cell(c, row)); it != cells_.end())
          found.insert(found.end(), it->second.begin(), it->second.end());
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  std::erase_if(found, [&](Index i) {
    const auto& [p, q] = segments_[i];
    return std::max(p.x, q.x) < box.xmin || std::min(p.x, q.x) > box.xmax || std::max(p.y, q.y) < box.ymin ||
           std::min(p.y, q.y) > box.ymax;
  });
}

}  // namespace terrane
