// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/contour.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

#include "core/error.hpp"
#include "core/mesh/half_edges.hpp"
#include "core/parallel.hpp"
#include "core/topology.hpp"
#include "core/triangle_height.hpp"

// At one level every face, edge and end of an edge is high (z >= L) or low. Faces with both, and corners on either side
// of L, have a piece of contour inside. Edges have one along them where one side is high and the other low: at walls,
// and where both ends lie at L. Pieces are joined through the edges they cross; at a vertex that lies at L, or the end
// of a wall, by going around it through higher ground to where that ends.
namespace terrane {
namespace {

/// Numbers below `keys`, each with a list of items in the order they were added.
struct Lists {
  std::vector<std::size_t> first;
  Array<Index> items;

  std::span<const Index> of(std::size_t key) const { return {items.data() + first[key], first[key + 1] - first[key]}; }
};

/// each(add) calls add(key, item); it is run twice.
template <class Each>
Lists lists(std::size_t keys, const Each& each) {
  Lists made;
  made.first.assign(keys + 2, 0);
  each([&](std::size_t key, Index) { ++made.first[key + 2]; });
  for (std::size_t k = 2; k < made.first.size(); ++k) made.first[k] += made.first[k - 1];
  if (made.first.back() > most_crossings)
    throw Error(ErrorKind::limit, "too-many-crossings",
                "the contours would cross " + std::to_string(made.first.back()) + " faces, more than " +
                    std::to_string(most_crossings) + "; ask for fewer levels, or simplify the surface first");
  made.items.resize(made.first.back());
  each([&](std::size_t key, Index item) { made.items[made.first[key + 1]++] = item; });
  made.first.pop_back();
  return made;
}

/// The surface as contours see it.
struct Ground {
  const Tin& tin;
  HalfEdges mesh;                    // mates across jumps
  std::vector<std::uint8_t> walled;  // per half-edge at a jump: is it closed by a wall? Empty where there are no walls

  double z(Index h) const { return tin.vertices[mesh.from(h)].z; }
  double z_next(Index h) const { return z(next_in_face(h)); }
  double z_third(Index h) const { return z(previous_in_face(h)); }
  bool jumps(Index h) const {
    const Index m = mesh.mate[h];
    return mesh.from(h) != mesh.to(m) || mesh.to(h) != mesh.from(m);
  }
  bool has_wall(Index h) const { return !walled.empty() && walled[h]; }
};

Ground ground(const Tin& tin, const Context& context) {
  Ground made{tin, half_edges(tin, context, true), {}};
  using Edge = std::pair<Index, Index>;
  const auto edge = [](Index a, Index b) { return a < b ? Edge{a, b} : Edge{b, a}; };
  std::vector<Edge> walls;
  Array<Index> place;
  for (const Face& f : tin.faces) {
    if (!is_wall(tin, f)) continue;
    if (place.empty()) place = places(tin.vertices, context);
    for (int k = 0; k < 3; ++k)
      if (place[f[k]] != place[f[(k + 1) % 3]]) walls.push_back(edge(place[f[k]], place[f[(k + 1) % 3]]));
  }
  if (walls.empty()) return made;
  std::sort(walls.begin(), walls.end());
  made.walled.assign(made.mesh.mate.size(), 0);
  for (Index h = 0; h < static_cast<Index>(made.mesh.mate.size()); ++h)
    if (made.mesh.mate[h] != none && made.jumps(h))
      made.walled[h] =
          std::binary_search(walls.begin(), walls.end(), edge(place[made.mesh.from(h)], place[made.mesh.to(h)]));
  return made;
}

/// Is the face on the left of a half-edge high beside it, at its beginning and at its end?
struct Side {
  bool begin, end;
  bool crossed() const { return begin != end; }
};

Side side(const Ground& g, Index h, double level) {
  const double z0 = g.z(h), z1 = g.z_next(h);
  if (z0 == level && z1 == level) {
    const bool high = g.z_third(h) >= level;
    return {high, high};
  }
  return {z0 != level ? z0 > level : z1 > level, z1 != level ? z1 > level : z0 > level};
}

/// Where on the way along half-edge h the level is passed, seen from its left.
double fraction(const Ground& g, Index h, double level) { return (level - g.z(h)) / (g.z_next(h) - g.z(h)); }

/// A piece of contour along an edge, higher ground on its right.
struct EdgePiece {
  enum End : std::uint8_t { here, across, begin, end };  // where the level is passed left and right; the edge's ends
  Index edge;                                            // the lower of its two half-edges
  End from, to;
};

void find_edge_pieces(const Ground& g, Index h, double level, std::vector<EdgePiece>& pieces) {
  using P = EdgePiece;
  const Index m = g.mesh.mate[h];
  const Side left = side(g, h, level), mirrored = side(g, m, level), right{mirrored.end, mirrored.begin};
  if (!left.crossed() && !right.crossed()) {
    if (left.begin == right.begin) return;
    pieces.push_back(left.begin ? P{h, P::end, P::begin} : P{h, P::begin, P::end});
  } else if (!left.crossed() || !right.crossed()) {
    const P::End at = left.crossed() ? P::here : P::across;
    const Side crossed = left.crossed() ? left : right;
    const bool other_high = left.crossed() ? right.begin : left.begin;
    // The part where they differ: where the crossed side is low, if the other is high.
    const bool at_begin = crossed.begin != other_high;
    const P::End far = at_begin ? P::begin : P::end;
    // With higher ground on the left the piece runs against h.
    const bool left_high = left.crossed() ? !other_high : other_high;
    const bool towards_end = !left_high;
    pieces.push_back(towards_end == at_begin ? P{h, far, at} : P{h, at, far});
  } else if (left.begin == right.begin) {
    pieces.push_back(left.begin ? P{h, P::here, P::across} : P{h, P::across, P::here});
  } else {
    const bool left_first = fraction(g, h, level) < 1 - fraction(g, m, level);
    const P::End first = left_first ? P::here : P::across, second = left_first ? P::across : P::here;
    // Before the first place one side is high, after the second the other.
    pieces.push_back(left.begin ? P{h, first, P::begin} : P{h, P::begin, first});
    pieces.push_back(left.begin ? P{h, second, P::end} : P{h, P::end, second});
  }
}

/// Joins the pieces of one level.
class Tracer {
 public:
  /// `number` is scratch, an entry for each face, holding anything.
  Tracer(const Ground& ground, double level, std::span<const Index> faces, std::span<const Index> edges,
         Array<Index>& number)
      : g_(ground), level_(level), faces_(faces), number_(number) {
    for (std::size_t i = 0; i < faces.size(); ++i) number_[faces[i]] = static_cast<Index>(i);
    for (const Index h : edges) find_edge_pieces(g_, h, level, pieces_);
  }

