// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/shade.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.hpp"
#include "core/picture/canvas.hpp"

namespace terrane {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr int largest_size = 16384;

struct Vector {
  double x, y, z;
};

double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// Plan units to pixels; pixel (0, 0) is the north-western one.
struct Frame {
  int width = 0, height = 0;
  double x0 = 0, y0 = 0, per_x = 0, per_y = 0;
};

Frame frame_of(const Box& box, const ShadeOptions& options) {
  const double longer = std::max((box.xmax - box.xmin) * options.x_factor, box.ymax - box.ymin);
  // Walls alone may have no width.
  const double x_extent = std::max(box.xmax - box.xmin, 1e-9 * longer),
               y_extent = std::max(box.ymax - box.ymin, 1e-9 * longer);
  const double scale = options.size / longer;
  Frame frame;
  frame.width = std::clamp(static_cast<int>(std::lround(x_extent * options.x_factor * scale)), 1, options.size);
  frame.height = std::clamp(static_cast<int>(std::lround(y_extent * scale)), 1, options.size);
  frame.x0 = box.xmin;
  frame.y0 = box.ymax;
  frame.per_x = frame.width / x_extent;
  frame.per_y = frame.height / y_extent;
  return frame;
}

/// Where a face's plane is lit, and how much.
class Light {
 public:
  Light(const ShadeOptions& options, double exaggeration) {
    // z_factor height units are as long as one plan unit.
    to_slope_y_ = exaggeration / options.z_factor;
    to_slope_x_ = to_slope_y_ / options.x_factor;
    const double a = options.azimuth_deg * pi / 180, h = options.altitude_deg * pi / 180;
    key_ = {std::sin(a) * std::cos(h), std::cos(a) * std::cos(h), std::sin(h)};
    flat_ = std::sin(h);
  }

  /// Brightness of a slope: 1 where it is flat, up to about 1.3 facing the light, down to 0.35 away from it.
  double operator()(double gx, double gy) const {
    const double sx = -gx * to_slope_x_, sy = -gy * to_slope_y_;
    const double length = std::sqrt(sx * sx + sy * sy + 1);
    const double lit = dot(key_, {sx / length, sy / length, 1 / length});
    const double sky = 0.5 + 0.5 / length;
    const double relative = 0.8 * std::max(0.0, lit) / flat_ + 0.2 * sky;
    return relative >= 1 ? 1 + 0.7 * (relative - 1) : 0.35 + 0.65 * relative;
  }

 private:
  Vector key_;
  double flat_, to_slope_x_, to_slope_y_;
};

/// How much steeper the terrain is drawn than it is: gentle country, and any country seen from far, would look flat.
double exaggeration(const std::vector<Point2>& gradients, const ShadeOptions& options) {
  constexpr double wanted = 0.25, most = 6;
  double sum = 0;
  for (const Point2& g : gradients) {
    const double sx = g.x / (options.z_factor * options.x_factor), sy = g.y / options.z_factor;
    sum += std::min(1.0, sx * sx + sy * sy);
  }
  const double typical = std::sqrt(sum / static_cast<double>(gradients.size()));
  return typical * most <= wanted ? most : std::max(1.0, wanted / typical);
}

/// Gradients at vertices, those of the faces around weighted by plan area, so that faces do not show where terrain is
/// smooth.
std::vector<Point2> vertex_gradients(const Tin& tin) {
  std::vector<Point2> sum(tin.vertices.size());
  std::vector<double> weight(tin.vertices.size(), 0);
  for (const Face& f : tin.faces) {
    const Point &a = tin.vertices[f[0]], &b = tin.vertices[f[1]], &c = tin.vertices[f[2]];
    const double bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y, d = bx * cy - by * cx;
    if (!(d > 0)) continue;
    // d times the gradient.
    const Point2 g{(b.z - a.z) * cy - (c.z - a.z) * by, bx * (c.z - a.z) - cx * (b.z - a.z)};
    for (const Index v : f) {
      sum[v].x += g.x;
      sum[v].y += g.y;
      weight[v] += d;
    }
  }
  for (std::size_t v = 0; v < sum.size(); ++v) {
    if (weight[v] > 0) sum[v] = {sum[v].x / weight[v], sum[v].y / weight[v]};
  }
  return sum;
}

class Painter {
 public:
  Painter(const Tin& tin, const ShadeOptions& options, Picture& picture)
      : tin_(tin),
        picture_(picture),
        frame_(frame_of(bounds(tin), options)),
        gradients_(vertex_gradients(tin)),
        light_(options, exaggeration(gradients_, options)),
        relief_(options.relief) {
    const HeightSpan heights = height_span(tin);
    colours_ = options.colours ? *options.colours : atlas_colours(heights.low, heights.high);
    picture.width = frame_.width;
    picture.height = frame_.height;
    picture.rgba.assign(static_cast<std::size_t>(frame_.width) * frame_.height * 4, 0);
  }

