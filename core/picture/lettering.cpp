// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/picture/lettering.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

namespace terrane {

namespace {

/// A letter drawn by hand on squared paper, a capital 10 squares high. M x y: put the pen down; L x y: a line to there;
/// E cx cy rx ry from to: on along an arc of an ellipse, angles in degrees, anticlockwise from the east.
struct Glyph {
  double width;
  const char* path;
};

constexpr double space_between = 2.4, word_space = 4;
constexpr Glyph box = {5, "M0 0L5 0L5 10L0 10L0 0"};

constexpr std::array<Glyph, 94> ascii = {{
    {0.4, "M0.2 10L0.2 3.2M0.2 0.2L0.2 0"},                                                   // !
    {2.2, "M0 10L0 7.4M2.2 10L2.2 7.4"},                                                      // "
    {6.4, "M1.4 0.8L2.6 9.2M4 0.8L5.2 9.2M0.4 6.4L6.4 6.4M0 3.6L6 3.6"},                      // #
    {6, "E3 6.9 2.7 1.9 35 270E3 3.1 2.9 1.9 90 -145M3 10.4L3 -0.4"},                         // $
    {8.6, "E2 7.9 2 2.1 0 360M7.2 10L1.4 0M8.6 2.1E6.6 2.1 2 2.1 0 360"},                     // %
    {7.4, "M7.4 0L1.6 6.4E3 8 1.9 2 220 -40L1 4.4E2.9 2.5 2.9 2.5 130 290L6.8 4"},            // &
    {0.2, "M0.1 10L0.1 7.4"},                                                                 // '
    {2, "E5 4 5 7.6 125 235"},                                                                // (
    {2, "E-3 4 5 7.6 55 -55"},                                                                // )
    {4.4, "M2.2 10L2.2 5.6M0.3 9L4.1 6.6M4.1 9L0.3 6.6"},                                     // *
    {5.4, "M0 4.6L5.4 4.6M2.7 1.9L2.7 7.3"},                                                  // +
    {0.8, "M0.7 0.4L0.1 -1.8"},                                                               // ,
    {3.4, "M0 4L3.4 4"},                                                                      // -
    {0.4, "M0.2 0.2L0.2 0"},                                                                  // .
    {4, "M0 -1L4 11"},                                                                        // /
    {6, "M6 7E3 7 3 3 0 180L0 3E3 3 3 3 180 360L6 7"},                                        // 0
    {6, "M1 7.8L3.6 10L3.6 0"},                                                               // 1
    {6, "E3 7.1 2.9 2.9 165 -32L0.2 0L6 0"},                                                  // 2
    {6, "E3 7.5 2.6 2.5 150 -90E3 2.5 3 2.5 90 -150"},                                        // 3
    {6.2, "M4.6 0L4.6 10L0 2.8L6.2 2.8"},                                                     // 4
    {6, "M5.4 10L1 10L0.6 5.5E2.9 3.2 3.1 3.2 140 -148"},                                     // 5
    {6, "M4.5 10L0.45 4.7E3 3.1 3 3.1 149 509"},                                              // 6
    {6, "M0 10L6 10L2 0"},                                                                    // 7
    {6, "E3 7.55 2.6 2.45 -90 270E3 2.55 3 2.55 90 450"},                                     // 8
    {6, "M1.5 0L5.55 5.3E3 6.9 3 3.1 -31 329"},                                               // 9
    {0.4, "M0.2 6.4L0.2 6.2M0.2 0.2L0.2 0"},                                                  // :
    {0.8, "M0.5 6.4L0.5 6.2M0.7 0.4L0.1 -1.8"},                                               // ;
    {5, "M5 7.6L0 4.6L5 1.6"},                                                                // <
    {5.4, "M0 6L5.4 6M0 3.2L5.4 3.2"},                                                        // =
    {5, "M0 7.6L5 4.6L0 1.6"},                                                                // >
    {5, "E2.5 7.5 2.5 2.5 165 -40L2.5 4.4L2.5 3M2.5 0.2L2.5 0"},                              // ?
    {9.4, "E4.7 4.4 2.1 2.4 0 360L6.8 3E8.1 3.4 1.3 1.3 180 340E4.7 4.6 4.7 5.4 0 300"},      // @
    {7.2, "M0 0L3.6 10L7.2 0M1.2 3.3L6 3.3"},                                                 // A
    {6.2, "M0 0L0 10L3.2 10E3.2 7.6 2.6 2.4 90 -90L0 5.2M3.2 5.2E3.2 2.6 3 2.6 90 -90L0 0"},  // B
    {6.6, "E4 5 4 5 50 310"},                                                                 // C
    {6.8, "M0 0L0 10L2.4 10E2.4 5 4.4 5 90 -90L0 0"},                                         // D
    {5.4, "M5.4 10L0 10L0 0L5.4 0M0 5.2L4.8 5.2"},                                            // E
    {5.2, "M5.2 10L0 10L0 0M0 5.1L4.6 5.1"},                                                  // F
    {7.2, "E4 5 4 5 50 315L6.9 5L4.2 5"},                                                     // G
    {6.6, "M0 0L0 10M6.6 0L6.6 10M0 5.2L6.6 5.2"},                                            // H
    {0.2, "M0.1 0L0.1 10"},                                                                   // I
    {4.2, "M4.2 10L4.2 2.6E2 2.6 2.2 2.6 0 -150"},                                            // J
    {6.4, "M0 0L0 10M6 10L0 4M2 6L6.4 0"},                                                    // K
    {5, "M0 10L0 0L5 0"},                                                                     // L
    {8, "M0 0L0 10L4 3L8 10L8 0"},                                                            // M
    {6.8, "M0 0L0 10L6.8 0L6.8 10"},                                                          // N
    {8, "E4 5 4 5 0 360"},                                                                    // O
    {6, "M0 0L0 10L3.2 10E3.2 7.3 2.8 2.7 90 -90L0 4.6"},                                     // P
    {8, "E4 5 4 5 0 360M5 2.4L7.8 -0.6"},                                                     // Q
    {6.2, "M0 0L0 10L3.2 10E3.2 7.3 2.8 2.7 90 -90L0 4.6M3 4.6L6.2 0"},                       // R
    {6, "E3 7.55 2.7 2.45 35 270E3 2.55 3 2.55 90 -148"},                                     // S
    {6.8, "M0 10L6.8 10M3.4 10L3.4 0"},                                                       // T
    {6.6, "M0 10L0 3.3E3.3 3.3 3.3 3.3 180 360L6.6 10"},                                      // U
    {7, "M0 10L3.5 0L7 10"},                                                                  // V
    {10, "M0 10L2.6 0L5 8.8L7.4 0L10 10"},                                                    // W
    {6.6, "M0 10L6.6 0M6.6 10L0 0"},                                                          // X
    {6.8, "M0 10L3.4 5L6.8 10M3.4 5L3.4 0"},                                                  // Y
    {6.2, "M0 10L6.2 10L0 0L6.2 0"},                                                          // Z
    {2, "M2 11L0 11L0 -2L2 -2"},                                                              // [
    {4, "M0 11L4 -1"},                                                                        // backslash
    {2, "M0 11L2 11L2 -2L0 -2"},                                                              // ]
    {4.6, "M0 6.6L2.3 10L4.6 6.6"},                                                           // ^
    {5.4, "M0 -1.6L5.4 -1.6"},                                                                // _
    {1.6, "M0 10.4L1.6 8.6"},                                                                 // `
    {5.4, "E2.7 3.5 2.7 3.5 0 360M5.4 7L5.4 0"},                                              // a
    {5.4, "M0 10L0 0M5.4 3.5E2.7 3.5 2.7 3.5 0 360"},                                         // b
    {4.7, "E2.9 3.5 2.9 3.5 50 310"},                                                         // c
    {5.4, "E2.7 3.5 2.7 3.5 0 360M5.4 10L5.4 0"},                                             // d
    {5.6, "M0 3.7L5.6 3.7E2.8 3.5 2.8 3.5 4 315"},                                            // e
    {3.4, "E3.2 8 1.8 2 80 180L1.4 0M0 7L3.4 7"},                                             // f
    {5.4, "E2.7 3.5 2.7 3.5 0 360M5.4 7L5.4 -0.4E2.7 -0.4 2.7 2.6 0 -145"},                   // g
    {5.2, "M0 10L0 0M0 4.2E2.6 4.2 2.6 2.8 180 0L5.2 0"},                                     // h
    {0.4, "M0.2 7L0.2 0M0.2 9.9L0.2 9.7"},                                                    // i
    {1.6, "M1.4 7L1.4 -1E-0.2 -1 1.6 2 0 -90M1.4 9.9L1.4 9.7"},                               // j
    {5, "M0 10L0 0M4.7 7L0 2.8M1.8 4.4L5 0"},                                                 // k
    {1.5, "M0 10L0 1.5E1.5 1.5 1.5 1.5 180 270"},                                             // l
    {8.4, "M0 7L0 0M0 4.5E2.1 4.5 2.1 2.5 180 0L4.2 0M4.2 4.5E6.3 4.5 2.1 2.5 180 0L8.4 0"},  // m
    {5.2, "M0 7L0 0M0 4.2E2.6 4.2 2.6 2.8 180 0L5.2 0"},                                      // n
    {5.8, "E2.9 3.5 2.9 3.5 0 360"},                                                          // o
    {5.4, "M0 7L0 -3M5.4 3.5E2.7 3.5 2.7 3.5 0 360"},                                         // p
    {5.4, "E2.7 3.5 2.7 3.5 0 360M5.4 7L5.4 -3"},                                             // q
    {3.2, "M0 7L0 0M0 4E2.6 4 2.6 3 180 78"},                                                 // r
    {4.6, "E2.3 5.25 2.1 1.75 30 270E2.3 1.75 2.3 1.75 90 -150"},                             // s
    {3.4, "M1.4 9.4L1.4 1.8E3.2 1.8 1.8 1.8 180 280M0 7L3.4 7"},                              // t
    {5.2, "M0 7L0 2.8E2.6 2.8 2.6 2.8 180 360L5.2 7M5.2 3L5.2 0"},                            // u
    {5.4, "M0 7L2.7 0L5.4 7"},                                                                // v
    {8, "M0 7L2.1 0L4 6L5.9 0L8 7"},                                                          // w
    {5, "M0 7L5 0M5 7L0 0"},                                                                  // x
    {5.4, "M0 7L2.7 0M5.4 7L1.6 -3"},                                                         // y
    {4.8, "M0 7L4.8 7L0 0L4.8 0"},                                                            // z
    {2.6, "M2.6 11L1.4 10L1.4 5.6L0 4.5L1.4 3.4L1.4 -1L2.6 -2"},                              // {
    {0.2, "M0.1 11L0.1 -2"},                                                                  // |
    {2.6, "M0 11L1.2 10L1.2 5.6L2.6 4.5L1.2 3.4L1.2 -1L0 -2"},                                // }
    {5.4, "E1.4 4.4 1.4 1.2 180 0E4 4.6 1.2 1.2 180 360"},                                    // ~
}};

const Glyph& glyph_of(std::uint32_t code) {
  static constexpr Glyph minus = {5.4, "M0 4.6L5.4 4.6"}, degree = {3, "E1.5 8.5 1.5 1.5 0 360"};
  static constexpr Glyph square = {3, "E1.5 8.6 1.4 1.4 165 -32L0.1 5L3 5"};
  static constexpr Glyph cube = {3, "E1.5 8.9 1.3 1.2 150 -90E1.5 6.4 1.5 1.3 90 -150"};
  if (code > ' ' && code < 127) return ascii[code - '!'];
  if (code == 0x2212) return minus;
  if (code == 0xB0) return degree;
  if (code == 0xB2) return square;
  if (code == 0xB3) return cube;
  return box;
}

/// The next code point; bytes that are no UTF-8 are one each.
std::uint32_t next_code(std::string_view& text) {
  const auto lead = static_cast<unsigned char>(text.front());
  const std::size_t length = lead < 0xC0 ? 1 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  std::uint32_t code = length == 1 ? lead : lead & (0xFF >> (length + 1));
  std::size_t k = 1;
  for (; k < std::min(length, text.size()) && (text[k] & 0xC0) == 0x80; ++k) code = code << 6 | (text[k] & 0x3F);
  text.remove_prefix(k);
  return code;
}

/// Follows a glyph's path with the pen.
class Pen {
 public:
  Pen(double left, std::vector<std::vector<Point2>>& strokes) : left_(left), strokes_(strokes) {}

