// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/merge/needless.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/plan/place_order.hpp"
#include "core/predicates.hpp"

namespace terrane {
namespace {

using Corner = std::ptrdiff_t;  // 3 * face + corner
constexpr Corner no_corner = -1;

bool has_cells_in_parts(const Piece& piece) {
  std::vector<Index> cells = piece.cells;
  std::sort(cells.begin(), cells.end());
  return std::adjacent_find(cells.begin(), cells.end()) != cells.end();
}

bool is_in(Point2 p, Point2 a, Point2 b, Point2 c) {
  const int i = orientation(a, b, p), j = orientation(b, c, p), k = orientation(c, a, p);
  return (i >= 0 && j >= 0 && k >= 0) || (i <= 0 && j <= 0 && k <= 0);
}

/// The places of `piece` that neither of the others has, in the order of their coordinates.
std::vector<Index> made_vertices(const Piece& piece, const Piece& near, const Piece& tile) {
  std::vector<Point2> given(near.surface.points.begin(), near.surface.points.end());
  given.insert(given.end(), tile.surface.points.begin(), tile.surface.points.end());
  std::sort(given.begin(), given.end(), before);
  std::vector<Index> made;
  for (Index v = 0; v < static_cast<Index>(piece.surface.points.size()); ++v)
    if (!std::binary_search(given.begin(), given.end(), piece.surface.points[v], before)) made.push_back(v);
  std::sort(made.begin(), made.end(),
            [&](Index v, Index w) { return before(piece.surface.points[v], piece.surface.points[w]); });
  return made;
}

class Thinning {
 public:
  Thinning(Piece& piece, double tolerance) : piece_(piece), tolerance_(tolerance) {
    const std::size_t corners = 3 * piece.surface.faces.size();
    first_.assign(piece.surface.points.size(), no_corner);
    next_.assign(corners, no_corner);
    last_.assign(corners, no_corner);
    for (Corner c = 0; c < static_cast<Corner>(corners); ++c) link(c);
  }

  /// Takes the vertex out if no cell needs it.
  void try_without(Index v) {
    if (!walk_around(v)) return;
    const std::size_t n = star_.size();
    std::vector<std::size_t> turns;  // where the next face is of another cell
    for (std::size_t i = 0; i + (open_ ? 1 : 0) < n; ++i)
      if (cell(i) != cell((i + 1) % n)) turns.push_back(i + 1);
    triangles_.clear();
    sides_.clear();
    if (turns.empty()) {
      if (open_ ? !is_straight(v, star_.front(), star_.back()) : n < 3) return;
      if (!divide(0, n, open_)) return;
    } else {
      if (open_ || turns.size() != 2) return;
      std::rotate(star_.begin(), star_.begin() + static_cast<std::ptrdiff_t>(turns[0]), star_.end());
      const std::size_t length = turns[1] - turns[0];
      if (!is_straight(v, star_.front(), star_[length - 1])) return;
      if (!divide(0, length, true) || !divide(length, n, true)) return;
    }
    replace();
  }

  void compress() {
    std::size_t kept = 0;
    CornerSurface& surface = piece_.surface;
    for (std::size_t f = 0; f < surface.faces.size(); ++f) {
      if (surface.faces[f][0] == none) continue;
      surface.faces[kept] = surface.faces[f];
      for (std::size_t k = 0; k < 3; ++k) {
        surface.z[3 * kept + k] = surface.z[3 * f + k];
        surface.firm[3 * kept + k] = surface.firm[3 * f + k];
      }
      piece_.contributors[kept] = piece_.contributors[f];
      piece_.cells[kept++] = piece_.cells[f];
    }
    surface.faces.resize(kept);
    surface.z.resize(3 * kept);
    surface.firm.resize(3 * kept);
    piece_.contributors.resize(kept);
    piece_.cells.resize(kept);
  }

 private:
  /// A face at the vertex, the edge across from it, and the corners at its ends.
  struct Spoke {
    Index face, from, to;
    Corner at_from, at_to;
  };
  using Triangle = std::array<Corner, 3>;  // corners of the faces before: places, heights and all
  struct Side {
    std::size_t first, last;            // of the star
    std::size_t first_made, last_made;  // of the triangles
  };

  Index& vertex(Corner c) { return piece_.surface.faces[static_cast<std::size_t>(c / 3)][static_cast<int>(c % 3)]; }
  Point2 at(Corner c) { return piece_.surface.points[vertex(c)]; }
  Index cell(std::size_t i) const { return piece_.cells[star_[i].face]; }

  void link(Corner c) {
    Corner& head = first_[vertex(c)];
    next_[c] = head;
    last_[c] = no_corner;
    if (head != no_corner) last_[head] = c;
    head = c;
  }
  void unlink(Corner c) {
    (last_[c] == no_corner ? first_[vertex(c)] : next_[last_[c]]) = next_[c];
    if (next_[c] != no_corner) last_[next_[c]] = last_[c];
  }

