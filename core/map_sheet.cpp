// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/map_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/picture/canvas.hpp"
#include "core/ticks.hpp"

namespace terrane {

namespace {

constexpr Colour ink{0.13, 0.14, 0.16};
constexpr int least_size = 200;

/// The parts of a sheet, in heights of a capital letter where nothing else is said.
struct Layout {
  double letter;  // pixels
  double margin = 1.2, gap = 2, bar = 1.7, tick = 0.6, label_gap = 0.6, foot = 4.2;
  double panel;  // pixels: all that is to the right of the map
  double px(double heights) const { return std::round(heights * letter); }
};

std::vector<std::pair<double, std::string>> labels_of(const SheetOptions& sheet, double bar_height, double letter) {
  const Ticks marks = ticks(sheet.low, sheet.high, std::clamp(bar_height / letter / 5, 2.0, 8.0));
  std::vector<std::pair<double, std::string>> labels;
  for (const double z : marks.at) labels.emplace_back(z, marks.label(z, sheet.signs));
  return labels;
}

Layout layout_of(const ShadeOptions& options, const SheetOptions& sheet) {
  Layout l;
  l.letter = std::clamp(options.size / 95.0, 6.0, 80.0);
  double widest = 0;
  for (const auto& [z, label] : labels_of(sheet, options.size, l.letter))
    widest = std::max(widest, text_width(label, l.letter));
  const double bar = l.px(l.bar) + l.px(l.tick) + l.px(l.label_gap) + widest;
  l.panel = l.px(l.gap) + std::max(bar, text_width(sheet.title, l.letter)) + l.px(l.margin);
  return l;
}

void copy(const Picture& from, Picture& to, int x, int y) {
  for (int j = 0; j < from.height; ++j)
    std::copy_n(from.rgba.begin() + static_cast<std::ptrdiff_t>(j) * from.width * 4, from.width * 4,
                to.rgba.begin() + (static_cast<std::ptrdiff_t>(j + y) * to.width + x) * 4);
}

class Sheet {
 public:
  Sheet(const Layout& layout, const SheetOptions& sheet, const ColourScale& colours, Picture& picture)
      : l_(layout), sheet_(sheet), colours_(colours), canvas_(picture), halo_(std::max(1.0, layout.letter / 6)) {}

  void colour_bar(int x, int y, int bottom) {
    canvas_.text(x, y + l_.letter, sheet_.title, l_.letter, ink, Anchor::left, halo_);
    const int wide = static_cast<int>(l_.px(l_.bar)), point = static_cast<int>(l_.px(1.1));
    const int top = y + static_cast<int>(l_.px(2.4)) + (sheet_.beyond_high ? point : 0);
    const int end = bottom - (sheet_.beyond_low ? point : 0), height = end - top;
    const double range = sheet_.high - sheet_.low;
    for (int j = top; j < end; ++j) {
      const double z = range > 0 ? sheet_.high - range * (j - top + 0.5) / height : sheet_.low;
      canvas_.fill(x, j, x + wide, j + 1, colours_(z));
    }
    if (sheet_.beyond_high) arrow(x, top, wide, -point, colours_(sheet_.high));
    if (sheet_.beyond_low) arrow(x, end, wide, point, colours_(sheet_.low));
    outline(x, top, wide, end, point);
    for (const auto& [z, label] : labels_of(sheet_, height, l_.letter)) {
      const double at = range > 0 ? top + (sheet_.high - z) / range * height : (top + end) / 2.0;
      const double mark = std::clamp(std::floor(at) + 0.5, top + 0.5, end - 0.5);
      const double from = x + wide, to = from + l_.px(l_.tick);
      canvas_.stroke({{{from, mark}, {to, mark}}}, line_width(), ink);
      canvas_.text(to + l_.px(l_.label_gap), mark + l_.letter / 2, label, l_.letter, ink, Anchor::left, halo_);
    }
  }

