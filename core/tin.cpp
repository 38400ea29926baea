// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tin.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace terrane {

namespace {

/// Four levels of the Hilbert curve at a time: state (0..3) and four bits of x and of y give eight bits of the key and
/// the next state. Bit 0 of a state: x and y swapped; bit 1: both mirrored.
struct HilbertTable {
  std::uint8_t key[4][256] = {};
  std::uint8_t next[4][256] = {};

  constexpr HilbertTable() {
    for (int state = 0; state < 4; ++state) {
      for (int xy = 0; xy < 256; ++xy) {
        int s = state, k = 0;
        for (int level = 3; level >= 0; --level) {
          int x = (xy >> (4 + level)) & 1, y = (xy >> level) & 1;
          if (s & 2) x ^= 1, y ^= 1;
          if (s & 1) std::swap(x, y);
          k = 4 * k + ((3 * x) ^ y);
          if (y == 0) s ^= x ? 3 : 1;
        }
        key[state][xy] = static_cast<std::uint8_t>(k);
        next[state][xy] = static_cast<std::uint8_t>(s);
      }
    }
  }
};

std::uint64_t hilbert_key(std::uint32_t x, std::uint32_t y) {
  static constexpr HilbertTable table;
  std::uint64_t key = 0;
  int state = 0;
  for (int shift = 28; shift >= 0; shift -= 4) {
    const int xy = static_cast<int>((x >> shift & 15) << 4 | (y >> shift & 15));
    key = key << 8 | table.key[state][xy];
    state = table.next[state][xy];
  }
  return key;
}

/// Place on the curve's grid of 2^32 cells: monotone, and never undefined, whatever the number.
std::uint32_t grid_place(double x, double low, double half_extent) {
  const double t = (0.5 * x - 0.5 * low) / half_extent;
  if (!(t > 0)) return 0;
  return t >= 1 ? std::numeric_limits<std::uint32_t>::max() : static_cast<std::uint32_t>(t * 4294967295.0);
}

struct Keyed {
  std::uint64_t key;
  Index vertex;
};

/// A total order on doubles, NaN included, so that no input can confuse a sort.
std::uint64_t ordered(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  return bits >> 63 ? ~bits : bits | std::uint64_t{1} << 63;
}

bool before(const Point& a, const Point& b) {
  if (ordered(a.x) != ordered(b.x)) return ordered(a.x) < ordered(b.x);
  if (ordered(a.y) != ordered(b.y)) return ordered(a.y) < ordered(b.y);
  return ordered(a.z) < ordered(b.z);
}

/// Sorts by key, then by coordinates. Three radix passes settle the upper 33 bits, which tell most vertices apart; the
/// few that share them are compared.
void sort_keyed(std::vector<Keyed>& keyed, const std::vector<Point>& points) {
  constexpr int bits = 11, buckets = 1 << bits;
  std::vector<Keyed> other(keyed.size());
  for (int shift = 64 - 3 * bits; shift < 64; shift += bits) {
    std::vector<Index> start(buckets + 1, 0);
    for (const Keyed& k : keyed) ++start[(k.key >> shift & (buckets - 1)) + 1];
    for (int b = 0; b < buckets; ++b) start[b + 1] += start[b];
    for (const Keyed& k : keyed) other[start[k.key >> shift & (buckets - 1)]++] = k;
    keyed.swap(other);
  }
  const auto less = [&](const Keyed& a, const Keyed& b) {
    return a.key != b.key ? a.key < b.key : before(points[a.vertex], points[b.vertex]);
  };
  for (std::size_t i = 0; i < keyed.size();) {
    std::size_t end = i + 1;
    while (end < keyed.size() && keyed[end].key >> (64 - 3 * bits) == keyed[i].key >> (64 - 3 * bits)) ++end;
    if (end - i > 1) std::sort(keyed.begin() + i, keyed.begin() + end, less);
    i = end;
  }
}

/// The used vertices along the curve; those alike in all three coordinates next to each other.
std::vector<Keyed> curve_order(const Tin& tin) {
  std::vector<std::uint8_t> used(tin.vertices.size(), 0);
  for (const Face& f : tin.faces) used[f[0]] = used[f[1]] = used[f[2]] = 1;
  Box box{INFINITY, INFINITY, -INFINITY, -INFINITY};
  std::size_t count = 0;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    const Point& p = tin.vertices[v];
    box = {std::min(box.xmin, p.x), std::min(box.ymin, p.y), std::max(box.xmax, p.x), std::max(box.ymax, p.y)};
    ++count;
  }
  const double half_extent = std::max(0.5 * box.xmax - 0.5 * box.xmin, 0.5 * box.ymax - 0.5 * box.ymin);
  std::vector<Keyed> keyed;
  keyed.reserve(count);
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    const Point& p = tin.vertices[v];
    keyed.push_back({hilbert_key(grid_place(p.x, box.xmin, half_extent), grid_place(p.y, box.ymin, half_extent)),
                     static_cast<Index>(v)});
  }
  sort_keyed(keyed, tin.vertices);
  return keyed;
}

/// Faces by first corner (which is their lowest), then second, then third.
std::vector<Face> sorted_faces(const std::vector<Face>& faces, std::size_t vertex_count) {
  std::vector<Index> start(vertex_count + 1, 0);
  for (const Face& f : faces) ++start[f[0] + 1];
  for (std::size_t v = 0; v < vertex_count; ++v) start[v + 1] += start[v];
  std::vector<Face> sorted(faces.size());
  for (const Face& f : faces) sorted[start[f[0]]++] = f;
  for (std::size_t i = 0; i < sorted.size();) {
    std::size_t end = i + 1;
    while (end < sorted.size() && sorted[end][0] == sorted[i][0]) ++end;
    if (end - i > 1) std::sort(sorted.begin() + i, sorted.begin() + end);
    i = end;
  }
  return sorted;
}

}  // namespace

Box bounds(const Tin& tin) {
  Box box{INFINITY, INFINITY, -INFINITY, -INFINITY};
  for (const Point& p : tin.vertices) {
    box = {std::min(box.xmin, p.x), std::min(box.ymin, p.y), std::max(box.xmax, p.x), std::max(box.ymax, p.y)};
  }
  return box;
}

Tin canonical(const Tin& tin) {
  const std::vector<Keyed> order = curve_order(tin);
  Tin result;
  result.vertices.reserve(order.size());
  std::vector<Index> rank(tin.vertices.size(), none);
  for (const Keyed& k : order) {
    const Point& p = tin.vertices[k.vertex];
    // Vertices alike in all coordinates become one: no order among them could be told from the surface. Adding 0 turns
    // -0 into 0, which equals it but would be other bytes.
    if (result.vertices.empty() || !(result.vertices.back() == p)) {
      result.vertices.push_back({p.x + 0.0, p.y + 0.0, p.z + 0.0});
    }
    rank[k.vertex] = static_cast<Index>(result.vertices.size() - 1);
  }
  std::vector<Face> faces;
  faces.reserve(tin.faces.size());
  for (const Face& f : tin.faces) {
    const Index a = rank[f[0]], b = rank[f[1]], c = rank[f[2]];
    if (a < b && a < c) {
      faces.push_back({a, b, c});
    } else if (b < a && b < c) {
      faces.push_back({b, c, a});
    } else if (c < a && c < b) {
      faces.push_back({c, a, b});
    } else {
      faces.push_back(std::min({Face{a, b, c}, Face{b, c, a}, Face{c, a, b}}));
    }
  }
  result.faces = sorted_faces(faces, result.vertices.size());
  return result;
}

}  // namespace terrane
