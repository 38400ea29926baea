// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/rasterize.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/parallel.hpp"
#include "core/predicates.hpp"
#include "core/triangulate.hpp"

namespace terrane {

namespace {

constexpr int band_height = 64;  // rows that one task fills: they stay near the processor

/// Where the samples lie.
class Places {
 public:
  std::vector<double> x, y;  // of columns from the west, of rows from the north

  Places(const Raster& lattice, const Tin& tin)
      : x0_(lattice.x0),
        per_x_(1 / lattice.dx),
        even_(is_even(lattice.x0, lattice.dx, lattice.width) && is_even(lattice.y0, lattice.dy, lattice.height)) {
    for (int i = 0; i < lattice.width; ++i) x.push_back(lattice.place(i, 0).x);
    for (int j = 0; j < lattice.height; ++j) y.push_back(lattice.place(0, j).y);
    double far = std::max(std::fabs(x.front()), std::fabs(x.back()));
    for (const Point& p : tin.vertices) far = std::max(far, std::fabs(p.x));
    noise_ = 0x1p-48 * (far * per_x_ + lattice.width);
  }

  double column(double at) const { return (at - x0_) * per_x_; }
  /// Above the error of column(x) for an x good to 2^-50 of the largest there is.
  double noise() const { return noise_; }
  /// True when no place is rounded: then columns and rows stand for places in exact decisions.
  bool even() const { return even_; }

 private:
  static bool is_even(double origin, double step, int count) {
    const double reach = std::fabs(origin) + step * count;
    const double unit = std::ldexp(1.0, std::ilogb(reach) - 50);
    return std::fmod(origin, unit) == 0 && std::fmod(step, unit) == 0;
  }

  double x0_, per_x_, noise_;
  bool even_;
};

/// A vertex among the samples.
struct Corner {
  Point at;
  int row, column;  // the last row at or north of it, the first column at or east of it
  bool on_row, on_column;

  int first_row() const { return row + !on_row; }  // the first row at or south of it
  bool on_sample() const { return on_row && on_column; }
};

/// A face's corners from the south to the north; the order does not depend on the one they are given in.
struct Triangle {
  const Corner &low, &mid, &top;
  int turn;  // of low, mid, top
};

/// The straight line from a corner north to another, followed from row to row.
struct Side {
  const Corner &from, &to;
  double slope;

  Side(const Corner& a, const Corner& b) : from(a), to(b), slope((b.at.x - a.at.x) / (b.at.y - a.at.y)) {}
  double x(double y) const { return from.at.x + (y - from.at.y) * slope; }
  /// The corner that lies on row j, or null.
  const Corner* corner_on(int j) const {
    return from.on_row && from.row == j ? &from : to.on_row && to.row == j ? &to : nullptr;
  }
};

/// Heights on the plane of a triangle.
class Plane {
 public:
  explicit Plane(const Triangle& t) : a_(t.low.at), b_(t.mid.at), c_(t.top.at) {
    const double bx = b_.x - a_.x, by = b_.y - a_.y, bz = b_.z - a_.z;
    const double cx = c_.x - a_.x, cy = c_.y - a_.y, cz = c_.z - a_.z;
    const double d = bx * cy - by * cx;
    // What rounding does to a height is below 9 * 2^-53 of size * terms / d^2; the factor leaves 1.3e-13 of the
    // largest.
    const double size = std::fabs(bx * cy) + std::fabs(by * cx);
    const double terms = (std::fabs(bz * cy) + std::fabs(cz * by)) * (std::fabs(bx) + std::fabs(cx)) +
                         (std::fabs(bx * cz) + std::fabs(cx * bz)) * cy;
    const double largest = std::max({std::fabs(a_.z), std::fabs(b_.z), std::fabs(c_.z)});
    sliver_ = !(size * terms <= 128 * largest * d * d);
    gx_ = (bz * cy - cz * by) / d;
    gy_ = (bx * cz - cx * bz) / d;
  }

