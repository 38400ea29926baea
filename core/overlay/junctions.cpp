// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay/junctions.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "core/predicates.hpp"

namespace terrane {
namespace {

/// So many are looked through one by one.
constexpr std::size_t few_spokes = 32;

class SpokeJoiner {
 public:
  SpokeJoiner(Arrangement& arrangement, const Array<Index> (&node_of)[2])
      : arrangement_(arrangement), node_of_(node_of) {}

  void run() {
    const std::size_t junctions = arrangement_.vertex_of_junction.size();
    arrangement_.first_spoke.reserve(junctions + 1);
    for (int m = 0; m < 2; ++m)
      for (Index i = 0; i < static_cast<Index>(mesh(m).places.size()); ++i) {
        const Location& where = arrangement_.location[m][i];
        if (where.kind == Location::face || (m == 1 && where.kind == Location::place)) continue;
        arrangement_.first_spoke.push_back(static_cast<Index>(arrangement_.spokes.size()));
        if (m == 1 || needed(i)) join(m, i, where);
      }
    arrangement_.first_spoke.push_back(static_cast<Index>(arrangement_.spokes.size()));
  }

 private:
  struct Leaving {
    Spoke spoke;
    Point2 toward;
    bool lower;  // in the half turn that begins with the direction of falling x
  };

  const CompletedMesh& mesh(int m) const { return *arrangement_.mesh[m]; }

  /// Does a face around a place of A have other edges than one of B has?
  bool needed(Index place) const {
    const Index first = mesh(0).out[place];
    for (Index h = first;;) {
      if (!arrangement_.shared(h >> 2)) return true;
      h = mesh(0).rotate(h);
      if (h == none || h == first) return false;
    }
  }

  void join(int m, Index place, const Location& where) {
    centre_ = mesh(m).at(place);
    for (auto& list : leaving_) list.clear();
    around(m, place);
    if (where.kind == Location::place)
      around(1 - m, where.index);
    else
      along(1 - m, mesh(1 - m).edge_of(where.index), node_of_[m][place]);
    // Each mesh gives its own in order, but for where the round begins.
    for (auto& list : leaving_)
      std::rotate(list.begin(),
                  std::min_element(list.begin(), list.end(), [&](auto& s, auto& t) { return before(s, t); }),
                  list.end());
    merge();
    label();
    for (const Leaving& l : merged_) {
      if (merged_.size() > few_spokes)
        for (const std::uint32_t key : l.spoke.key)
          if (key != Arrangement::no_key) arrangement_.crowded.emplace(key, arrangement_.spokes.size());
      arrangement_.spokes.push_back(l.spoke);
    }
  }

  void add(int m, const LinePiece& piece, Index left_face, Point2 toward) {
    Leaving l{{{Arrangement::no_key, Arrangement::no_key}, none, false},
              toward,
              toward.y < centre_.y || (toward.y == centre_.y && toward.x < centre_.x)};
    l.spoke.key[m] = arrangement_.key(piece);
    if (m == 0) l.spoke.face_of_a = left_face;
    leaving_[m].push_back(l);
  }

  /// The pieces of m that leave one of its places.
  void around(int m, Index place) {
    const CompletedMesh& own = mesh(m);
    for (Index h = own.out[place]; h != none;) {
      add(m, arrangement_.leaving(m, h), h >> 2, own.at(own.target(h)));
      const Index last = prev_half(h);
      h = own.rotate(h);
      if (h == none) {  // a corner of the box: the last edge has a half-edge on one side only
        const Index end = arrangement_.lines[m].first[own.edge_of(last) + 1] - 2;
        add(m, {m, end, 1}, none, own.at(own.origin(last)));
      }
      if (h == own.out[place]) break;
    }
  }

  /// The two pieces of m that leave a node inside one of its edges.
  void along(int m, Index e, Index node) {
    const Index h = mesh(m).half[e];
    add(m, {m, node, 0}, mesh(m).left_face(e, 0), mesh(m).at(mesh(m).target(h)));
    add(m, {m, node - 1, 1}, mesh(m).left_face(e, 1), mesh(m).at(mesh(m).origin(h)));
  }

  /// Counter-clockwise from the direction of growing x.
  bool before(const Leaving& s, const Leaving& t) const {
    if (s.lower != t.lower) return t.lower;
    return orientation(centre_, s.toward, t.toward) > 0;
  }

  void merge() {
    merged_.clear();
    auto a = leaving_[0].begin(), b = leaving_[1].begin();
    while (a != leaving_[0].end() || b != leaving_[1].end()) {
      if (b == leaving_[1].end() || (a != leaving_[0].end() && before(*a, *b))) {
        merged_.push_back(*a++);
      } else if (a == leaving_[0].end() || before(*b, *a)) {
        merged_.push_back(*b++);
      } else {
        a->spoke.key[1] = b++->spoke.key[1];
        merged_.push_back(*a++);
      }
    }
  }

  void label() {
    Index carried = none;
    for (int round = 0; round < 2; ++round)
      for (Leaving& l : merged_)
        (l.spoke.key[0] != Arrangement::no_key ? carried : l.spoke.face_of_a) =
            l.spoke.key[0] != Arrangement::no_key ? l.spoke.face_of_a : carried;
    for (std::size_t i = 0; i < merged_.size(); ++i) {
      const Leaving& turn = merged_[i == 0 ? merged_.size() - 1 : i - 1];
      merged_[i].spoke.straight = orientation(centre_, merged_[i].toward, turn.toward) == 0;
    }
  }

  Arrangement& arrangement_;
  const Array<Index> (&node_of_)[2];
  Point2 centre_;
  std::vector<Leaving> leaving_[2], merged_;
};

}  // namespace

void join_spokes(Arrangement& arrangement, const Array<Index> (&node_of)[2]) {
  SpokeJoiner(arrangement, node_of).run();
}

Index Arrangement::spoke_with(Index junction, std::uint32_t key) const {
  const Index begin = first_spoke[junction], end = first_spoke[junction + 1];
  if (static_cast<std::size_t>(end - begin) > few_spokes) {
    const auto found = crowded.find(key);
    return found == crowded.end() || found->second < begin || found->second >= end ? none : found->second;
  }
  for (Index i = begin; i < end; ++i)
    if (spokes[i].key[0] == key || spokes[i].key[1] == key) return i;
  return none;
}

LinePiece Arrangement::turn(const LinePiece& p, Index junction, bool& straight) const {
  const Index s = spoke_with(junction, key(p) ^ 1);
  if (s == none) throw Error(ErrorKind::internal, "junction", "a piece does not leave the vertex it came to");
  straight = spokes[s].straight;
  const Spoke& turned = spokes[(s == first_spoke[junction] ? first_spoke[junction + 1] : s) - 1];
  return piece(turned.key[0] != no_key ? turned.key[0] : turned.key[1]);
}

Index Arrangement::face_of_a_after(Index h) const {
  const Index place = mesh[1]->origin(h), junction = junction_of[1][place];
  if (junction == none) return location[1][place].index;
  const Index i = spoke_with(junction, key(leaving(1, h)));
  if (i == none) throw Error(ErrorKind::internal, "junction", "a half-edge does not leave its origin");
  const Index after = i + 1 == first_spoke[junction + 1] ? first_spoke[junction] : i + 1;
  return spokes[after].key[1] == no_key ? none : spokes[i].face_of_a;
}

}  // namespace terrane
