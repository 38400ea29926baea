// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tin.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "core/box.hpp"
#include "core/mesh/array.hpp"
#include "core/mesh/chains.hpp"
#include "core/mesh/hilbert.hpp"
#include "core/parallel.hpp"

namespace terrane {

namespace {

/// A vertex by the upper bits of its place on the curve, which tell most vertices apart.
using Keyed = std::uint64_t;
constexpr int index_bits = 31;
Index vertex_of(Keyed k) { return static_cast<Index>(k & ((Keyed{1} << index_bits) - 1)); }
bool same_upper(Keyed a, Keyed b) { return a >> index_bits == b >> index_bits; }

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

/// Three radix passes by the upper bits. Each range is counted and then moved by one thread.
void sort_by_upper_bits(Array<Keyed>& keyed, const Context& context) {
  constexpr std::size_t few = 256;  // sorted in less time than buckets are cleared
  if (keyed.size() <= few) return std::sort(keyed.begin(), keyed.end());
  constexpr int bits = 11, buckets = 1 << bits;
  Array<Keyed> other(keyed.size());
  const std::size_t chunk = chunk_for(context, keyed.size());
  std::vector<std::array<Index, buckets>> starts(keyed.size() / chunk + 1);
  for (int shift = index_bits; shift < 64; shift += bits) {
    const auto bucket = [shift](Keyed k) { return k >> shift & (buckets - 1); };
    parallel_for(context, keyed.size(), chunk, [&](std::size_t begin, std::size_t end) {
      auto& counts = starts[begin / chunk];
      counts.fill(0);
      for (std::size_t i = begin; i < end; ++i) ++counts[bucket(keyed[i])];
    });
    Index sum = 0;
    for (int b = 0; b < buckets; ++b)
      for (std::size_t begin = 0; begin < keyed.size(); begin += chunk)
        sum += std::exchange(starts[begin / chunk][b], sum);
    parallel_for(context, keyed.size(), chunk, [&](std::size_t begin, std::size_t end) {
      auto& next = starts[begin / chunk];
      for (std::size_t i = begin; i < end; ++i) other[next[bucket(keyed[i])]++] = keyed[i];
    });
    keyed.swap(other);
  }
}

/// Sorts the vertices from `begin` to `end`, which share their upper bits, by the whole key, then by coordinates.
template <class At>
void sort_alike(Keyed* begin, Keyed* end, const HilbertCurve& curve, const At& at) {
  std::vector<std::pair<std::uint64_t, Keyed>> whole;
  for (const Keyed* k = begin; k != end; ++k) {
    const Point p = at(vertex_of(*k));
    whole.emplace_back(curve.key(p.x, p.y), *k);
  }
  std::sort(whole.begin(), whole.end(), [&](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : before(at(vertex_of(a.second)), at(vertex_of(b.second)));
  });
  for (const auto& [key, k] : whole) *begin++ = k;
}

/// Which vertices some face has; faces whose first corner is none have none.
std::vector<std::uint8_t> used_vertices(std::size_t vertices, std::span<const Face> faces, const Context& context) {
  std::vector<std::uint8_t> used(vertices, 0);
  parallel_for(context, faces.size(), chunk_for(context, faces.size()), [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      if (faces[f][0] != none)
        for (const Index v : faces[f]) std::atomic_ref(used[v]).store(1, std::memory_order_relaxed);
  });
  return used;
}

/// The used vertices along the curve; those alike in all three coordinates next to each other.
template <class At>
Array<Keyed> curve_order(std::size_t vertices, const At& at, std::span<const Face> faces, const Context& context) {
  const std::vector<std::uint8_t> used = used_vertices(vertices, faces, context);
  const std::size_t chunk = chunk_for(context, vertices);
  struct Part {
    Box box = no_box;
    std::size_t count = 0;
  };
  std::vector<Part> parts(vertices / chunk + 1);
  parallel_for(context, vertices, chunk, [&](std::size_t begin, std::size_t end) {
    Part part;
    for (std::size_t v = begin; v < end; ++v) {
      if (!used[v]) continue;
      part.box = around(part.box, plan(at(v)));
      ++part.count;
    }
    parts[begin / chunk] = part;
  });
  Box box = no_box;
  std::size_t count = 0;
  for (Part& part : parts) {
    box = around(box, part.box);
    count += std::exchange(part.count, count);
  }
  const HilbertCurve curve(box);
  Array<Keyed> keyed(count);
  parallel_for(context, vertices, chunk, [&](std::size_t begin, std::size_t end) {
    Keyed* to = keyed.data() + parts[begin / chunk].count;
    for (std::size_t v = begin; v < end; ++v) {
      if (!used[v]) continue;
      const Point p = at(v);
      *to++ = curve.upper_key<40>(p.x, p.y) >> index_bits << index_bits | v;
    }
  });
  sort_by_upper_bits(keyed, context);
  std::vector<std::size_t> stops;
  for (std::size_t i = 0; i < count; i += chunk_for(context, count)) {
    while (i > 0 && i < count && same_upper(keyed[i], keyed[i - 1])) ++i;
    stops.push_back(i);
  }
  stops.push_back(count);
  parallel_tasks(context, stops.size() - 1, [&](std::size_t r) {
    for (std::size_t i = stops[r]; i < stops[r + 1];) {
      std::size_t end = i + 1;
      while (end < stops[r + 1] && same_upper(keyed[end], keyed[i])) ++end;
      if (end - i > 1) sort_alike(&keyed[i], &keyed[end], curve, at);
      i = end;
    }
  });
  return keyed;
}

/// The face from its lowest corner on; the least of three where rounding to one vertex made two corners the same.
Face from_lowest(Index a, Index b, Index c) {
  if (a < b && a < c) return {a, b, c};
  if (b < a && b < c) return {b, c, a};
  if (c < a && c < b) return {c, a, b};
  return std::min({Face{a, b, c}, Face{b, c, a}, Face{c, a, b}});
}

/// Sorts faces with the same first corner, mostly two or three.
void sort_few(Face* begin, Face* end) {
  constexpr std::ptrdiff_t few = 8;
  if (end - begin > few) return std::sort(begin, end);
  const auto key = [](const Face& f) {
    return std::uint64_t{static_cast<std::uint32_t>(f[1])} << 32 | static_cast<std::uint32_t>(f[2]);
  };
  for (Face* at = begin; at < end; ++at) {
    const Face face = *at;
    Face* to = at;
    for (; to > begin && key(face) < key(to[-1]); --to) *to = to[-1];
    *to = face;
  }
}

/// canonical() of vertices and faces wherever they lie; faces whose first corner is none are left out.
template <class At>
Tin reordered(std::size_t vertices, const At& at, std::span<Face> faces, const Context& context) {
  const Array<Keyed> order = curve_order(vertices, at, faces, context);
  // Vertices alike in all coordinates become one: no order among them could be told from the surface.
  const auto fresh = [&](std::size_t i) {
    return i == 0 || !same_upper(order[i], order[i - 1]) || !(at(vertex_of(order[i])) == at(vertex_of(order[i - 1])));
  };
  const std::size_t chunk = chunk_for(context, order.size());
  std::vector<std::size_t> start(order.size() / chunk + 2, 0);
  parallel_for(context, order.size(), chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) start[begin / chunk + 1] += fresh(i);
  });
  for (std::size_t r = 1; r < start.size(); ++r) start[r] += start[r - 1];
  Array<Index> rank(vertices);
  parallel_for(context, order.size(), chunk, [&](std::size_t begin, std::size_t end) {
    auto last = static_cast<Index>(start[begin / chunk]) - 1;
    for (std::size_t i = begin; i < end; ++i) rank[vertex_of(order[i])] = last += fresh(i);
  });
  const auto renumber = [&](std::size_t begin, std::size_t end, const auto& hang) {
    for (std::size_t f = begin; f < end; ++f) {
      if (faces[f][0] == none) continue;
      faces[f] = from_lowest(rank[faces[f][0]], rank[faces[f][1]], rank[faces[f][2]]);
      hang(faces[f][0], static_cast<Index>(f));
    }
  };
  const Chains at_lowest = chains(start.back(), faces.size(), faces.size(), context, renumber);