  /// `pixels_per_unit` of the ground. The bar is at most `room` long.
  void scale_bar(int x, int y, double room, double pixels_per_unit) {
    if (!(pixels_per_unit > 0) || !std::isfinite(pixels_per_unit)) return;
    double length = room / pixels_per_unit, unit = 1;
    std::string word = sheet_.ground_unit;
    if (word == "m" && length >= 1000) word = "km", unit = 1000;
    if (word == "m" && length < 0.1) word = "mm", unit = 0.001;
    if (word.starts_with("ft") && length >= 5280) word = "mi", unit = 5280;
    if (!(length / unit > 1e-12 && length / unit < 1e15)) return;
    const double shown = round_down(length / unit), width = std::round(shown * unit * pixels_per_unit);
    const double thick = std::max(3.0, std::round(l_.letter * 0.45)), half = std::round(width / 2);
    const int left = x, top = y, bottom = y + static_cast<int>(thick);
    canvas_.stroke({{{left + 0.0, top + thick / 2}, {left + width, top + thick / 2}}}, thick + 2 * halo_, {1, 1, 1},
                   0.85);
    canvas_.fill(left, top, left + static_cast<int>(half), bottom, ink);
    canvas_.fill(left + static_cast<int>(half), top, left + static_cast<int>(width), bottom, {1, 1, 1});
    const double w = line_width(), e = 0.5;
    canvas_.stroke({{{left + e, top + e},
                     {left + width - e, top + e},
                     {left + width - e, bottom - e},
                     {left + e, bottom - e},
                     {left + e, top + e}}},
                   w, ink);
    const Ticks number = ticks(0, shown, 2);
    const double base = bottom + l_.px(0.8) + l_.letter;
    canvas_.text(left, base, "0", l_.letter, ink, Anchor::left, halo_);
    canvas_.text(left + width, base, number.label(shown) + (word.empty() ? "" : " " + word), l_.letter, ink,
                 Anchor::middle, halo_);
  }

 private:
  double line_width() const { return std::max(1.0, std::round(l_.letter / 10)); }

  /// A triangle beyond an end of the bar.
  void arrow(int x, int base, int wide, int point, Colour colour) {
    const int steps = std::abs(point), way = point < 0 ? -1 : 1;
    for (int k = 0; k < steps; ++k) {
      const double half = wide / 2.0 * (1 - (k + 0.5) / steps), middle = x + wide / 2.0;
      const int row = way > 0 ? base + k : base - 1 - k;
      for (int i = x; i < x + wide; ++i) {
        const double inside = std::min(half - std::fabs(i + 0.5 - middle) + 0.5, 1.0);
        canvas_.blend(i, row, colour, std::max(0.0, inside));
      }
    }
  }

  void outline(double x, double top, double wide, double end, double point) {
    std::vector<Point2> line;
    line.push_back({x, end});
    line.push_back({x, top});
    if (sheet_.beyond_high) line.push_back({x + wide / 2, top - point});
    line.push_back({x + wide, top});
    line.push_back({x + wide, end});
    if (sheet_.beyond_low) line.push_back({x + wide / 2, end + point});
    line.push_back({x, end});
    canvas_.stroke({line}, line_width(), ink);
  }

  const Layout& l_;
  const SheetOptions& sheet_;
  const ColourScale& colours_;
  Canvas canvas_;
  double halo_;
};

}  // namespace

Picture map_sheet(const Tin& tin, const ShadeOptions& options, const SheetOptions& sheet, Context& context) {
  const Box box = bounds(tin);
  const double wide = (box.xmax - box.xmin) * options.x_factor, high = box.ymax - box.ymin;
  if (options.size < least_size || !(wide > 0 && high > 0)) return hillshade(tin, options, context);
  const Layout l = layout_of(options, sheet);
  const int margin = static_cast<int>(l.px(l.margin)), panel = static_cast<int>(std::ceil(l.panel));
  const int foot = static_cast<int>(l.px(sheet.ground_per_unit > 0 ? l.foot : l.margin));
  const double room_x = options.size - margin - panel, room_y = options.size - margin - foot;
  const double scale = std::min(room_x / wide, room_y / high);
  ShadeOptions map = options;
  map.size = std::max(1, static_cast<int>(std::floor(std::max(wide, high) * scale)));
  const Picture drawn = hillshade(tin, map, context);

  const int least_map = static_cast<int>(l.px(14));  // what the bars need, however thin the surface is
  Picture picture;
  picture.width = std::min(options.size, margin + std::max(drawn.width, least_map) + panel);
  picture.height = std::min(options.size, margin + std::max(drawn.height, least_map) + foot);
  picture.rgba.assign(static_cast<std::size_t>(picture.width) * picture.height * 4, 0);
  copy(drawn, picture, margin, margin);
  Sheet on(l, sheet, *options.colours, picture);
  const int right = picture.width - panel + static_cast<int>(l.px(l.gap)), floor = picture.height - foot;
  on.colour_bar(right, margin, std::min(floor, margin + std::max(least_map, static_cast<int>(l.px(44)))));
  if (sheet.ground_per_unit > 0)
    on.scale_bar(margin, floor + static_cast<int>(l.px(1.2)), std::max(0.35 * drawn.width, l.px(8)),
                 drawn.width / ((box.xmax - box.xmin) * sheet.ground_per_unit));
  return picture;
}

}  // namespace terrane