  void trace(std::vector<Contour>& lines) {
    const auto count = static_cast<Index>(faces_.size() + pieces_.size());
    std::vector<Index> next(count);
    std::vector<std::uint8_t> follows(count, 0);
    for (Index i = 0; i < count; ++i) {
      next[i] = successor(i);
      if (next[i] != none) follows[next[i]] = 1;
    }
    for (const bool closed : {false, true})
      for (Index i = 0; i < count; ++i)
        if (next[i] != done && (closed || !follows[i])) collect(i, next, lines);
  }

 private:
  static constexpr Index done = -2;

  bool high(Index h) const { return g_.z(h) >= level_; }

  /// The half-edge by which the contour leaves a face it crosses: from high to low.
  Index exit_of(Index face) const {
    for (Index h = 3 * face; h < 3 * face + 3; ++h)
      if (high(h) && !high(next_in_face(h))) return h;
    return none;
  }

  Index piece_of_face(Index face) const {
    const Index i = number_[face];
    return i >= 0 && i < static_cast<Index>(faces_.size()) && faces_[i] == face ? i : none;
  }

  Index piece_of_edge(Index edge, EdgePiece::End from) const {
    auto it =
        std::lower_bound(pieces_.begin(), pieces_.end(), edge, [](const EdgePiece& p, Index e) { return p.edge < e; });
    for (; it != pieces_.end() && it->edge == edge; ++it)
      if (it->from == from) return static_cast<Index>(faces_.size() + (it - pieces_.begin()));
    return none;
  }

  Index successor(Index piece) const {
    if (piece < static_cast<Index>(faces_.size())) {
      const Index h = exit_of(faces_[piece]);
      if (g_.z(h) == level_) return around(previous_in_face(h));
      const Index m = g_.mesh.mate[h];
      if (m == none) return none;
      if (!g_.jumps(h)) return piece_of_face(m / 3);
      return piece_of_edge(std::min(h, m), h < m ? EdgePiece::here : EdgePiece::across);
    }
    const EdgePiece& p = pieces_[piece - faces_.size()];
    const Index h = p.edge, m = g_.mesh.mate[h];
    switch (p.to) {
      case EdgePiece::here:
        return piece_of_face(h / 3);
      case EdgePiece::across:
        return piece_of_face(m / 3);
      case EdgePiece::end:
        return through(m);
      default:
        return through(h);
    }
  }

  /// From a half-edge whose left side is high where it begins, counter-clockwise around that place: the piece that
  /// leaves it where the high ground ends.
  Index through(Index h) const {
    for (;;) {
      const Index last = previous_in_face(h);
      if (!side(g_, last, level_).end) return piece_of_face(h / 3);
      const Index m = g_.mesh.mate[last];
      if (m == none || !side(g_, m, level_).begin) return along(last);
      h = m;
    }
  }
  /// The same from a half-edge whose left side is high where it ends.
  Index around(Index last) const {
    const Index m = g_.mesh.mate[last];
    return m != none && side(g_, m, level_).begin ? through(m) : along(last);
  }
  /// The piece that leaves the end of a half-edge against it.
  Index along(Index last) const {
    const Index m = g_.mesh.mate[last];
    if (m == none) return none;
    return piece_of_edge(std::min(last, m), last < m ? EdgePiece::end : EdgePiece::begin);
  }

