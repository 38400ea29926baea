// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/rasterize.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/mesh/array.hpp"
#include "core/parallel.hpp"
#include "core/predicates.hpp"
#include "core/triangulate.hpp"

namespace terrane {

namespace {

constexpr int tile_height = 64, tile_width = 256;  // samples that stay near the processor while faces raise them

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
    noise_ = 0x1p-47 * (far * per_x_ + lattice.width);
  }

  double column(double at) const { return (at - x0_) * per_x_; }
  double columns_per_unit() const { return per_x_; }
  /// How far from a whole column is beyond doubt for the column of a side in a row. With e = 2^-53 and F = far / dx,
  /// rounding makes up to 24 e F + 2 e of it, the rounding of places 3 e F; this is 64 e (F + width).
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

/// Where a point lies among the samples.
struct Cell {
  int row, first_row;       // the last row at or north of it, the first at or south of it
  int column, last_column;  // the first column at or east of it, the last at or west of it

  bool on_row() const { return row == first_row; }
  bool on_column() const { return column == last_column; }
  bool on_sample() const { return on_row() && on_column(); }
};

/// A vertex among the samples.
struct Corner : Cell {
  const Point& at;
};

/// A face's corners from the south to the north; the order does not depend on the one they are given in.
struct Triangle {
  Corner low, mid, top;
  int turn;  // of low, mid, top
};

/// The straight line from a corner north to another, followed from row to row.
struct Side {
  const Corner &from, &to;
  double column, slope;  // where it starts; columns for a step north of 1

  Side(const Corner& a, const Corner& b, const Places& places)
      : from(a),
        to(b),
        column(places.column(a.at.x)),
        slope((b.at.x - a.at.x) / (b.at.y - a.at.y) * places.columns_per_unit()) {}
  double column_at(double y) const { return column + (y - from.at.y) * slope; }
  /// The corner that lies on row j, or null.
  const Corner* corner_on(int j) const {
    return from.on_row() && from.row == j ? &from : to.on_row() && to.row == j ? &to : nullptr;
  }
};

/// NaN is below every height.
void raise_to(double& z, double height) { z = z > height ? z : height; }

/// Heights on the plane of a triangle.
class Plane {
 public:
  explicit Plane(const Triangle& t) : a_(t.low.at), b_(t.mid.at), c_(t.top.at) {
    const double bx = b_.x - a_.x, by = b_.y - a_.y, bz = b_.z - a_.z;
    const double cx = c_.x - a_.x, cy = c_.y - a_.y, cz = c_.z - a_.z;
    const double d = bx * cy - by * cx;
    // What rounding does to a height is below 12 * 2^-53 of size * terms / d^2; the factor leaves 1.8e-13 of the
    // largest.
    const double size = std::fabs(bx * cy) + std::fabs(by * cx);
    const double terms = (std::fabs(bz * cy) + std::fabs(cz * by)) * (std::fabs(bx) + std::fabs(cx)) +
                         (std::fabs(bx * cz) + std::fabs(cx * bz)) * cy;
    const double largest = std::max({std::fabs(a_.z), std::fabs(b_.z), std::fabs(c_.z)});
    sliver_ = d == 0 || !(size * terms <= 128 * largest * d * d);
    gx_ = (bz * cy - cz * by) / d;
    gy_ = (bx * cz - cx * bz) / d;
  }

  /// Raises the samples begin ... end - 1 of a row that lie lower; `x` are the places of its columns.
  void raise(double y, const double* __restrict x, double* __restrict z, int begin, int end) const {
    if (sliver_) return raise_by_weights(y, x, z, begin, end);
    const double base = a_.z + gy_ * (y - a_.y) + 0.0;  // never -0, and so no height is: of equal ones either may stay
    for (int i = begin; i < end; ++i) raise_to(z[i], base + gx_ * (x[i] - a_.x));
  }

 private:
  /// The gradient of a sliver is mostly rounding; its corners' heights are weighted instead, which keeps 1e-13.
  void raise_by_weights(double y, const double* x, double* z, int begin, int end) const {
    for (int i = begin; i < end; ++i) {
      const Point2 p{x[i], y};
      const double a = std::fabs(area2_accurate(p, plan(b_), plan(c_)));
      const double b = std::fabs(area2_accurate(p, plan(c_), plan(a_)));
      const double c = std::fabs(area2_accurate(p, plan(a_), plan(b_)));
      raise_to(z[i], (a * a_.z + b * b_.z + c * c_.z) / (a + b + c) + 0.0);
    }
  }

