// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/plan/region_cells.hpp"

#include <algorithm>
#include <cmath>

namespace terrane {
namespace {

constexpr double margin = 1e-2;  // in cells: more than coordinates lose when they are turned into cells

}  // namespace

RegionCells::RegionCells(const PlanRegion& region, const Box& within, std::size_t cells) {
  const Box whole = bounds(region.tin);
  const Box box = {std::max(whole.xmin, within.xmin), std::max(whole.ymin, within.ymin),
                   std::min(whole.xmax, within.xmax), std::min(whole.ymax, within.ymax)};
  const double width = box.xmax - box.xmin, height = box.ymax - box.ymin;
  const double largest = std::max({std::fabs(box.xmin), std::fabs(box.xmax), std::fabs(box.ymin), std::fabs(box.ymax)});
  const double wanted = static_cast<double>(std::clamp<std::size_t>(cells, 64, 4'000'000));
  // No side has more than a few thousand cells, and none is so small that doubles cannot tell where it begins.
  cell_ = std::max(
      {std::sqrt(width) * std::sqrt(height / wanted), std::max(width, height) / 4096, 1e-11 * largest, 1e-290});
  box_ = {box.xmin - 2 * cell_, box.ymin - 2 * cell_, box.xmax + 2 * cell_, box.ymax + 2 * cell_};
  columns_ = static_cast<int>(std::ceil((box_.xmax - box_.xmin) / cell_));
  rows_ = static_cast<int>(std::ceil((box_.ymax - box_.ymin) / cell_));
  inside_.assign(static_cast<std::size_t>(columns_) * rows_, 0);
  marked_.assign((static_cast<std::size_t>(columns_) + 1) * (rows_ + 1), 0);
  for (const auto& [p, q] : region.border) mark(p, q);
  count_marks();
  label(region);
}

int RegionCells::column(double x) const {
  return static_cast<int>(std::clamp(std::floor((x - box_.xmin) / cell_), 0.0, columns_ - 1.0));
}

int RegionCells::row(double y) const {
  return static_cast<int>(std::clamp(std::floor((y - box_.ymin) / cell_), 0.0, rows_ - 1.0));
}

/// Every cell that the edge touches.
void RegionCells::mark(Point2 p, Point2 q) {
  if (p.y > q.y) std::swap(p, q);
  if (q.y < box_.ymin - cell_ || p.y > box_.ymax + cell_) return;
  const int r0 = row(p.y - margin * cell_), r1 = row(q.y + margin * cell_);
  const double rise = q.y - p.y;
  for (int r = r0; r <= r1; ++r) {
    const auto x_at = [&](double y) { return p.x + (q.x - p.x) * std::clamp((y - p.y) / rise, 0.0, 1.0); };
    double a = p.x, b = q.x;
    if (r0 != r1 && rise > 0)
      a = x_at(box_.ymin + (r - margin) * cell_), b = x_at(box_.ymin + (r + 1 + margin) * cell_);
    if (a > b) std::swap(a, b);
    if (b < box_.xmin - cell_ || a > box_.xmax + cell_) continue;
    const int c0 = column(a - margin * cell_), c1 = column(b + margin * cell_);
    for (int c = c0; c <= c1; ++c) marked_[(static_cast<std::size_t>(r) + 1) * (columns_ + 1) + c + 1] = 1;
  }
}

void RegionCells::count_marks() {
  const std::size_t stride = static_cast<std::size_t>(columns_) + 1;
  for (int r = 1; r <= rows_; ++r) {
    std::uint32_t sum = 0;
    for (int c = 1; c <= columns_; ++c) {
      sum += marked_[r * stride + c];
      marked_[r * stride + c] = marked_[(r - 1) * stride + c] + sum;
    }
  }
}

/// By the parity of the edges to the left of the centre of a cell. Where the border is within half a cell of it that
/// may be wrong, and is never asked for.
void RegionCells::label(const PlanRegion& region) {
  for (const auto& edge : region.border) {
    const Point2 p = edge[0].y <= edge[1].y ? edge[0] : edge[1], q = edge[0].y <= edge[1].y ? edge[1] : edge[0];
    const int r1 = row(q.y);
    for (int r = row(p.y); r <= r1; ++r) {
      const double y = box_.ymin + (r + 0.5) * cell_;
      if ((p.y <= y) == (q.y <= y)) continue;
      const double x = p.x + (q.x - p.x) * ((y - p.y) / (q.y - p.y));
      const double beyond = std::ceil((x - box_.xmin) / cell_ - 0.5);
      if (beyond < columns_)
        inside_[static_cast<std::size_t>(r) * columns_ + static_cast<int>(std::max(beyond, 0.0))] ^= 1;
    }
  }
  for (int r = 0; r < rows_; ++r) {
    std::uint8_t* row = &inside_[static_cast<std::size_t>(r) * columns_];
    for (int c = 1; c < columns_; ++c) row[c] ^= row[c - 1];
  }
}

RegionCells::Where RegionCells::operator()(const Box& box) const {
  if (box.xmax < box_.xmin || box.xmin > box_.xmax || box.ymax < box_.ymin || box.ymin > box_.ymax)
    return Where::outside;
  const int c0 = column(box.xmin), c1 = column(box.xmax) + 1, r0 = row(box.ymin), r1 = row(box.ymax) + 1;
  const std::size_t stride = static_cast<std::size_t>(columns_) + 1;
  const auto below = [&](int r, int c) { return marked_[r * stride + c]; };
  if (below(r1, c1) - below(r0, c1) - below(r1, c0) + below(r0, c0) != 0) return Where::near;
  return inside_[static_cast<std::size_t>(r0) * columns_ + c0] ? Where::inside : Where::outside;
}

}  // namespace terrane