  Tin result;
  parallel_tasks(context, 2, [&](std::size_t i) {  // the first touch of memory costs more than what is done there
    i == 0 ? result.vertices.resize(start.back()) : result.faces.resize(at_lowest.count());
  });
  parallel_for(context, order.size(), chunk, [&](std::size_t begin, std::size_t end) {
    std::size_t next = start[begin / chunk];
    for (std::size_t i = begin; i < end; ++i) {
      if (!fresh(i)) continue;
      const Point p = at(vertex_of(order[i]));
      result.vertices[next++] = {p.x + 0.0, p.y + 0.0, p.z + 0.0};  // turns -0 into 0, which would be other bytes
    }
  });
  at_lowest.for_ranges(context, [&](const Chains::Range& range) {
    Face* to = result.faces.data() + range.before;
    for (Index v = range.low; v < range.high; ++v) {
      Face* const begin = to;
      for (Index f = at_lowest.first[v]; f != none; f = at_lowest.next[f]) *to++ = faces[f];
      sort_few(begin, to);
    }
  });
  return result;
}

/// Would canonical() change nothing? So it is with what it made, and with files of that. False, most often at once, of
/// anything else, and where a coordinate is not finite.
bool is_canonical(std::span<const Point> vertices, std::span<const Face> faces, const Context& context) {
  std::atomic<bool> is = true;
  parallel_for(context, faces.size(), chunk_for(context, faces.size()), [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto [a, b, c] = faces[f];
      const bool from_low = (a < b && a < c) || faces[f] == from_lowest(a, b, c);
      const bool in_order = f == 0 || faces[f - 1][0] < a || faces[f - 1] <= faces[f];
      if (a == none || !from_low || !in_order) return is.store(false);
    }
  });
  if (!is) return false;
  const HilbertCurve curve(bounds(vertices, context));
  const auto plain = [](double v) { return std::isfinite(v) && !(v == 0 && std::signbit(v)); };
  parallel_for(context, vertices.size(), chunk_for(context, vertices.size()), [&](std::size_t begin, std::size_t end) {
    const auto upper_key = [&](const Point& p) { return curve.upper_key<40>(p.x, p.y); };
    const auto follows = [&](const Point& p, const Point& q) {
      const std::uint64_t of_p = curve.key(p.x, p.y), of_q = curve.key(q.x, q.y);
      return of_p != of_q ? of_p < of_q : before(p, q);
    };
    std::uint64_t last = begin > 0 ? upper_key(vertices[begin - 1]) : 0;
    for (std::size_t v = begin; v < end; ++v) {
      const Point& p = vertices[v];
      const std::uint64_t key = upper_key(p);
      if (!plain(p.x) || !plain(p.y) || !plain(p.z)) return is.store(false);
      if (key < last || (key == last && v > 0 && !follows(vertices[v - 1], p))) return is.store(false);
      last = key;
    }
  });
  if (!is) return false;
  const std::vector<std::uint8_t> used = used_vertices(vertices.size(), faces, context);
  return std::find(used.begin(), used.end(), 0) == used.end();
}

}  // namespace

