// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/overlay.hpp"
#include "core/tin.hpp"
#include "support/exact.hpp"
#include "support/small_mesh.hpp"

// Small valid meshes out of any bytes, so that no execution is wasted: points on a 16 x 16 lattice, triangulated by a
// sweep, some diagonals turned, some faces left out.
namespace terrane::fuzz {

class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  unsigned next() { return at_ < size_ ? data_[at_++] : 0; }
  std::size_t left() const { return size_ - at_; }

 private:
  const std::uint8_t* data_;
  std::size_t size_, at_ = 0;
};

/// Where the lattice lies, and whether its points are moved by a few ulps, which rounding takes five times as long for.
struct Frame {
  explicit Frame(unsigned choices) : ulps((choices & 33) == 33), unit(choices & 2 ? 1.0 / 3 : choices & 4 ? 625 : 1) {
    if (choices & 8) x = 500000, y = 4500000;
    if ((choices & 24) == 16) x = y = 1;  // no zero, whose ulp is like no other
  }
  bool ulps;
  double unit, x = 0, y = 0;
};

inline double stepped(double v, int ulps) {
  for (; ulps > 0; --ulps) v = std::nextafter(v, INFINITY);
  for (; ulps < 0; ++ulps) v = std::nextafter(v, -INFINITY);
  return v;
}

/// A byte with the number of points and of turned diagonals, a byte per point, one more with ulps, one per diagonal,
/// one that leaves faces out. May be empty.
inline Tin mesh(Bytes& bytes, const Frame& frame) {
  const unsigned counts = bytes.next();
  std::vector<Point> points;
  for (unsigned i = 0; i < 3 + counts % 6; ++i) {
    const unsigned at = bytes.next(), step = frame.ulps ? bytes.next() : 0;
    const double x = frame.x + frame.unit * (at >> 4), y = frame.y + frame.unit * (at & 15);
    const int dx = static_cast<int>(step & 7) % 5 - 2, dy = static_cast<int>(step >> 3 & 7) % 5 - 2;
    points.push_back({step != 0 && x != 0 ? stepped(x, dx) : x, step != 0 && y != 0 ? stepped(y, dy) : y,
                      static_cast<double>((at * 7 + i * 3) % 11) - 4});
  }
  Tin tin = support::swept(points);
  if (tin.faces.empty()) return tin;
  if (counts >= 192) tin = support::made_delaunay(std::move(tin));
  for (unsigned turned = counts / 6 % 4; turned > 0; --turned) support::flip(tin, bytes.next());
  if (const unsigned out = bytes.next(); out >= 128)
    for (std::size_t f = tin.faces.size(); f-- > 1;)
      if (out >> f % 7 & 1) tin.faces.erase(tin.faces.begin() + static_cast<std::ptrdiff_t>(f));
  return canonical(tin);
}

/// A byte with the options, one with the frame, two meshes.
struct Pair {
  OverlayOptions options;
  Tin a, b;
};
inline Pair pair(Bytes bytes) {
  Pair pair;
  const unsigned choices = bytes.next();
  if (choices & 1) pair.options.snap = 0;
  if ((choices & 14) == 14) pair.options.refinement = Refinement::paste;
  const Frame frame(bytes.next());
  pair.a = mesh(bytes, frame);
  pair.b = mesh(bytes, frame);
  return pair;
}

}  // namespace terrane::fuzz