  /// Lists the faces around v counter-clockwise, from the border if it is on one; false when there are many, or they
  /// are no single fan.
  bool walk_around(Index v) {
    constexpr std::size_t many = 32;
    std::vector<Spoke> spokes;
    for (Corner c = first_[v]; c != no_corner; c = next_[c]) {
      if (spokes.size() == many) return false;
      const Corner base = c - c % 3, p = base + (c + 1) % 3, q = base + (c + 2) % 3;
      spokes.push_back({static_cast<Index>(c / 3), vertex(p), vertex(q), p, q});
    }
    if (spokes.empty()) return false;
    std::sort(spokes.begin(), spokes.end(), [](const Spoke& s, const Spoke& t) { return s.from < t.from; });
    const auto begun_by = [&](Index w) {
      const auto it =
          std::lower_bound(spokes.begin(), spokes.end(), w, [](const Spoke& s, Index u) { return s.from < u; });
      return it != spokes.end() && it->from == w ? it : spokes.end();
    };
    auto start = spokes.begin();
    open_ = false;
    for (auto s = spokes.begin(); s != spokes.end(); ++s) {
      const bool ends_one = std::any_of(spokes.begin(), spokes.end(), [&](const Spoke& t) { return t.to == s->from; });
      if (!ends_one) start = s, open_ = true;
    }
    star_.clear();
    for (auto s = start; s != spokes.end() && star_.size() < spokes.size(); s = begun_by(s->to)) star_.push_back(*s);
    return star_.size() == spokes.size() && (open_ || star_.back().to == star_.front().from);
  }

  /// Whether the border that leads from the end of `back` over v to the begin of `front` is one line, within rounding,
  /// with nothing beside it that it could touch.
  bool is_straight(Index v, const Spoke& front, const Spoke& back) {
    const Point2 p = piece_.surface.points[v], a = at(front.at_from), b = at(back.at_to);
    const double x = b.x - a.x, y = b.y - a.y, length = std::hypot(x, y);
    const double along = (p.x - a.x) * x + (p.y - a.y) * y;
    if (!(along > 0 && along < length * length)) return false;
    if (!(std::fabs(area2_accurate(a, b, p)) <= tolerance_ * length)) return false;
    for (const Spoke& s : star_)
      for (const Corner c : {s.at_from, s.at_to})
        if (vertex(c) != front.from && vertex(c) != back.to && is_in(at(c), a, p, b)) return false;
    return true;
  }

  /// Triangulates what the faces first .. last of the star cover, by ears with the shortest cuts. `with_ends`: what
  /// they leave open at the vertex is closed by an edge. Degrees are small: O(k^3).
  bool divide(std::size_t first, std::size_t last, bool with_ends) {
    std::vector<Corner> ring;
    for (std::size_t i = first; i < last; ++i) ring.push_back(star_[i].at_from);
    if (with_ends) ring.push_back(star_[last - 1].at_to);
    if (ring.size() < 3) return false;
    const std::size_t begin = triangles_.size();
    while (ring.size() >= 3) {
      const std::size_t n = ring.size();
      std::size_t best = n;
      std::pair<double, Point2> least{};
      for (std::size_t i = 0; i < n; ++i) {
        if (!is_ear(ring, i)) continue;
        const Point2 p = at(ring[(i + n - 1) % n]), q = at(ring[(i + 1) % n]);
        const std::pair cut{std::hypot(q.x - p.x, q.y - p.y), at(ring[i])};
        if (best == n || cut.first < least.first || (cut.first == least.first && before(cut.second, least.second)))
          best = i, least = cut;
      }
      if (best == n) return false;
      triangles_.push_back({ring[(best + n - 1) % n], ring[best], ring[(best + 1) % n]});
      ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(best));
    }
    sides_.push_back({first, last, begin, triangles_.size()});
    return true;
  }

  bool is_ear(const std::vector<Corner>& ring, std::size_t i) {
    const std::size_t n = ring.size(), h = (i + n - 1) % n, j = (i + 1) % n;
    const Point2 a = at(ring[h]), b = at(ring[i]), c = at(ring[j]);
    if (orientation(a, b, c) <= 0) return false;
    for (std::size_t m = 0; m < n; ++m)
      if (m != h && m != i && m != j && is_in(at(ring[m]), a, b, c)) return false;
    return true;
  }

  void replace() {
    struct Made {
      Index v;
      double z;
      std::uint8_t firm;
    };
    CornerSurface& surface = piece_.surface;
    std::vector<std::array<Made, 3>> made;
    for (const Triangle& t : triangles_) {
      made.emplace_back();
      for (int k = 0; k < 3; ++k) {
        const Corner c = t[k];
        made.back()[k] = {vertex(c), surface.z[c], surface.firm[c]};
      }
    }
    for (const Spoke& s : star_)
      for (int k = 0; k < 3; ++k) unlink(3 * static_cast<Corner>(s.face) + k);
    for (const Side& side : sides_) {
      std::size_t i = side.first;
      for (std::size_t m = side.first_made; m < side.last_made; ++m, ++i)
        for (int k = 0; k < 3; ++k) {
          const Corner c = 3 * static_cast<Corner>(star_[i].face) + k;
          vertex(c) = made[m][k].v;
          surface.z[c] = made[m][k].z;
          surface.firm[c] = made[m][k].firm;
          link(c);
        }
      for (; i < side.last; ++i) surface.faces[star_[i].face] = {none, none, none};
    }
  }

  Piece& piece_;
  double tolerance_;
  std::vector<Corner> first_, next_, last_;  // the corners at each place, linked both ways
  std::vector<Spoke> star_;
  bool open_ = false;
  std::vector<Triangle> triangles_;
  std::vector<Side> sides_;
};

}  // namespace

Piece without_needless(Piece piece, const Piece& near, const Piece& tile, double tolerance) {
  if (!has_cells_in_parts(near)) return piece;
  const std::vector<Index> made = made_vertices(piece, near, tile);
  if (made.empty()) return piece;
  Thinning thinning(piece, tolerance);
  for (const Index v : made) thinning.try_without(v);
  thinning.compress();
  return piece;
}

}  // namespace terrane
