// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/lattice/triangulate_domain.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/lattice/thin_line.hpp"

namespace terrane {

namespace {

// Sides of a cell that belong to the domain's part in it: all four, two where one corner is void, else none.
enum Side : std::uint8_t { bottom = 1, right = 2, top = 4, left = 8 };

constexpr std::uint8_t kept_bit = 0x80;

class BorderFinder {
 public:
  BorderFinder(const Raster& dem, double tolerance)
      : dem_(dem), tolerance_(tolerance), width_(dem.width), height_(dem.height) {}

  LatticeBorder find() {
    if (std::none_of(dem_.samples.begin(), dem_.samples.end(), [](double z) { return std::isnan(z); })) {
      rectangle();
    } else {
      find_cells();
      count_edges();
      keep_outermost();
      trace();
    }
    return number();
  }

 private:
  using Key = std::uint64_t;

  double z(int x, int y) const { return dem_.at(x, height_ - 1 - y); }
  bool exists(int x, int y) const { return !std::isnan(z(x, y)); }
  Key key(int x, int y) const { return static_cast<Key>(y) * width_ + x; }
  std::uint8_t& state(int x, int y) { return state_[key(x, y)]; }
  std::uint8_t cell(int x, int y) const {
    return x < 0 || y < 0 || x >= width_ - 1 || y >= height_ - 1 ? 0 : cells_[key(x, y)];
  }

  /// +1: border along this row with the domain above, -1: below, 0: no border.
  int row_edge(int x, int y) const { return ((cell(x, y) & bottom) != 0) - ((cell(x, y - 1) & top) != 0); }
  /// +1: border along this column with the domain to the right, -1: to the left, 0: no border.
  int column_edge(int x, int y) const { return ((cell(x, y) & left) != 0) - ((cell(x - 1, y) & right) != 0); }

  void find_cells() {
    cells_.assign(dem_.samples.size(), 0);
    for (int y = 0; y + 1 < height_; ++y) {
      for (int x = 0; x + 1 < width_; ++x) {
        const bool ll = exists(x, y), lr = exists(x + 1, y), ul = exists(x, y + 1), ur = exists(x + 1, y + 1);
        const int count = ll + lr + ul + ur;
        if (count < 3) continue;
        cells_[key(x, y)] = static_cast<std::uint8_t>((ll && lr ? bottom : 0) | (lr && ur ? right : 0) |
                                                      (ul && ur ? top : 0) | (ll && ul ? left : 0));
      }
    }
  }

  /// Calls visit(x0, y0, x1, y1) for the slanted border of a cell with one void corner, the domain to its left.
  template <class Visit>
  void diagonal(int x, int y, Visit visit) const {
    switch (cell(x, y)) {
      case right | top:
        visit(x, y + 1, x + 1, y);
        break;
      case top | left:
        visit(x, y, x + 1, y + 1);
        break;
      case bottom | right:
        visit(x + 1, y + 1, x, y);
        break;
      case bottom | left:
        visit(x + 1, y, x, y + 1);
        break;
      default:
        break;
    }
  }

  void count_edges() {
    state_.assign(dem_.samples.size(), 0);
    const auto count = [&](int x0, int y0, int x1, int y1) { ++state(x0, y0), ++state(x1, y1); };
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        if (row_edge(x, y) != 0) count(x, y, x + 1, y);
        if (column_edge(x, y) != 0) count(x, y, x, y + 1);
        diagonal(x, y, [&](int x0, int y0, int x1, int y1) {
          count(x0, y0, x1, y1);
          state(x0, y0) |= kept_bit;
          state(x1, y1) |= kept_bit;
        });
      }
    }
  }

  void keep_outermost() {
    const auto line = [&](int length, auto place) {
      thin_runs(
          length, [&](int k) { return z(place(k)[0], place(k)[1]); }, tolerance_,
          [&](int k) { state(place(k)[0], place(k)[1]) |= kept_bit; });
    };
    for (const int y : {0, height_ - 1}) line(width_, [y](int k) { return std::array{k, y}; });
    for (const int x : {0, width_ - 1}) line(height_, [x](int k) { return std::array{x, k}; });
  }

  /// The edges of a straight line of n samples from (x, y) on; `forward`: the domain lies to the left of its direction.
  void emit(int x, int y, bool along_row, int n, bool forward) {
    const auto place = [&](int k) { return along_row ? std::array{x + k, y} : std::array{x, y + k}; };
    std::vector<int> kept{0, n};
    thin_line(
        n, [&](int k) { return z(place(k)[0], place(k)[1]); }, tolerance_, [&](int k) { kept.push_back(k); });
    std::sort(kept.begin(), kept.end());
    for (std::size_t i = 0; i + 1 < kept.size(); ++i) {
      const auto p = place(kept[i]), q = place(kept[i + 1]);
      add(forward ? p : q, forward ? q : p);
    }
  }

  void add(std::array<int, 2> from, std::array<int, 2> to) {
    edges_.push_back({key(from[0], from[1]), key(to[0], to[1])});
  }

  void rectangle() {
    emit(0, 0, true, width_ - 1, true);
    emit(width_ - 1, 0, false, height_ - 1, true);
    emit(0, height_ - 1, true, width_ - 1, false);
    emit(0, 0, false, height_ - 1, false);
  }

  bool passes(int x, int y) { return state(x, y) == 2; }

  void trace() {
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x + 1 < width_;) {
        const int side = row_edge(x, y);
        int n = 1;
        while (side != 0 && x + n + 1 < width_ && passes(x + n, y) && row_edge(x + n, y) == side) ++n;
        if (side != 0) emit(x, y, true, n, side > 0);
        x += n;
      }
    }
    for (int x = 0; x < width_; ++x) {
      for (int y = 0; y + 1 < height_;) {
        const int side = column_edge(x, y);
        int n = 1;
        while (side != 0 && y + n + 1 < height_ && passes(x, y + n) && column_edge(x, y + n) == side) ++n;
        if (side != 0) emit(x, y, false, n, side < 0);
        y += n;
      }
    }
    for (int y = 0; y + 1 < height_; ++y) {
      for (int x = 0; x + 1 < width_; ++x) {
        diagonal(x, y, [&](int x0, int y0, int x1, int y1) { add({x0, y0}, {x1, y1}); });
      }
    }
  }

  LatticeBorder number() const {
    std::vector<Key> keys;
    for (const auto& [a, b] : edges_) keys.insert(keys.end(), {a, b});
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    LatticeBorder border;
    for (const Key k : keys) border.points.push_back({static_cast<int>(k % width_), static_cast<int>(k / width_)});
    const auto index = [&](Key k) {
      return static_cast<Index>(std::lower_bound(keys.begin(), keys.end(), k) - keys.begin());
    };
    for (const auto& [a, b] : edges_) border.edges.push_back({index(a), index(b)});
    return border;
  }

  const Raster& dem_;
  double tolerance_;
  int width_, height_;
  std::vector<std::uint8_t> cells_;  // sides of the cell north-east of a sample that are in the domain
  std::vector<std::uint8_t> state_;  // border edges at a sample, and whether it must be kept
  std::vector<std::array<Key, 2>> edges_;
};

}  // namespace

LatticeBorder find_border(const Raster& dem, double tolerance) { return BorderFinder(dem, tolerance).find(); }

}  // namespace terrane