Box bounds(std::span<const Point> vertices, const Context& context) {
  const std::size_t chunk = chunk_for(context, vertices.size());
  std::vector<Box> boxes(vertices.size() / chunk + 1, no_box);
  parallel_for(context, vertices.size(), chunk, [&](std::size_t begin, std::size_t end) {
    Box box = no_box;
    for (const Point& p : vertices.subspan(begin, end - begin)) box = around(box, plan(p));
    boxes[begin / chunk] = box;
  });
  return std::accumulate(boxes.begin(), boxes.end(), no_box, [](const Box& a, const Box& b) { return around(a, b); });
}

Box bounds(const Tin& tin) { return bounds(tin.vertices, Context()); }

HeightSpan height_span(const Tin& tin) {
  if (tin.vertices.empty()) return {};
  HeightSpan span{INFINITY, -INFINITY};
  for (const Point& p : tin.vertices) span = {std::min(span.low, p.z), std::max(span.high, p.z)};
  return span;
}

Tin canonical(std::span<const Point> vertices, std::vector<Face> faces, const Context& context) {
  if (is_canonical(vertices, faces, context)) return {{vertices.begin(), vertices.end()}, std::move(faces)};
  return reordered(
      vertices.size(), [=](std::size_t v) { return vertices[v]; }, faces, context);
}

Tin canonical(Tin tin, const Context& context) {
  if (is_canonical(tin.vertices, tin.faces, context)) return tin;
  return reordered(
      tin.vertices.size(), [&](std::size_t v) { return tin.vertices[v]; }, tin.faces, context);
}

Tin canonical(std::span<const Point2> points, std::span<const double> z, std::span<Face> faces,
              const Context& context) {
  const auto at = [&](std::size_t v) { return Point{points[v].x, points[v].y, z[v]}; };
  return reordered(points.size(), at, faces, context);
}

Tin canonical(Tin tin) { return canonical(std::move(tin), Context()); }

}  // namespace terrane
