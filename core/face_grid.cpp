// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/face_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/predicates.hpp"
#include "core/triangle_height.hpp"

namespace terrane {

namespace {

constexpr double faces_per_cell = 2;

int cell_of(double value, double low, double side, int count) {
  const double cell = (value - low) / side;
  return !(cell > 0) ? 0 : cell < count - 1 ? static_cast<int>(cell) : count - 1;
}

/// How many cells of that side along an extent: one where either is not finite.
int cells_along(double extent, double side) {
  const double count = extent / side;
  return !std::isfinite(count) || count < 1 ? 1 : static_cast<int>(std::min(count, 8192.0));
}

/// The x-range of a closed ring of corners within a horizontal strip.
std::pair<double, double> strip_range(const Point2* corners, int count, double ylow, double yhigh) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const auto take = [&](double x) { low = std::min(low, x), high = std::max(high, x); };
  for (int k = 0; k < count; ++k) {
    const Point2 p = corners[k], q = corners[(k + 1) % count];
    if (p.y >= ylow && p.y <= yhigh) take(p.x);
    for (const double y : {ylow, yhigh})
      if ((p.y < y) != (q.y < y)) take(p.x + (q.x - p.x) * ((y - p.y) / (q.y - p.y)));
  }
  return {low, high};
}

std::array<Point2, 3> corners_of(const Tin& tin, const Face& f) {
  return {plan(tin.vertices[f[0]]), plan(tin.vertices[f[1]]), plan(tin.vertices[f[2]])};
}

}  // namespace

int FaceGrid::column_of(double x) const { return cell_of(x, box_.xmin, cell_x_, columns_); }
int FaceGrid::row_of(double y) const { return cell_of(y, box_.ymin, cell_y_, rows_); }

/// The cells that a triangle or a segment lies in: those of its box, or, where that has many, those of its part in
/// each row.
template <class Visit>
void FaceGrid::visit_cells(const Point2* corners, int count, Visit visit) const {
  Box box{corners[0].x, corners[0].y, corners[0].x, corners[0].y};
  for (int k = 1; k < count; ++k) {
    box.xmin = std::min(box.xmin, corners[k].x), box.xmax = std::max(box.xmax, corners[k].x);
    box.ymin = std::min(box.ymin, corners[k].y), box.ymax = std::max(box.ymax, corners[k].y);
  }
  if (box.xmax < box_.xmin || box.xmin > box_.xmax || box.ymax < box_.ymin || box.ymin > box_.ymax) return;
  const int south = row_of(box.ymin), north = row_of(box.ymax);
  const int west = column_of(box.xmin), east = column_of(box.xmax);
  const bool whole = north - south < 2 || east - west < 2;
  for (int r = south; r <= north; ++r) {
    int from = west, to = east;
    if (!whole) {
      // The outer rows hold whatever lies beyond them, too.
      const double low = r == 0 ? -std::numeric_limits<double>::infinity() : box_.ymin + r * cell_y_ - margin_y_;
      const double high =
          r == rows_ - 1 ? std::numeric_limits<double>::infinity() : box_.ymin + (r + 1) * cell_y_ + margin_y_;
      const auto [xlow, xhigh] = strip_range(corners, count, std::max(low, box.ymin), std::min(high, box.ymax));
      if (xlow > xhigh) continue;
      from = std::max(west, column_of(xlow - margin_x_)), to = std::min(east, column_of(xhigh + margin_x_));
    }
    for (int c = from; c <= to; ++c) visit(static_cast<std::size_t>(r) * columns_ + c);
  }
}

FaceGrid::FaceGrid(const Tin& tin) : tin_(tin), box_(bounds(tin)) {
  const double width = std::max(box_.xmax - box_.xmin, 0.0), height = std::max(box_.ymax - box_.ymin, 0.0);
  const double cells = std::max(1.0, static_cast<double>(tin.faces.size()) / faces_per_cell);
  const double side = std::sqrt(std::max(width * height, 1e-300) / cells);
  columns_ = cells_along(width, side);
  rows_ = cells_along(height, side);
  cell_x_ = width > 0 ? width / columns_ : 1;
  cell_y_ = height > 0 ? height / rows_ : 1;
  constexpr double ulp = std::numeric_limits<double>::epsilon();
  margin_x_ = 1e-9 * cell_x_ + 8 * ulp * std::max(std::fabs(box_.xmin), std::fabs(box_.xmax));
  margin_y_ = 1e-9 * cell_y_ + 8 * ulp * std::max(std::fabs(box_.ymin), std::fabs(box_.ymax));

  first_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
  const auto each = [&](auto visit) {
    for (std::size_t f = 0; f < tin.faces.size(); ++f) {
      const std::array<Point2, 3> c = corners_of(tin, tin.faces[f]);
      if (orientation(c[0], c[1], c[2]) > 0) visit_cells(c.data(), 3, [&](std::size_t cell) { visit(cell, f); });
    }
  };
  each([&](std::size_t cell, std::size_t) { ++first_[cell + 1]; });
  for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
  faces_.resize(first_.back());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  each([&](std::size_t cell, std::size_t f) { faces_[next[cell]++] = static_cast<Index>(f); });
}

template <class Visit>
void FaceGrid::visit_holding(Point2 place, Visit visit) const {
  if (!(place.x >= box_.xmin && place.x <= box_.xmax && place.y >= box_.ymin && place.y <= box_.ymax)) return;
  const std::size_t cell = static_cast<std::size_t>(row_of(place.y)) * columns_ + column_of(place.x);
  for (std::size_t k = first_[cell]; k < first_[cell + 1]; ++k) {
    const std::array<Point2, 3> c = corners_of(tin_, tin_.faces[faces_[k]]);
    if (orientation(c[0], c[1], place) >= 0 && orientation(c[1], c[2], place) >= 0 &&
        orientation(c[2], c[0], place) >= 0)
      visit(faces_[k], c);
  }
}

std::optional<double> FaceGrid::height(Point2 place) const {
  std::optional<double> highest;
  visit_holding(place, [&](Index face, const std::array<Point2, 3>& c) {
    const Face& f = tin_.faces[face];
    const double z[3] = {tin_.vertices[f[0]].z, tin_.vertices[f[1]].z, tin_.vertices[f[2]].z};
    const double height = height_on_triangle({c[0], c[1], c[2]}, z, place);
    if (!highest || height > *highest) highest = height;
  });
  return highest;
}

Index FaceGrid::face(Point2 place) const {
  Index first = none;
  visit_holding(place, [&](Index face, const auto&) {
    if (first == none || face < first) first = face;
  });
  return first;
}

std::vector<Index> FaceGrid::along(Point2 a, Point2 b) const {
  std::vector<Index> found;
  const Point2 ends[2] = {a, b};
  visit_cells(ends, 2, [&](std::size_t cell) {
    found.insert(found.end(), faces_.begin() + static_cast<std::ptrdiff_t>(first_[cell]),
                 faces_.begin() + static_cast<std::ptrdiff_t>(first_[cell + 1]));
  });
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace terrane