  const Point &a_, &b_, &c_;
  double gx_, gy_;
  bool sliver_;
};

/// A part of the raster while it is made. Its rows lie close together, not a raster's width apart, which is often near
/// a power of two: then they would drive each other out of the processor's caches.
class Tile {
 public:
  const int north, south, west, east;  // rows north ... south - 1, columns west ... east - 1
  /// Of a face, in each row from `north`: columns begin ... end - 1.
  std::array<int, tile_height> begin, end;

  Tile(const Raster& raster, int row, int column)
      : north(row),
        south(std::min(row + tile_height, raster.height)),
        west(column),
        east(std::min(column + tile_width, raster.width)) {
    samples_.fill(std::numeric_limits<double>::quiet_NaN());
  }

  double* row(int j) { return samples_.data() + (j - north) * pitch; }
  bool holds(const Corner& c) const { return c.row >= north && c.row < south && c.column >= west && c.column < east; }
  void store(Raster& raster) {
    for (int j = north; j < south; ++j)
      std::copy_n(row(j), east - west, raster.samples.data() + static_cast<std::size_t>(j) * raster.width + west);
  }

 private:
  static constexpr int pitch = tile_width + 8;  // no power of two either
  std::array<double, tile_height * pitch> samples_;
};

class Rasterizer {
 public:
  Rasterizer(const Tin& tin, Raster& raster, Context& context)
      : tin_(tin), raster_(raster), context_(context), places_(raster, tin) {}

