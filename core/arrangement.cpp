// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/arrangement.hpp"

#include <algorithm>
#include <string>

#include "core/error.hpp"
#include "core/predicates.hpp"
#include "core/exact_place.hpp"

namespace terrane {
namespace {

bool ahead(Point2 from, Point2 to, Point2 start,
           Point2 end) {  // of collinear points: does from -> to run as start -> end?
  if (start.x != end.x) return (to.x > from.x) == (end.x > start.x);
  return (to.y > from.y) == (end.y > start.y);
}

}  // namespace

Arrangement::Arrangement(const CompletedMesh& a, const CompletedMesh& b, std::vector<Location> b_in_a, Context& context)
    : mesh_{&a, &b},
      base_{0, static_cast<Index>(a.places.size()), static_cast<Index>(a.places.size() + b.places.size())} {
  location_[1] = std::move(b_in_a);
  std::vector<Index> partner(a.places.size(), none);  // place of B on a place of A
  vertex_of_b_.resize(b.places.size());
  for (Index j = 0; j < static_cast<Index>(b.places.size()); ++j) {
    const bool shared = location_[1][j].kind == Location::place;
    vertex_of_b_[j] = shared ? location_[1][j].index : base_[1] + j;
    if (shared) partner[location_[1][j].index] = j;
  }
  location_[0].resize(a.places.size());
  Index hint = 0;
  for (Index i = 0; i < static_cast<Index>(a.places.size()); ++i) {
    location_[0][i] = partner[i] != none ? Location{Location::place, partner[i]} : locate(b, a.at(i), hint);
    hint = face_at(b, location_[0][i]);
  }
  context.progress("overlay", 0.2);
  walk_edges(context);
  order_b_chains();
  for (int m = 0; m < 2; ++m) {
    key_base_[m] = m == 0 ? 0 : key_base_[1];
    key_base_[m + 1] = key_base_[m] + 2 * static_cast<Index>(chains_[m].nodes.size() + mesh_[m]->half.size());
  }
  spoken_for_.assign(key_base_[2], false);
  build_junctions();
  context.progress("overlay", 0.5);
}

void Arrangement::walk_edges(Context& context) {
  const CompletedMesh& a = *mesh_[0];
  position_on_[0].assign(a.places.size(), none);
  position_on_[1].assign(mesh_[1]->places.size(), none);
  chains_[0].first.reserve(a.half.size() + 1);
  // Terrain gives 4 crossings per vertex. Slivers across slivers can give the square of their number, which no memory
  // holds; the second bound keeps the numbers of pieces within 32 bits.
  const std::size_t most = std::min<std::size_t>(10'000'000 + 32 * static_cast<std::size_t>(base_[2]), 400'000'000);
  for (Index e = 0; e < static_cast<Index>(a.half.size()); ++e) {
    if ((e & 0xFFFF) == 0) context.progress("overlay", 0.2 + 0.2 * e / a.half.size());
    chains_[0].first.push_back(static_cast<Index>(chains_[0].nodes.size()));
    walk_edge(e);
    if (crossings_.size() > most)
      throw Error(
          ErrorKind::limit, "too-many-crossings",
          "the surfaces cross each other more than " + std::to_string(most) +
              " times, far more than terrain does: long thin faces lie across each other; triangulate them anew");
  }
  chains_[0].first.push_back(static_cast<Index>(chains_[0].nodes.size()));
}

/// Follows an edge of A through B from face to face, deciding every step by the side on which a vertex of B lies, and
/// records the nodes.
void Arrangement::walk_edge(Index e) {
  const CompletedMesh &a = *mesh_[0], &b = *mesh_[1];
  const Index u = a.origin(a.half[e]), w = a.target(a.half[e]);
  const Point2 U = a.at(u), W = a.at(w);
  const Location from = location_[0][u], to = location_[0][w];
  const auto side = [&](Index place) { return area2_accurate(U, W, b.at(place)); };
  const auto ends_in = [&](Index face) {
    switch (to.kind) {
      case Location::face:
        return to.index == face;
      case Location::edge:
        return (to.index >> 2) == face || (b.twin[to.index] != none && (b.twin[to.index] >> 2) == face);
      case Location::place:
        return b.corner[4 * face] == to.index || b.corner[4 * face + 1] == to.index ||
               b.corner[4 * face + 2] == to.index;
    }
    return false;
  };
  const Index chain_start = chains_[0].first[e];

  Index at_place = none;  // the walk stands on this place of B
  Index exit = none;      // or is about to leave a face through this half-edge, whose origin is right and target left
  double right = 0, left = 0;
  // Having come into the face of g through g (which runs from left to right), where does the line leave it?
  const auto leave = [&](Index g) {
    const Index p = b.apex(g);
    const double d = side(p);
    if (d == 0) {
      at_place = p;
    } else if (d > 0) {
      exit = next_half(g), left = d;
    } else {
      exit = prev_half(g), right = d;
    }
  };
  if (from.kind == Location::place) {
    at_place = from.index;
  } else if (from.kind == Location::edge) {
    const Index h = from.index;
    const double o = side(b.origin(h)), t = side(b.target(h));
    if (o == 0) {  // along the edge
      if (to.kind == Location::edge && b.edge[to.index] == b.edge[h]) return;
      at_place = ahead(U, b.at(b.target(h)), U, W) ? b.target(h) : b.origin(h);
    } else {
      const Index g = o < 0 ? b.twin[h] : h;  // the side of the edge that lies ahead
      if (ends_in(g >> 2)) return;
      right = std::min(o, t), left = std::max(o, t);
      leave(g);
    }
  } else {
    const Index f = from.index;
    if (ends_in(f)) return;
    double d[3];
    for (int k = 0; k < 3; ++k) d[k] = side(b.corner[4 * f + k]);
    for (int k = 0; k < 3; ++k) {
      const int k1 = k == 2 ? 0 : k + 1;
      if (d[k] == 0 && d[k1] > 0) at_place = b.corner[4 * f + k];
      if (d[k] < 0 && d[k1] > 0) exit = 4 * f + k, right = d[k], left = d[k1];
    }
  }

  for (;;) {
    if (at_place != none) {
      const Index v = at_place;
      at_place = none;
      if (to.kind == Location::place && to.index == v) return;
      if (!(from.kind == Location::place && from.index == v)) {
        position_on_[1][v] = static_cast<Index>(chains_[0].nodes.size()) - chain_start;
        chains_[0].nodes.push_back(vertex_of_b_[v]);
      }
      const Point2 V = b.at(v);
      bool found = false;
      for (Index h = b.out[v]; h != none && !found;) {
        const Index q = b.target(h);
        const double dq = side(q);
        if (dq == 0 && ahead(V, b.at(q), U, W)) {
          if (to.kind == Location::edge && b.edge[to.index] == b.edge[h]) return;
          at_place = q;
          found = true;
        } else if (dq < 0) {
          const double da = side(b.apex(h));
          if (da > 0) {
            if (ends_in(h >> 2)) return;
            exit = next_half(h), right = dq, left = da;
            found = true;
          }
        }
        h = b.rotate(h);
        if (h == b.out[v]) break;
      }
      if (!found) throw Error(ErrorKind::internal, "walk", "an edge lost its way around a vertex");
      continue;
    }
    // Through the edge.
    const Index eb = b.edge[exit];
    const bool along = b.half[eb] == exit;
    const Index c = static_cast<Index>(crossings_.size());
    crossings_.push_back({{e, eb}, {static_cast<Index>(chains_[0].nodes.size()) - chain_start, none}, along});
    along_b_.push_back(along ? right / (right - left) : left / (left - right));
    chains_[0].nodes.push_back(base_[2] + c);
    const Index g = b.twin[exit];
    if (ends_in(g >> 2)) return;
    leave(g);
  }
}

/// Sorts what lies on each edge of B along it: by a double parameter, exactly where that cannot tell.
void Arrangement::order_b_chains() {
  const CompletedMesh &a = *mesh_[0], &b = *mesh_[1];
  Chains& chain = chains_[1];
  chain.first.assign(b.half.size() + 2, 0);
  const auto each = [&](auto&& visit) {
    for (std::size_t c = 0; c < crossings_.size(); ++c) visit(crossings_[c].edge[1], base_[2] + static_cast<Index>(c));
    for (Index i = 0; i < base_[1]; ++i)
      if (location_[0][i].kind == Location::edge) visit(b.edge[location_[0][i].index], i);
  };
  each([&](Index e, Index) { ++chain.first[e + 2]; });
  for (std::size_t i = 2; i < chain.first.size(); ++i) chain.first[i] += chain.first[i - 1];
  chain.nodes.resize(chain.first.back());
  each([&](Index e, Index vertex) { chain.nodes[chain.first[e + 1]++] = vertex; });
  chain.first.pop_back();

  struct Keyed {
    double t;
    Index vertex;
  };
  std::vector<Keyed> keyed;
  for (Index e = 0; e < static_cast<Index>(b.half.size()); ++e) {
    const Index begin = chain.first[e], end = chain.first[e + 1];
    const Point2 o = b.at(b.origin(b.half[e])), t = b.at(b.target(b.half[e]));
    const bool by_x = std::fabs(t.x - o.x) >= std::fabs(t.y - o.y);
    using Number = ExactKernel::FT;
    const auto exact = [&](Index v) -> Number {
      if (v < base_[1]) {
        const Point2 p = a.at(v);
        return by_x ? (Number(p.x) - o.x) / (Number(t.x) - o.x) : (Number(p.y) - o.y) / (Number(t.y) - o.y);
      }
      const Index h = a.half[crossing(v).edge[0]];
      const ExactPlace line{ExactPlace::crossing, a.at(a.origin(h)), a.at(a.target(h)), o, t};
      return exact_parameter(line);
    };
    keyed.clear();
    for (Index i = begin; i < end; ++i) {
      const Index v = chain.nodes[i];
      const double k = v >= base_[2] ? along_b_[v - base_[2]]
                       : by_x        ? (a.at(v).x - o.x) / (t.x - o.x)
                                     : (a.at(v).y - o.y) / (t.y - o.y);
      keyed.push_back({k, v});
    }
    const auto less = [&](const Keyed& p, const Keyed& q) {
      if (std::fabs(p.t - q.t) > 4e-12 * std::max(p.t, q.t)) return p.t < q.t;
      if (p.vertex == q.vertex) return false;
      return exact(p.vertex) < exact(q.vertex);
    };
    for (std::size_t i = 1; i < keyed.size(); ++i)  // insertion: a handful each, mostly in order
      for (std::size_t j = i; j > 0 && less(keyed[j], keyed[j - 1]); --j) std::swap(keyed[j], keyed[j - 1]);
    for (std::size_t i = 0; i < keyed.size(); ++i) {
      const Index v = keyed[i].vertex;
      chain.nodes[begin + i] = v;
      (v >= base_[2] ? crossings_[v - base_[2]].position[1] : position_on_[0][v]) = static_cast<Index>(i);
    }
  }
}

void Arrangement::build_junctions() {
  junction_of_.assign(base_[2], none);
  junction_first_.push_back(0);
  std::vector<Spoke> spokes;
  const auto add = [&](Index vertex, Point2 centre) {
    junction_of_[vertex] = static_cast<Index>(junction_first_.size()) - 1;
    spokes.clear();
    add_spokes(0, vertex, spokes);
    add_spokes(1, vertex, spokes);
    sort_spokes(centre, spokes);
    spokes_.insert(spokes_.end(), spokes.begin(), spokes.end());
    junction_first_.push_back(static_cast<Index>(spokes_.size()));
    junction_vertex_.push_back(vertex);
  };
  for (Index i = 0; i < base_[1]; ++i)
    if (location_[0][i].kind != Location::face) add(i, mesh_[0]->at(i));
  for (Index j = 0; j < static_cast<Index>(mesh_[1]->places.size()); ++j)
    if (location_[1][j].kind == Location::edge) add(base_[1] + j, mesh_[1]->at(j));
}

/// The pieces of mesh m that leave a junction, each with the face to its left.
void Arrangement::add_spokes(int m, Index vertex, std::vector<Spoke>& spokes) const {
  const CompletedMesh& own = *mesh_[m];
  const auto add = [&](const Piece& p, Point2 toward) {
    Spoke s{p, {none, none}, {none, none}, toward};
    s.key[m] = key(p);
    s.left[m] = left_face(p);
    spokes.push_back(s);
  };
  const bool of_a = vertex < base_[1];
  const Index place = of_a ? vertex : vertex - base_[1];
  const Location where = location_[of_a ? 0 : 1][place];
  const bool own_place = (m == 0) == of_a || where.kind == Location::place;
  if (own_place) {
    const Index v = (m == 0) == of_a ? place : where.index;
    for (Index h = own.out[v]; h != none;) {
      add(leaving(m, h), own.at(own.target(h)));
      const Index before = prev_half(h);
      h = own.rotate(h);
      if (h == none) {  // a corner of the box: the last edge has a half-edge on one side only
        const Index e = own.edge[before];
        add({m, e, chains_[m].count(e), 1}, own.at(own.origin(before)));
      }
      if (h == own.out[v]) break;
    }
  } else {
    const Index e = own.edge[where.index], h = own.half[e], position = position_on_[of_a ? 0 : 1][place];
    add({m, e, position + 1, 0}, own.at(own.target(h)));
    add({m, e, position, 1}, own.at(own.origin(h)));
  }
}

/// Counter-clockwise order by exact predicates, pieces in one direction joined, sectors labelled.
void Arrangement::sort_spokes(Point2 centre, std::vector<Spoke>& spokes) {
  const auto lower = [&](Point2 p) { return p.y < centre.y || (p.y == centre.y && p.x < centre.x); };
  const auto less = [&](const Spoke& s, const Spoke& t) {
    const bool ls = lower(s.toward), lt = lower(t.toward);
    if (ls != lt) return lt;
    return orientation(centre, s.toward, t.toward) > 0;
  };
  std::stable_sort(spokes.begin(), spokes.end(), less);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < spokes.size(); ++i) {
    if (kept > 0 && !less(spokes[kept - 1], spokes[i])) {
      spokes[kept - 1].key[1] = spokes[i].key[1];  // A's come first and speak for both
      spokes[kept - 1].left[1] = spokes[i].left[1];
      spokes[kept - 1].piece.edge_of_b = spokes[i].piece.edge;
    } else {
      spokes[kept++] = spokes[i];
    }
  }
  spokes.resize(kept);
  for (int m = 0; m < 2; ++m) {
    Index carried = none;
    for (int round = 0; round < 2; ++round)
      for (Spoke& s : spokes) (s.key[m] != none ? carried : s.left[m]) = s.key[m] != none ? s.left[m] : carried;
  }
  for (const Spoke& s : spokes)
    if (s.key[0] != none && s.key[1] != none) spoken_for_[s.key[1]] = true;
}