  void draw(std::string_view path) {
    down_ = false;
    while (!path.empty()) {
      const char command = path.front();
      path.remove_prefix(1);
      if (command == 'E') {
        const double cx = number(path), cy = number(path), rx = number(path), ry = number(path);
        const double from = number(path), to = number(path);
        arc(cx, cy, rx, ry, from, to);
        continue;
      }
      const double x = number(path), y = number(path);
      if (command == 'M') down_ = false;
      to(x, y);
    }
  }

 private:
  static double number(std::string_view& path) {
    while (!path.empty() && path.front() == ' ') path.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(path.data(), path.data() + path.size(), value, std::chars_format::fixed);
    (void)error;
    path.remove_prefix(static_cast<std::size_t>(end - path.data()));
    return value;
  }

  void to(double x, double y) {
    if (!std::exchange(down_, true)) strokes_.emplace_back();
    strokes_.back().push_back({(left_ + x) / 10, y / 10});
  }

  void arc(double cx, double cy, double rx, double ry, double from, double end) {
    const int steps = std::max(4, static_cast<int>(std::fabs(end - from) / 12));
    for (int k = 0; k <= steps; ++k) {
      const double angle = (from + (end - from) * k / steps) * std::numbers::pi / 180;
      to(cx + rx * std::cos(angle), cy + ry * std::sin(angle));
    }
  }

  double left_;
  std::vector<std::vector<Point2>>& strokes_;
  bool down_ = false;
};

}  // namespace

Lettering lettering(std::string_view text) {
  Lettering out;
  double x = 0;
  while (!text.empty()) {
    const std::uint32_t code = next_code(text);
    if (code == ' ') {
      x += word_space;
      continue;
    }
    const Glyph& glyph = glyph_of(code);
    Pen(x, out.strokes).draw(glyph.path);
    x += glyph.width + space_between;
  }
  out.width = std::max(0.0, x - space_between) / 10;
  return out;
}

}  // namespace terrane