  /// Raises the samples of a row, `x` and `z` those of its first, that lie lower than the plane or are NaN.
  void raise(double y, const double* x, double* z, int count) const {
    if (sliver_) return raise_by_weights(y, x, z, count);
    const double rise = gy_ * (y - a_.y);
    for (int k = 0; k < count; ++k) {
      const double height = a_.z + (gx_ * (x[k] - a_.x) + rise);
      z[k] = z[k] >= height ? z[k] : height;
    }
  }

 private:
  /// The gradient of a sliver is mostly rounding; its corners' heights are weighted instead, which keeps 1e-13.
  void raise_by_weights(double y, const double* x, double* z, int count) const {
    for (int k = 0; k < count; ++k) {
      const Point2 p{x[k], y};
      const double a = std::fabs(area2_accurate(p, plan(b_), plan(c_)));
      const double b = std::fabs(area2_accurate(p, plan(c_), plan(a_)));
      const double c = std::fabs(area2_accurate(p, plan(a_), plan(b_)));
      const double height = (a * a_.z + b * b_.z + c * c_.z) / (a + b + c);
      z[k] = z[k] >= height ? z[k] : height;
    }
  }

  Point a_, b_, c_;
  double gx_, gy_;
  bool sliver_;
};

class Rasterizer {
 public:
  Rasterizer(const Tin& tin, Raster& raster, Context& context)
      : tin_(tin), raster_(raster), context_(context), places_(raster, tin) {}

  void run() {
    find_corners();
    sort_into_bands();
    const std::size_t bands = first_.size() - 1;
    parallel_tasks(context_, bands, [&](std::size_t band) {
      const int begin = static_cast<int>(band) * band_height, end = std::min(begin + band_height, raster_.height);
      for (std::size_t k = first_[band]; k < first_[band + 1]; ++k) fill(triangle(tin_.faces[faces_[k]]), begin, end);
    });
  }

 private:
  /// The largest k < n for which holds(k), true up to some k, or -1; quick where the guess is good.
  template <class Holds>
  static int last(double guess, int n, Holds holds) {
    int k = static_cast<int>(std::clamp(guess, -1.0, n - 1.0));
    if ((k < 0 || holds(k)) && (k + 1 == n || !holds(k + 1))) return k;
    if (k > 0 && holds(k - 1) && !holds(k)) return k - 1;
    if (k + 1 < n && holds(k + 1) && (k + 2 == n || !holds(k + 2))) return k + 1;
    int yes = -1, no = n;
    while (no - yes > 1) {
      const int middle = yes + (no - yes) / 2;
      (holds(middle) ? yes : no) = middle;
    }
    return yes;
  }

  void find_corners() {
    corners_.resize(tin_.vertices.size());
    parallel_for(context_, corners_.size(), 16384, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const Point& p = tin_.vertices[v];
        const int row = last(std::floor((raster_.y0 - p.y) / raster_.dy), raster_.height,
                             [&](int j) { return places_.y[j] >= p.y; });
        const int column =
            last(std::ceil(places_.column(p.x)) - 1, raster_.width, [&](int i) { return places_.x[i] < p.x; }) + 1;
        corners_[v] = {p, row, column, row >= 0 && places_.y[row] == p.y,
                       column < raster_.width && places_.x[column] == p.x};
      }
    });
  }

  Triangle triangle(const Face& f) const {
    std::array<const Corner*, 3> c{&corners_[f[0]], &corners_[f[1]], &corners_[f[2]]};
    const auto order = [&](int i, int j) {
      const Point &a = c[i]->at, &b = c[j]->at;
      if (b.y < a.y || (b.y == a.y && b.x < a.x)) std::swap(c[i], c[j]);
    };
    order(0, 1);
    order(1, 2);
    order(0, 1);
    return {*c[0], *c[1], *c[2], orientation(plan(c[0]->at), plan(c[1]->at), plan(c[2]->at))};
  }

