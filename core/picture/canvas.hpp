// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>
#include <vector>

#include "core/picture/picture.hpp"
#include "core/tin.hpp"

// Drawing: lines and letters over a picture, with smooth edges.
namespace terrane {

enum class Anchor { left, middle, right };

/// Paints on a picture. Places are in pixels: x to the right, y down, (0, 0) the outer corner of the first pixel. What
/// lies beyond the picture is cut off. The same bytes for the same calls.
class Canvas {
 public:
  /// Keeps a reference to the picture.
  explicit Canvas(Picture& picture) : picture_(picture) {}

  void blend(int column, int row, Colour colour, double alpha);
  /// Whole pixels from (x0, y0) to before (x1, y1).
  void fill(int x0, int y0, int x1, int y1, Colour colour, double alpha = 1);
  /// Lines with round ends; where they overlap they are not painted twice.
  void stroke(const std::vector<std::vector<Point2>>& lines, double width, Colour colour, double alpha = 1);
  /// One line of text (UTF-8), its baseline at y, capitals `size` pixels high. What the letters do not have is a box.
  /// `halo` > 0: a white rim of that many pixels, so that it can be read on anything.
  void text(double x, double y, std::string_view text, double size, Colour colour, Anchor anchor = Anchor::left,
            double halo = 0);

  int width() const { return picture_.width; }
  int height() const { return picture_.height; }

 private:
  Picture& picture_;
};

/// How much of each pixel lines cover, in the part of a picture that they reach. What two lines cover counts once.
class Coverage {
 public:
  /// `box` holds the lines with half their width and a pixel to spare.
  Coverage(const Box& box, int width, int height);
  void add(Point2 a, Point2 b, double half_width);
  void paint(Canvas& canvas, Colour colour, double alpha) const;

 private:
  int west_, north_, east_, south_;
  std::vector<float> share_;
};

/// How wide a text is drawn, in pixels.
double text_width(std::string_view text, double size);

}  // namespace terrane
