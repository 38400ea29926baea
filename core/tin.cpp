// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tin.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/array.hpp"
#include "core/hilbert.hpp"

namespace terrane {

namespace {

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
void sort_keyed(Array<Keyed>& keyed, const std::vector<Point>& points) {
  constexpr int bits = 11, buckets = 1 << bits;
  Array<Keyed> other(keyed.size());
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
Array<Keyed> curve_order(const Tin& tin) {
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
  const HilbertCurve curve(box);
  Array<Keyed> keyed;
  keyed.reserve(count);
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    const Point& p = tin.vertices[v];
    keyed.push_back({curve.key(p.x, p.y), static_cast<Index>(v)});
  }
  sort_keyed(keyed, tin.vertices);
  return keyed;
}

/// The face from its lowest corner on; the least of three where rounding to one vertex made two corners the same.
Face from_lowest(Index a, Index b, Index c) {
  if (a < b && a < c) return {a, b, c};
  if (b < a && b < c) return {b, c, a};
  if (c < a && c < b) return {c, a, b};
  return std::min({Face{a, b, c}, Face{b, c, a}, Face{c, a, b}});
}

/// Faces by first corner (which is their lowest), then second, then third. They hang in a chain at their first corner,
/// so that no more memory than one link each is touched before they are written in their order.
std::vector<Face> sorted_faces(const std::vector<Face>& faces, std::size_t vertex_count) {
  Array<Index> first(vertex_count, none), next(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) next[f] = std::exchange(first[faces[f][0]], static_cast<Index>(f));
  std::vector<Face> sorted;
  sorted.reserve(faces.size());
  for (const Index head : first) {
    const std::size_t begin = sorted.size();
    for (Index f = head; f != none; f = next[f]) sorted.push_back(faces[f]);
    if (sorted.size() - begin > 1) std::sort(sorted.begin() + begin, sorted.end());
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

Tin canonical(Tin tin) {
  const Array<Keyed> order = curve_order(tin);
  Tin result;
  result.vertices.reserve(order.size());
  Array<Index> rank(tin.vertices.size());
  for (const Keyed& k : order) {
    const Point& p = tin.vertices[k.vertex];
    // Vertices alike in all coordinates become one: no order among them could be told from the surface. Adding 0 turns
    // -0 into 0, which equals it but would be other bytes.
    if (result.vertices.empty() || !(result.vertices.back() == p)) {
      result.vertices.push_back({p.x + 0.0, p.y + 0.0, p.z + 0.0});
    }
    rank[k.vertex] = static_cast<Index>(result.vertices.size() - 1);
  }
  for (Face& f : tin.faces) f = from_lowest(rank[f[0]], rank[f[1]], rank[f[2]]);
  result.faces = sorted_faces(tin.faces, result.vertices.size());
  return result;
}

}  // namespace terrane
