// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/profile_chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/picture/canvas.hpp"
#include "core/ticks.hpp"

namespace terrane {

namespace {

constexpr Colour ink{0.15, 0.16, 0.18}, quiet{0.40, 0.42, 0.45}, grid{0.90, 0.91, 0.92};
// Told apart by the eye, by most colour-blind eyes, and in print.
constexpr Colour hues[] = {{0.12, 0.38, 0.66}, {0.86, 0.39, 0.08}, {0.13, 0.55, 0.36}, {0.62, 0.22, 0.52},
                           {0.66, 0.54, 0.06}, {0.25, 0.66, 0.76}, {0.75, 0.16, 0.22}, {0.42, 0.42, 0.46}};

struct Range {
  double low = INFINITY, high = -INFINITY;
  double size() const { return high - low; }
};

Range heights_of(const Section& section) {
  Range range;
  for (const double z : section.z)
    if (!std::isnan(z)) range = {std::min(range.low, z), std::max(range.high, z)};
  return range;
}

/// With room above and below the lines.
Range padded(Range r) {
  if (!(r.low <= r.high)) return {0, 1};
  const double room = r.size() > 0 ? 0.07 * r.size() : std::max(1.0, std::fabs(r.low) * 1e-3);
  return {r.low - room, r.high + room};
}

/// Unit and factor that a distance is written with.
struct Written {
  std::string unit;
  double factor = 1;
};

Written written(double length, const std::string& unit) {
  if (unit == "m" && length >= 5000) return {"km", 1000};
  if (unit.starts_with("ft") && length >= 5 * 5280) return {"mi", 5280};
  return {unit, 1};
}

std::string with_unit(const std::string& text, const std::string& unit) {
  return unit.empty() ? text : text + " (" + unit + ")";
}

/// One panel: where its axes lie and what they span.
class Panel {
 public:
  Panel(Canvas& canvas, const ChartPanel& panel, const ChartOptions& options, double letter, int top, int bottom)
      : canvas_(canvas), panel_(panel), options_(options), letter_(letter), top_(top), bottom_(bottom) {
    heights_ = padded(heights_of(*panel.section));
    length_ = panel.distance.empty() ? 1 : std::max(panel.distance.back(), 1e-300);
    unit_ = written(length_, options.length_unit);
    z_ticks_ = ticks(heights_.low, heights_.high, std::clamp((bottom - top) / letter / 4.5, 2.0, 9.0));
    double widest = 0;
    for (const double z : z_ticks_.at) widest = std::max(widest, text_width(z_ticks_.label(z), letter));
    left_ = static_cast<int>(widest + 2.6 * letter);
    right_ = canvas.width() - static_cast<int>(2.2 * letter);
  }

  void draw() {
    grid_lines();
    if (panel_.section->surfaces == 1) shade();
    for (std::size_t s = 0; s < panel_.section->surfaces; ++s)
      canvas_.stroke(runs(s), std::max(1.4, letter_ * 0.19), hues[s % std::size(hues)]);
    const double w = line_width();
    canvas_.stroke({{{left_ + 0.5, top_ + 0.5}, {left_ + 0.5, bottom_ + 0.5}, {right_ + 0.5, bottom_ + 0.5}}}, w, ink);
    canvas_.text(left_, top_ - 0.9 * letter_, with_unit("Height", options_.height_unit), letter_, quiet);
    const double base = bottom_ + 4.6 * letter_;
    canvas_.text((left_ + right_) / 2.0, base, with_unit("Distance", unit_.unit), letter_, quiet, Anchor::middle);
    if (!panel_.title.empty())
      canvas_.text(left_ + letter_, top_ + 1.8 * letter_, panel_.title, letter_, ink, Anchor::left, letter_ / 5);
    exaggeration(base);
  }

 private:
  double x_of(double distance) const { return left_ + 0.5 + distance / length_ * (right_ - left_); }
  double y_of(double z) const { return bottom_ + 0.5 - (z - heights_.low) / heights_.size() * (bottom_ - top_); }
  double line_width() const { return std::max(1.0, std::round(letter_ / 11)); }

  void grid_lines() {
    const double w = line_width();
    for (const double z : z_ticks_.at) {
      const double y = std::floor(y_of(z)) + 0.5;
      canvas_.stroke({{{left_ + 0.5, y}, {right_ + 0.5, y}}}, w, grid);
      canvas_.stroke({{{left_ + 0.5 - 0.5 * letter_, y}, {left_ + 0.5, y}}}, w, ink);
      canvas_.text(left_ - 0.9 * letter_, y + letter_ / 2, z_ticks_.label(z), letter_, ink, Anchor::right);
    }
    const Ticks marks = ticks(0, length_ / unit_.factor, std::clamp((right_ - left_) / letter_ / 9, 2.0, 10.0));
    for (const double d : marks.at) {
      const double x = std::floor(x_of(d * unit_.factor)) + 0.5;
      canvas_.stroke({{{x, top_ + 0.5}, {x, bottom_ + 0.5}}}, w, grid);
      canvas_.stroke({{{x, bottom_ + 0.5}, {x, bottom_ + 0.5 + 0.5 * letter_}}}, w, ink);
      canvas_.text(x, bottom_ + 2.2 * letter_, marks.label(d), letter_, ink, Anchor::middle);
    }
    // The corners of the line.
    std::vector<std::vector<Point2>> corners;
    const auto& rows = panel_.section->rows;
    for (std::size_t k = 1; k < rows.size(); ++k)
      if (rows[k].segment != rows[k - 1].segment && rows[k].along == 0) {
        const double x = std::floor(x_of(panel_.distance[k])) + 0.5;
        for (double y = top_; y + 3 < bottom_; y += 8) corners.push_back({{x, y}, {x, y + 3}});
      }
    if (!corners.empty() && corners.size() < 20000) canvas_.stroke(corners, w, {0.66, 0.68, 0.71});
  }