Piece Arrangement::next(const Piece& p, Index head, bool& flat) const {
  if (head >= base_[2]) {
    const Crossing& c = crossings_[head - base_[2]];
    const bool to_left = (p.direction == 0) == (p.mesh == 0 ? true : c.along);  // of A's direction 0
    if (p.mesh == 0) {  // up A turns left along B, down A turns right
      const Index direction = to_left == c.along ? 0 : 1;
      return {1, c.edge[1], c.position[1] + (direction == 0 ? 1 : 0), direction};
    }
    return to_left ? Piece{0, c.edge[0], c.position[0], 1} : Piece{0, c.edge[0], c.position[0] + 1, 0};
  }
  if (junction_of_[head] != none) return turn_at_junction(p, junction_of_[head], flat);
  const Index h = mesh_[p.mesh]->half[p.edge];
  return leaving(p.mesh, next_half(p.direction == 0 ? h : mesh_[p.mesh]->twin[h]));
}

const Arrangement::Spoke& Arrangement::spoke(Index junction, Index key) const {
  for (Index i = junction_first_[junction]; i < junction_first_[junction + 1]; ++i)
    if (spokes_[i].key[0] == key || spokes_[i].key[1] == key) return spokes_[i];
  throw Error(ErrorKind::internal, "junction", "a piece does not leave the vertex it came to");
}

/// The region to the left continues with the spoke that comes before the way back, counter-clockwise.
Piece Arrangement::turn_at_junction(const Piece& p, Index junction, bool& flat) const {
  const Spoke& back = spoke(junction, key(p) ^ 1);
  const Spoke *first = &spokes_[junction_first_[junction]], *last = &spokes_[junction_first_[junction + 1] - 1];
  const Spoke& turn = &back == first ? *last : *(&back - 1);
  const Index vertex = junction_vertex_[junction];
  const Point2 centre = vertex < base_[1] ? mesh_[0]->at(vertex) : mesh_[1]->at(vertex - base_[1]);
  flat = orientation(centre, back.toward, turn.toward) == 0;
  return turn.piece;
}

}  // namespace terrane
