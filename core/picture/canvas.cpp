// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/picture/canvas.hpp"

#include <algorithm>
#include <cmath>

#include "core/box.hpp"
#include "core/picture/lettering.hpp"

namespace terrane {

namespace {

constexpr Colour white{1, 1, 1};
constexpr double weight = 0.135;  // of a stroke of a letter, in heights of a capital

int bounded(double value, int most) { return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(most))); }

Box around(const std::vector<std::vector<Point2>>& lines, double margin) {
  Box box = no_box;
  for (const auto& line : lines)
    for (const Point2& p : line) box = around(box, p);
  return {box.xmin - margin, box.ymin - margin, box.xmax + margin, box.ymax + margin};
}

}  // namespace

Coverage::Coverage(const Box& box, int width, int height)
    : west_(bounded(std::floor(box.xmin), width)),
      north_(bounded(std::floor(box.ymin), height)),
      east_(bounded(std::ceil(box.xmax), width)),
      south_(bounded(std::ceil(box.ymax), height)),
      share_(static_cast<std::size_t>(std::max(0, east_ - west_)) * std::max(0, south_ - north_), 0) {}

void Coverage::add(Point2 a, Point2 b, double half_width) {
  const double reach = half_width + 0.5, dx = b.x - a.x, dy = b.y - a.y, squared = dx * dx + dy * dy;
  const auto most = static_cast<float>(std::min(1.0, 2 * half_width));
  const int first = std::max(north_, bounded(std::floor(std::min(a.y, b.y) - reach), south_));
  const int last = std::min(south_ - 1, bounded(std::ceil(std::max(a.y, b.y) + reach), south_));
  // Along a flat line a row holds a long stretch of it, along a steep one a few columns.
  const double lean = dy != 0 ? dx / dy : 0, spread = dy != 0 ? reach * std::sqrt(1 + lean * lean) : INFINITY;
  for (int j = first; j <= last; ++j) {
    const double y = j + 0.5, middle = a.x + (y - a.y) * lean;
    const double low = std::max(middle - spread, std::min(a.x, b.x) - reach);
    const double high = std::min(middle + spread, std::max(a.x, b.x) + reach);
    const int from = std::max(west_, bounded(std::floor(low - 0.5), east_));
    const int to = std::min(east_ - 1, bounded(std::ceil(high), east_));
    for (int i = from; i <= to; ++i) {
      const double x = i + 0.5;
      const double t = squared > 0 ? std::clamp(((x - a.x) * dx + (y - a.y) * dy) / squared, 0.0, 1.0) : 0;
      const double ex = x - a.x - t * dx, ey = y - a.y - t * dy, left = reach - std::sqrt(ex * ex + ey * ey);
      float& share = share_[static_cast<std::size_t>(j - north_) * (east_ - west_) + (i - west_)];
      share = std::max(share, std::clamp(static_cast<float>(left), 0.0f, most));
    }
  }
}

void Coverage::paint(Canvas& canvas, Colour colour, double alpha) const {
  const float* share = share_.data();
  for (int j = north_; j < south_; ++j)
    for (int i = west_; i < east_; ++i, ++share)
      if (*share > 0) canvas.blend(i, j, colour, alpha * *share);
}

void Canvas::blend(int column, int row, Colour colour, double alpha) {
  if (column < 0 || row < 0 || column >= picture_.width || row >= picture_.height || !(alpha > 0)) return;
  std::uint8_t* to = picture_.rgba.data() + (static_cast<std::size_t>(row) * picture_.width + column) * 4;
  const double under = to[3] / 255.0 * (1 - alpha), whole = alpha + under;
  const auto mixed = [&](std::uint8_t below, double above) {
    const double value = (above * alpha * 255 + below * under) / whole;
    return static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0) + 0.5);
  };
  to[0] = mixed(to[0], colour.r);
  to[1] = mixed(to[1], colour.g);
  to[2] = mixed(to[2], colour.b);
  to[3] = static_cast<std::uint8_t>(std::clamp(whole, 0.0, 1.0) * 255 + 0.5);
}

void Canvas::fill(int x0, int y0, int x1, int y1, Colour colour, double alpha) {
  for (int j = std::max(0, y0); j < std::min(y1, picture_.height); ++j)
    for (int i = std::max(0, x0); i < std::min(x1, picture_.width); ++i) blend(i, j, colour, alpha);
}

void Canvas::stroke(const std::vector<std::vector<Point2>>& lines, double width, Colour colour, double alpha) {
  Coverage coverage(around(lines, width / 2 + 1), picture_.width, picture_.height);
  for (const auto& line : lines) {
    if (line.size() == 1) coverage.add(line[0], line[0], width / 2);
    for (std::size_t k = 0; k + 1 < line.size(); ++k) coverage.add(line[k], line[k + 1], width / 2);
  }
  coverage.paint(*this, colour, alpha);
}

void Canvas::text(double x, double y, std::string_view text, double size, Colour colour, Anchor anchor, double halo) {
  const double width = text_width(text, size);
  const double left = std::round(anchor == Anchor::left ? x : anchor == Anchor::right ? x - width : x - width / 2);
  const double base = std::round(y);
  std::vector<std::vector<Point2>> lines = lettering(text).strokes;
  for (auto& line : lines)
    for (Point2& p : line) p = {left + p.x * size, base - p.y * size};
  const double thick = std::max(1.0, weight * size);
  if (halo > 0) stroke(lines, thick + 2 * halo, white, 0.85);
  stroke(lines, thick, colour);
}

double text_width(std::string_view text, double size) { return lettering(text).width * size; }

}  // namespace terrane