  /// Paints the pixels whose centres lie in the face.
  void paint(const Face& f) {
    std::array<Point2, 3> p;
    for (int k = 0; k < 3; ++k) {
      const Point& v = tin_.vertices[f[k]];
      p[k] = {(v.x - frame_.x0) * frame_.per_x - 0.5, (frame_.y0 - v.y) * frame_.per_y - 0.5};
    }
    const double d = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
    if (d == 0) return;
    const auto [ylow, yhigh] = std::minmax({p[0].y, p[1].y, p[2].y});
    const int j0 = std::max(0, static_cast<int>(std::ceil(ylow))),
              j1 = std::min(frame_.height - 1, static_cast<int>(std::floor(yhigh)));
    for (int j = j0; j <= j1; ++j) {
      double left = INFINITY, right = -INFINITY;
      for (int k = 0; k < 3; ++k) {
        const Point2 a = p[k], b = p[(k + 1) % 3];
        if (std::min(a.y, b.y) > j || std::max(a.y, b.y) < j) continue;
        const double x = a.y == b.y ? a.x : a.x + (b.x - a.x) * ((j - a.y) / (b.y - a.y));
        left = std::min({left, x, a.y == b.y ? b.x : x});
        right = std::max({right, x, a.y == b.y ? b.x : x});
      }
      const int i0 = std::max(0, static_cast<int>(std::ceil(left))),
                i1 = std::min(frame_.width - 1, static_cast<int>(std::floor(right)));
      for (int i = i0; i <= i1; ++i) {
        const double w1 = ((i - p[0].x) * (p[2].y - p[0].y) - (j - p[0].y) * (p[2].x - p[0].x)) / d;
        const double w2 = ((p[1].x - p[0].x) * (j - p[0].y) - (p[1].y - p[0].y) * (i - p[0].x)) / d;
        const double v1 = std::clamp(w1, 0.0, 1.0), v2 = std::clamp(w2, 0.0, 1 - v1);  // slivers round badly
        pixel(i, j, f, {1 - v1 - v2, v1, v2});
      }
    }
  }

 private:
  void pixel(int i, int j, const Face& f, const std::array<double, 3>& w) {
    double z = 0;
    Point2 g;
    for (int k = 0; k < 3; ++k) {
      z += w[k] * tin_.vertices[f[k]].z;
      g.x += w[k] * gradients_[f[k]].x;
      g.y += w[k] * gradients_[f[k]].y;
    }
    const Colour c = (relief_ == 0 ? 1 : 1 + relief_ * (light_(g.x, g.y) - 1)) * colours_(z);
    std::uint8_t* to = picture_.rgba.data() + (static_cast<std::size_t>(j) * frame_.width + i) * 4;
    const auto byte = [](double v) { return static_cast<std::uint8_t>(std::clamp(v, 0.0, 1.0) * 255 + 0.5); };
    to[0] = byte(c.r);
    to[1] = byte(c.g);
    to[2] = byte(c.b);
    to[3] = 255;
  }

  const Tin& tin_;
  Picture& picture_;
  Frame frame_;
  std::vector<Point2> gradients_;
  Light light_;
  ColourScale colours_;
  double relief_;
};

/// The edges of all faces. Where they lie close together they would hide what is below.
void draw_wires(const Tin& tin, const ShadeOptions& options, Picture& picture, Context& context) {
  const Frame frame = frame_of(bounds(tin), options);
  const auto at = [&](Index v) {
    const Point& p = tin.vertices[v];
    return Point2{(p.x - frame.x0) * frame.per_x, (frame.y0 - p.y) * frame.per_y};
  };
  std::size_t covered = 0;
  for (std::size_t k = 3; k < picture.rgba.size(); k += 4) covered += picture.rgba[k] != 0;
  const double side =
      std::sqrt(2.3 * static_cast<double>(covered) / static_cast<double>(tin.faces.size()));  // of a face
  const double width = std::clamp(options.size / 1100.0, 0.7, 3.0), alpha = std::clamp(side / width / 14, 0.1, 0.75);
  Coverage wires({0, 0, static_cast<double>(frame.width), static_cast<double>(frame.height)}, frame.width,
                 frame.height);
  for (std::size_t f = 0; f < tin.faces.size(); ++f) {
    if (f % 10000 == 0) context.progress("wireframe", static_cast<double>(f) / tin.faces.size());
    for (int k = 0; k < 3; ++k) wires.add(at(tin.faces[f][k]), at(tin.faces[f][(k + 1) % 3]), width / 2);
  }
  Canvas canvas(picture);
  wires.paint(canvas, {0.1, 0.1, 0.12}, alpha);
}

}  // namespace

Picture hillshade(const Tin& tin, const ShadeOptions& options, Context& context) {
  if (options.size < 1 || options.size > largest_size) {
    throw Error(ErrorKind::usage, "picture-size",
                "the size of a picture must be 1 to " + std::to_string(largest_size) + " pixels");
  }
  Picture picture;
  const Box box = bounds(tin);
  if (tin.faces.empty() || !(box.xmax > box.xmin || box.ymax > box.ymin)) return picture;
  Painter painter(tin, options, picture);
  for (std::size_t f = 0; f < tin.faces.size(); ++f) {
    if (f % 10000 == 0) context.progress("shade", static_cast<double>(f) / tin.faces.size());
    painter.paint(tin.faces[f]);
  }
  if (options.wireframe) draw_wires(tin, options, picture, context);
  return picture;
}

}  // namespace terrane