  void run() {
    find_cells();
    sort_into_tiles();
    // One task makes a row of tiles: two that lie beside each other share pages of memory, and threads would wait for
    // each other at the first touch.
    parallel_tasks(context_, (first_.size() - 1) / across_, [&](std::size_t j) {
      for (int i = 0; i < across_; ++i) {
        Tile tile(raster_, static_cast<int>(j) * tile_height, i * tile_width);
        const std::size_t k = j * across_ + i;
        for (std::size_t f = first_[k]; f < first_[k + 1]; ++f) fill(triangle(tin_.faces[faces_[f]]), tile);
        tile.store(raster_);
      }
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

  void find_cells() {
    cells_.resize(tin_.vertices.size());
    parallel_for(context_, cells_.size(), 16384, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const Point& p = tin_.vertices[v];
        const int row = last(std::floor((raster_.y0 - p.y) / raster_.dy), raster_.height,
                             [&](int j) { return places_.y[j] >= p.y; });
        const int column =
            last(std::ceil(places_.column(p.x)) - 1, raster_.width, [&](int i) { return places_.x[i] < p.x; }) + 1;
        const bool on_row = row >= 0 && places_.y[row] == p.y;
        const bool on_column = column < raster_.width && places_.x[column] == p.x;
        cells_[v] = {row, row + !on_row, column, column - !on_column};
      }
    });
  }

  Triangle triangle(const Face& f) const {
    Index a = f[0], b = f[1], c = f[2];
    const auto order = [&](Index& south, Index& north) {
      const Point &p = tin_.vertices[south], &q = tin_.vertices[north];
      const bool wrong = (q.y < p.y) | ((q.y == p.y) & (q.x < p.x));  // no branch: it would be a guess
      const Index lower = wrong ? north : south;
      north = wrong ? south : north;
      south = lower;
    };
    order(a, b);
    order(b, c);
    order(a, b);
    const auto corner = [&](Index v) { return Corner{cells_[v], tin_.vertices[v]}; };
    return {corner(a), corner(b), corner(c),
            orientation(plan(tin_.vertices[a]), plan(tin_.vertices[b]), plan(tin_.vertices[c]))};
  }

  /// faces_[first_[k]] ... are the faces whose boxes reach tile k.
  void sort_into_tiles() {
    across_ = (raster_.width + tile_width - 1) / tile_width;
    const std::size_t tiles = static_cast<std::size_t>(across_) * ((raster_.height + tile_height - 1) / tile_height);
    const auto each = [&](auto visit) {
      for (std::size_t f = 0; f < tin_.faces.size(); ++f) {
        const Cell &a = cells_[tin_.faces[f][0]], &b = cells_[tin_.faces[f][1]], &c = cells_[tin_.faces[f][2]];
        const int north = std::min({a.first_row, b.first_row, c.first_row});
        const int south = std::max({a.row, b.row, c.row});
        const int west = std::min({a.column, b.column, c.column});
        const int east = std::max({a.last_column, b.last_column, c.last_column});
        if (north > south || west > east) continue;
        for (int j = north / tile_height; j <= south / tile_height; ++j)
          for (int i = west / tile_width; i <= east / tile_width; ++i) visit(f, j * across_ + i);
      }
    };
    first_.assign(tiles + 1, 0);
    each([&](std::size_t, int k) { ++first_[k + 1]; });
    for (std::size_t k = 0; k < tiles; ++k) first_[k + 1] += first_[k];
    faces_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    each([&](std::size_t f, int k) { faces_[next[k]++] = static_cast<Index>(f); });
  }

  /// Raises the tile's samples that a face holds. The columns are found for all rows before any is raised: how many
  /// there are cannot be foreseen, and a processor that guessed wrong in the midst of finding them starts anew.
  void fill(const Triangle& t, Tile& tile) {
    if (t.turn == 0) return;
    const int first = std::max(tile.north, t.top.first_row), past = std::min(tile.south, t.low.row + 1);
    if (first >= past) return;
    const Plane plane(t);
    const Side whole(t.low, t.top, places_);
    const int middle = t.low.at.y == t.mid.at.y ? past : std::clamp(t.mid.first_row, first, past);
    if (first < middle) find_columns(t, whole, {t.mid, t.top, places_}, first, middle, tile);
    if (middle < past) find_columns(t, whole, {t.low, t.mid, places_}, middle, past, tile);
    for (int j = first; j < past; ++j) {
      const int k = j - tile.north;
      plane.raise(places_.y[j], places_.x.data() + tile.west, tile.row(j), tile.begin[k] - tile.west,
                  tile.end[k] - tile.west);
    }
  }

  /// Finds the columns between two sides in rows first ... past - 1.
  void find_columns(const Triangle& t, const Side& whole, const Side& part, int first, int past, Tile& tile) {
    const Side &west = t.turn > 0 ? whole : part, &east = t.turn > 0 ? part : whole;
    const double least = tile.west + 0.5, most = tile.east + 0.5;
    const double clear = places_.noise() < 0.25 ? 0.5 - places_.noise() : -1;
    static_assert(tile_height <= 64);
    std::uint64_t doubts = 0, bit = std::uint64_t{1} << (first - tile.north);  // bit k: of row tile.north + k
    for (int j = first; j < past; ++j, bit += bit) {
      const double y = places_.y[j];
      const double u = std::max(least, std::min(most, west.column_at(y) + 1));
      const double v = std::max(least, std::min(most, east.column_at(y) + 1));
      const int begin = static_cast<int>(u), end = static_cast<int>(v);
      const bool doubt = !(std::max(std::fabs(u - begin - 0.5), std::fabs(v - end - 0.5)) < clear);
      const int k = j - tile.north;
      tile.begin[k] = begin;
      tile.end[k] = end;
      doubts |= doubt ? bit : 0;
    }
    for (; doubts != 0; doubts &= doubts - 1) {
      const int k = std::countr_zero(doubts), j = tile.north + k;
      tile.begin[k] = std::max(tile.west, first_east(west, j));
      tile.end[k] = std::min(tile.east, last_west(east, j) + 1);
      for (const Corner* c : {&t.low, &t.mid, &t.top})
        if (c->row == j && c->on_sample() && tile.holds(*c)) raise_corner(*c, tile);
    }
  }

  /// Raises the sample at a corner to it, and takes its column out.
  void raise_corner(const Corner& c, Tile& tile) {
    raise_to(tile.row(c.row)[c.column - tile.west], c.at.z + 0.0);
    int &begin = tile.begin[c.row - tile.north], &end = tile.end[c.row - tile.north];
    if (begin == c.column) ++begin;
    if (end == c.column + 1) --end;
  }

  /// The first column at or east of a side.
  int first_east(const Side& side, int j) const {
    if (const Corner* c = side.corner_on(j)) return c->column;
    return column(side, j, [&](int i) { return turn(side, i, j) > 0; }) + 1;
  }

  /// The last column at or west of a side.
  int last_west(const Side& side, int j) const {
    if (const Corner* c = side.corner_on(j)) return c->last_column;
    return column(side, j, [&](int i) { return turn(side, i, j) >= 0; });
  }

  /// The last column west of a side in row j, as `west` says where it is close.
  template <class West>
  int column(const Side& side, int j, West west) const {
    const int width = raster_.width;
    const double noise = places_.noise(), u = side.column_at(places_.y[j]);
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
  Array<Cell> cells_;
  int across_ = 0;
  std::vector<std::size_t> first_;
  std::vector<Index> faces_;
};

}  // namespace

Raster rasterize(const Tin& tin, Raster lattice, Context& context) {
  lattice.samples = {};
  check_lattice(lattice);
  lattice.samples.resize(static_cast<std::size_t>(lattice.width) * lattice.height);
  if (!lattice.samples.empty()) Rasterizer(tin, lattice, context).run();
  return lattice;
}

}  // namespace terrane