  /// faces_[first_[b]] ... are the faces that reach band b.
  void sort_into_bands() {
    const std::size_t bands = (raster_.height + band_height - 1) / band_height;
    const auto each = [&](auto visit) {
      for (std::size_t f = 0; f < tin_.faces.size(); ++f) {
        const auto& [a, b, c] = tin_.faces[f];
        const int north = std::min({corners_[a].first_row(), corners_[b].first_row(), corners_[c].first_row()});
        const int south = std::max({corners_[a].row, corners_[b].row, corners_[c].row});
        for (int k = north / band_height; north <= south && k <= south / band_height; ++k) visit(f, k);
      }
    };
    first_.assign(bands + 1, 0);
    each([&](std::size_t, int b) { ++first_[b + 1]; });
    for (std::size_t b = 0; b < bands; ++b) first_[b + 1] += first_[b];
    faces_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    each([&](std::size_t f, int b) { faces_[next[b]++] = static_cast<Index>(f); });
  }

  void fill(const Triangle& t, int begin, int end) {
    if (t.turn == 0) return;
    const Plane plane(t);
    const Side whole(t.low, t.top), lower(t.low, t.mid), upper(t.mid, t.top);
    const bool flat_bottom = t.low.at.y == t.mid.at.y;
    const std::array<const Corner*, 3> corners{&t.low, &t.mid, &t.top};
    const int last = std::min(end - 1, t.low.row);
    for (int j = std::max(begin, t.top.first_row()); j <= last; ++j) {
      const double y = places_.y[j];
      const Side& part = y > t.mid.at.y || flat_bottom ? upper : lower;
      int first = first_east(t.turn > 0 ? whole : part, j), past = last_west(t.turn > 0 ? part : whole, j) + 1;
      double* row = raster_.samples.data() + static_cast<std::size_t>(j) * raster_.width;
      for (const Corner* c : corners) {
        if (!c->on_sample() || c->row != j) continue;
        double& z = row[c->column];
        z = z >= c->at.z ? z : c->at.z;
        if (first == c->column) ++first;
        if (past == c->column + 1) --past;
      }
      if (first < past) plane.raise(y, places_.x.data() + first, row + first, past - first);
    }
  }

  /// The first column at or east of a side.
  int first_east(const Side& side, int j) const {
    if (const Corner* c = side.corner_on(j)) return c->column;
    return column(side, j, [&](int i) { return turn(side, i, j) > 0; }) + 1;
  }

  /// The last column at or west of a side.
  int last_west(const Side& side, int j) const {
    if (const Corner* c = side.corner_on(j)) return c->on_column ? c->column : c->column - 1;
    return column(side, j, [&](int i) { return turn(side, i, j) >= 0; });
  }

  /// The last column west of a side in row j, as `west` says where it is close.
  template <class West>
  int column(const Side& side, int j, West west) const {
    const int width = raster_.width;
    const double noise = places_.noise(), u = places_.column(side.x(places_.y[j]));
    if (!(noise < 0.25)) return last(std::floor(u), width, west);
    if (u < -0.5) return -1;
    if (u > width - 0.5) return width - 1;
    const int near = static_cast<int>(u + 0.5);
    if (u > near + noise) return near;
    if (u < near - noise) return near - 1;
    return west(near) ? near : near - 1;
  }

  /// +1 where sample (i, j) is west of a side, 0 on it, -1 east; exact.
  int turn(const Side& side, int i, int j) const {
    const Corner &a = side.from, &b = side.to;
    if (places_.even() && a.on_sample() && b.on_sample()) {
      const std::int64_t l = std::int64_t{b.column - a.column} * (a.row - j);
      const std::int64_t r = std::int64_t{a.row - b.row} * (i - a.column);
      return (l > r) - (l < r);
    }
    return orientation(plan(a.at), plan(b.at), {places_.x[i], places_.y[j]});
  }

  const Tin& tin_;
  Raster& raster_;
  Context& context_;
  Places places_;
  std::vector<Corner> corners_;
  std::vector<std::size_t> first_;
  std::vector<Index> faces_;
};

}  // namespace

Raster rasterize(const Tin& tin, Raster lattice, Context& context) {
  lattice.samples = {};
  check_triangulable(lattice);
  lattice.samples.assign(static_cast<std::size_t>(lattice.width) * lattice.height,
                         std::numeric_limits<double>::quiet_NaN());
  if (!lattice.samples.empty()) Rasterizer(tin, lattice, context).run();
  return lattice;
}

}  // namespace terrane