  Point vertex(Index h) const {
    const Point& p = g_.tin.vertices[g_.mesh.from(h)];
    return {p.x, p.y, level_};
  }
  /// Where the level is passed along an edge, the same from both its faces.
  Point crossing(Index h) const {
    Index a = g_.mesh.from(h), b = g_.mesh.to(h);
    if (a > b) std::swap(a, b);
    const Point &p = g_.tin.vertices[a], &q = g_.tin.vertices[b];
    const double t = (level_ - p.z) / (q.z - p.z);
    return {mix(p.x, q.x, t), mix(p.y, q.y, t), level_};
  }

  Point end_of(Index piece, bool last) const {
    if (piece < static_cast<Index>(faces_.size())) {
      Index h = exit_of(faces_[piece]);
      if (last) return g_.z(h) == level_ ? vertex(h) : crossing(h);
      h = 3 * faces_[piece];
      while (high(h) || !high(next_in_face(h))) ++h;
      return g_.z_next(h) == level_ ? vertex(next_in_face(h)) : crossing(h);
    }
    const EdgePiece& p = pieces_[piece - faces_.size()];
    switch (last ? p.to : p.from) {
      case EdgePiece::here:
        return crossing(p.edge);
      case EdgePiece::across:
        return crossing(g_.mesh.mate[p.edge]);
      case EdgePiece::begin:
        return vertex(p.edge);
      default:
        return vertex(next_in_face(p.edge));
    }
  }

  /// The line that begins with a piece; its pieces are done afterwards.
  void collect(Index first, std::vector<Index>& next, std::vector<Contour>& lines) const {
    Contour made{level_, {end_of(first, false)}, false};
    for (Index i = first; i != none && next[i] != done;) {
      const Point p = end_of(i, true);
      if (!(plan(p) == plan(made.line.back()))) made.line.push_back(p);
      i = std::exchange(next[i], done);
    }
    made.closed = made.line.size() > 2 && made.line.front() == made.line.back();
    // What rounding made a point of, or a line there and back.
    if (made.line.size() >= (made.closed ? 4u : 2u)) lines.push_back(std::move(made));
  }

  const Ground& g_;
  double level_;
  std::span<const Index> faces_;
  Array<Index>& number_;
  std::vector<EdgePiece> pieces_;
};

/// The half-open range of levels that [low, high] holds, or (low, high).
std::pair<std::size_t, std::size_t> within(std::span<const double> levels, double low, double high, bool ends) {
  const auto begin =
      ends ? std::lower_bound(levels.begin(), levels.end(), low) : std::upper_bound(levels.begin(), levels.end(), low);
  auto end = begin;
  while (end != levels.end() && (*end < high || (ends && *end == high))) ++end;
  return {begin - levels.begin(), end - levels.begin()};
}

Lists faces_by_level(const Ground& g, std::span<const double> levels) {
  return lists(levels.size(), [&](const auto& add) {
    for (Index f = 0; f < static_cast<Index>(g.mesh.faces.size()); ++f) {
      const double a = g.z(3 * f), b = g.z(3 * f + 1), c = g.z(3 * f + 2);
      const auto [begin, end] = within(levels, std::min({a, b, c}), std::max({a, b, c}), false);
      for (std::size_t l = begin; l < end; ++l) add(l, f);
    }
  });
}

/// Edges that may have a piece along them: level ones and walls.
Lists edges_by_level(const Ground& g, std::span<const double> levels) {
  return lists(levels.size(), [&](const auto& add) {
    for (Index h = 0; h < static_cast<Index>(g.mesh.mate.size()); ++h) {
      const Index m = g.mesh.mate[h];
      if (m <= h) continue;
      double low = std::min(g.z(h), g.z_next(h)), high = std::max(g.z(h), g.z_next(h));
      if (g.jumps(h)) {
        if (!g.has_wall(h)) continue;
        low = std::min({low, g.z(m), g.z_next(m)});
        high = std::max({high, g.z(m), g.z_next(m)});
      } else if (low != high) {
        continue;
      }
      const auto [begin, end] = within(levels, low, high, true);
      for (std::size_t l = begin; l < end; ++l) add(l, h);
    }
  });
}

}  // namespace

std::vector<Contour> contours(const Tin& tin, std::span<const double> levels, Context& context) {
  context.progress("contour", 0);
  const Ground g = ground(tin, context);
  context.progress("contour", 0.3);
  const Lists faces = faces_by_level(g, levels), edges = edges_by_level(g, levels);
  context.progress("contour", 0.5);
  std::vector<std::vector<Contour>> found(levels.size());
  const auto threads = std::min<std::size_t>(std::max(1, context.threads), levels.size());
  parallel_tasks(context, threads, [&](std::size_t t) {
    Array<Index> number;
    number.assign(g.mesh.faces.size(), none);
    for (std::size_t l = t; l < levels.size(); l += threads) {
      context.stop_if_cancelled();
      Tracer(g, levels[l], faces.of(l), edges.of(l), number).trace(found[l]);
    }
  });
  std::vector<Contour> all;
  for (auto& lines : found)
    all.insert(all.end(), std::make_move_iterator(lines.begin()), std::make_move_iterator(lines.end()));
  context.progress("contour", 1);
  return all;
}

}  // namespace terrane
