// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <atomic>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/mesh/chains.hpp"
#include "core/parallel.hpp"
#include "core/predicates.hpp"
#include "core/topology.hpp"

// In canonical order the faces around their lowest vertex stand together, and two of the three edges of a face have
// that vertex as their lower end: only the third has to be hung somewhere. Edges are matched at their lower ends and
// nothing is kept of those that have a face on either side.
namespace terrane {
namespace {

bool is_finite(const Point& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

/// Is the face positive, exactly, and finite?
bool is_positive(const Point& a, const Point& b, const Point& c) {
  const double l = (b.x - a.x) * (c.y - a.y), r = (b.y - a.y) * (c.x - a.x);
  const bool level = (a.z - a.z) + (b.z - b.z) + (c.z - c.z) == 0;
  if (l - r > orientation_bound(l, r) && level) return true;  // never so where some coordinate is not finite
  return is_finite(a) && is_finite(b) && is_finite(c) && orientation_exact(plan(a), plan(b), plan(c)) > 0;
}

/// A half-edge as its lower end sees it.
struct Spoke {
  Index other, half_edge;
};

/// The edges of one vertex to higher ones.
class Spokes {
 public:
  void clear() { out_.clear(), in_.clear(); }
  void add_out(Index other, Index half_edge) { out_.push_back({other, half_edge}); }
  void add_in(Index other, Index half_edge) { in_.push_back({other, half_edge}); }

  /// Lists the half-edges without a partner. False when two of them run the same way.
  bool match(Index low, std::vector<BorderHalfEdge>& border) {
    if (all_paired()) return true;
    const auto before = [](const Spoke& a, const Spoke& b) { return a.other < b.other; };
    const auto same = [](const Spoke& a, const Spoke& b) { return a.other == b.other; };
    std::sort(out_.begin(), out_.end(), before);
    std::sort(in_.begin(), in_.end(), before);
    if (std::adjacent_find(out_.begin(), out_.end(), same) != out_.end()) return false;
    if (std::adjacent_find(in_.begin(), in_.end(), same) != in_.end()) return false;
    for (const Spoke& s : out_)
      if (!std::binary_search(in_.begin(), in_.end(), s, before)) border.push_back({s.half_edge, low, s.other});
    for (const Spoke& s : in_)
      if (!std::binary_search(out_.begin(), out_.end(), s, before)) border.push_back({s.half_edge, s.other, low});
    return true;
  }

 private:
  /// As at most vertices, where they are few: each of those that leave has one that arrives, and no two of them the
  /// same.
  bool all_paired() const {
    constexpr std::size_t few = 12;
    const std::size_t n = out_.size();
    if (n != in_.size() || n > few) return false;
    bool paired = true;
    for (std::size_t i = 0; i < n; ++i) {
      int partners = 0, twins = 0;
      for (std::size_t j = 0; j < n; ++j) {
        partners += in_[j].other == out_[i].other;
        twins += out_[j].other == out_[i].other;
      }
      paired &= partners == 1 && twins == 1;
    }
    return paired;
  }

  std::vector<Spoke> out_, in_;
};

/// Does any place have two vertices of the border?
bool places_are_shared(const Tin& tin, const std::vector<BorderHalfEdge>& border) {
  std::vector<Index> vertices;
  for (const BorderHalfEdge& e : border) vertices.push_back(e.from), vertices.push_back(e.to);
  const auto key = [&](Index v) { return std::tuple(tin.vertices[v].x, tin.vertices[v].y, v); };
  std::sort(vertices.begin(), vertices.end(), [&](Index a, Index b) { return key(a) < key(b); });
  return std::adjacent_find(vertices.begin(), vertices.end(), [&](Index a, Index b) {
           return a != b && plan(tin.vertices[a]) == plan(tin.vertices[b]);
         }) != vertices.end();
}

}  // namespace

std::optional<std::vector<BorderHalfEdge>> sound_border(const Tin& tin, const Context& context) {
  const std::vector<Point>& vertices = tin.vertices;  // clang 14 lets no lambda capture a structured binding
  const std::vector<Face>& faces = tin.faces;
  const auto n = static_cast<Index>(vertices.size());
  std::atomic<bool> sound = true;
  const Chains far = chains(n, faces.size(), faces.size(), context, [&](auto begin, auto end, const auto& hang) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto [a, b, c] = faces[f];
      const bool in_order = a >= 0 && a < b && a < c && b < n && c < n && (f == 0 || faces[f - 1][0] <= a);
      if (!in_order || !is_positive(vertices[a], vertices[b], vertices[c])) return sound.store(false);
      hang(std::min(b, c), static_cast<Index>(f));
    }
  });
  if (!sound) return {};
  std::vector<std::vector<BorderHalfEdge>> found(far.ranges.size());
  far.for_ranges(context, [&](const Chains::Range& range) {
    std::vector<BorderHalfEdge>& border = found[&range - far.ranges.data()];
    Spokes spokes;
    const auto at_range =
        std::partition_point(faces.begin(), faces.end(), [&](const Face& f) { return f[0] < range.low; });
    auto own = static_cast<Index>(at_range - faces.begin());
    for (Index v = range.low; v < range.high; ++v) {
      spokes.clear();
      for (; own < static_cast<Index>(faces.size()) && faces[own][0] == v; ++own) {
        spokes.add_out(faces[own][1], 3 * own);
        spokes.add_in(faces[own][2], 3 * own + 2);
      }
      for (Index f = far.first[v]; f != none; f = far.next[f])
        faces[f][1] == v ? spokes.add_out(faces[f][2], 3 * f + 1) : spokes.add_in(faces[f][1], 3 * f + 1);
      if (!spokes.match(v, border)) return sound.store(false);
    }
  });
  if (!sound) return {};
  for (std::size_t r = 1; r < found.size(); ++r) found[0].insert(found[0].end(), found[r].begin(), found[r].end());
  std::sort(found[0].begin(), found[0].end(), [](auto& a, auto& b) { return a.half_edge < b.half_edge; });
  if (places_are_shared(tin, found[0])) return {};
  return std::move(found[0]);
}

}  // namespace terrane