  /// The ground below a lone surface.
  void shade() {
    const Section& section = *panel_.section;
    std::size_t k = 1;
    for (int i = left_ + 1; i < right_; ++i) {
      const double distance = (i - left_) / static_cast<double>(right_ - left_) * length_;
      while (k < section.rows.size() && panel_.distance[k] < distance) ++k;
      if (k == section.rows.size()) return;
      const double d0 = panel_.distance[k - 1], d1 = panel_.distance[k], z0 = section.z[k - 1], z1 = section.z[k];
      if (std::isnan(z0) || std::isnan(z1)) continue;
      const double z = d1 > d0 ? z0 + (z1 - z0) * (distance - d0) / (d1 - d0) : z1;
      canvas_.fill(i, static_cast<int>(std::ceil(y_of(z))), i + 1, bottom_, hues[0], 0.10);
    }
  }

  std::vector<std::vector<Point2>> runs(std::size_t surface) const {
    std::vector<std::vector<Point2>> lines;
    bool open = false;
    for (std::size_t k = 0; k < panel_.section->rows.size(); ++k) {
      const double z = panel_.section->height(k, surface);
      if (std::isnan(z)) {
        open = false;
        continue;
      }
      if (!open) lines.emplace_back();
      open = true;
      lines.back().push_back({x_of(panel_.distance[k]), y_of(z)});
    }
    return lines;
  }

  void exaggeration(double base) {
    if (!(options_.heights_per_length > 0)) return;
    const double steep =
        (bottom_ - top_) / heights_.size() * options_.heights_per_length / ((right_ - left_) / length_);
    if (!(steep > 1e-6 && steep < 1e9)) return;
    char text[64];
    std::snprintf(text, sizeof text,
                  steep >= 10  ? "heights x %.0f"
                  : steep >= 1 ? "heights x %.1f"
                               : "heights x %.2g",
                  steep);
    canvas_.text(right_, base, text, letter_ * 0.9, quiet, Anchor::right);
  }

  Canvas& canvas_;
  const ChartPanel& panel_;
  const ChartOptions& options_;
  double letter_;
  int top_, bottom_, left_ = 0, right_ = 0;
  Range heights_;
  double length_ = 1;
  Written unit_;
  Ticks z_ticks_;
};

/// Names and their colours, in as many rows as they need. Draws only when there is a canvas; how many rows there are.
int key(Canvas* canvas, const ChartOptions& options, double letter, int width) {
  const double sample = 2.6 * letter, between = 2.2 * letter, left = 2.2 * letter;
  double x = left;
  int row = 0;
  for (std::size_t s = 0; s < options.names.size(); ++s) {
    const double wide = sample + 0.7 * letter + text_width(options.names[s], letter);
    if (x > left && x + wide > width - left) x = left, ++row;
    const double y = letter * (2.6 + 2.1 * row);
    if (canvas) {
      canvas->stroke({{{x, y - letter / 2}, {x + sample, y - letter / 2}}}, std::max(1.8, letter * 0.26),
                     hues[s % std::size(hues)]);
      canvas->text(x + sample + 0.7 * letter, y, options.names[s], letter, ink);
    }
    x += wide + between;
  }
  return row + 1;
}

}  // namespace

Picture profile_chart(std::span<const ChartPanel> panels, const ChartOptions& options) {
  const double letter = std::clamp(options.size / 110.0, 6.0, 80.0);
  const int key_height = static_cast<int>(letter * (2.2 + 2.1 * key(nullptr, options, letter, options.size)));
  const int head = static_cast<int>(2.6 * letter), foot = static_cast<int>(6 * letter);
  const int plot = static_cast<int>(options.size * (panels.size() > 1 ? 0.24 : 0.36));
  Picture picture;
  picture.width = options.size;
  picture.height = key_height + static_cast<int>(panels.size()) * (head + plot + foot);
  picture.rgba.assign(static_cast<std::size_t>(picture.width) * picture.height * 4, 255);
  Canvas canvas(picture);
  key(&canvas, options, letter, options.size);
  int top = key_height + head;
  for (const ChartPanel& panel : panels) {
    Panel(canvas, panel, options, letter, top, top + plot).draw();
    top += head + plot + foot;
  }
  return picture;
}

}  // namespace terrane
