// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/raster.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <tuple>

namespace terrane {

namespace {

/// How far two lattices may differ, in cells.
constexpr double lattice_tolerance = 1e-6;

struct Offset {
  std::int64_t i = 0, j = 0;
};

enum class Relation {
  none,     // apart, or on different lattices
  pieces,   // of one raster
  conflict  // they claim the same place and must not end up in one raster
};

/// The whole number of cells that `distance` is, or false.
bool whole_cells(double distance, double cell, std::int64_t& count) {
  const double cells = distance / cell;
  if (!(std::fabs(cells) < 1e12)) return false;
  const double nearest = std::nearbyint(cells);
  count = static_cast<std::int64_t>(nearest);
  return std::fabs(cells - nearest) <= lattice_tolerance;
}

/// Cells agree when the far end of the longer tile does not drift off the lattice.
bool same_cell(double a, double b, int count) {
  return a > 0 && b > 0 && std::fabs(a - b) * count <= lattice_tolerance * std::min(a, b);
}

bool on_one_lattice(const Raster& a, const Raster& b, Offset& offset) {
  return same_cell(a.dx, b.dx, std::max(a.width, b.width)) && same_cell(a.dy, b.dy, std::max(a.height, b.height)) &&
         whole_cells(b.x0 - a.x0, a.dx, offset.i) && whole_cells(a.y0 - b.y0, a.dy, offset.j);
}

/// Samples that two intervals starting at 0 and `offset` share; 0 when they abut, negative when they are apart.
std::int64_t shared(std::int64_t length_a, std::int64_t offset, std::int64_t length_b) {
  return std::min(length_a, offset + length_b) - std::max<std::int64_t>(0, offset);
}

bool equal_where_both_exist(const Raster& a, const Raster& b, Offset o) {
  const auto i0 = std::max<std::int64_t>(0, o.i), i1 = std::min<std::int64_t>(a.width, o.i + b.width);
  const auto j0 = std::max<std::int64_t>(0, o.j), j1 = std::min<std::int64_t>(a.height, o.j + b.height);
  for (auto j = j0; j < j1; ++j) {
    for (auto i = i0; i < i1; ++i) {
      const double za = a.at(static_cast<int>(i), static_cast<int>(j));
      const double zb = b.at(static_cast<int>(i - o.i), static_cast<int>(j - o.j));
      if (za < zb || zb < za) return false;
    }
  }
  return true;
}

Relation relation(const Raster& a, const Raster& b, bool join_overlaps, Offset& offset) {
  if (a.samples.empty() || b.samples.empty() || !on_one_lattice(a, b, offset)) return Relation::none;
  const auto columns = shared(a.width, offset.i, b.width), rows = shared(a.height, offset.j, b.height);
  if (columns < 0 || rows < 0 || (columns == 0 && rows == 0)) return Relation::none;
  // A shared row or column is a common border; only shared cells are an overlap.
  if (columns > 1 && rows > 1 && !join_overlaps) return Relation::conflict;
  return equal_where_both_exist(a, b, offset) ? Relation::pieces : Relation::conflict;
}

/// Ranks by content, so that what is joined does not depend on the order given.
std::vector<int> order_by_content(const std::vector<Raster>& tiles) {
  std::vector<int> order(tiles.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int l, int r) {
    const Raster &a = tiles[l], &b = tiles[r];
    const auto ka = std::tuple(a.x0, -a.y0, a.width, a.height, a.dx, a.dy);
    const auto kb = std::tuple(b.x0, -b.y0, b.width, b.height, b.dx, b.dy);
    if (ka != kb) return ka < kb;
    return std::lexicographical_compare(a.samples.begin(), a.samples.end(), b.samples.begin(), b.samples.end(),
                                        [](double p, double q) { return std::isnan(q) ? !std::isnan(p) : p < q; });
  });
  return order;
}

struct Group {
  std::vector<int> members;  // ranks, ascending
  Offset low, high;          // bounding lattice, relative to the first member; `high` exclusive
  double samples = 0;        // of all members
};

/// Joins tiles, given in rank order, pair by pair.
class Joiner {
 public:
  Joiner(const std::vector<const Raster*>& tiles, bool join_overlaps) : tiles_(tiles) {
    const int n = static_cast<int>(tiles.size());
    groups_.resize(n);
    group_of_.resize(n);
    place_.resize(n);
    links_.resize(n);
    for (int a = 0; a < n; ++a) {
      const Raster& tile = *tiles[a];
      groups_[a] = {{a}, {0, 0}, {tile.width, tile.height}, static_cast<double>(tile.samples.size())};
      group_of_[a] = a;
    }
    for (int a = 0; a < n; ++a) {
      for (int b = a + 1; b < n; ++b) {
        Offset offset;
        const Relation r = relation(*tiles[a], *tiles[b], join_overlaps, offset);
        if (r == Relation::none) continue;
        links_[a].push_back({b, r, offset});
        links_[b].push_back({a, r, {-offset.i, -offset.j}});
      }
    }
    for (int a = 0; a < n; ++a) {
      for (const Link& link : links_[a]) {
        if (link.to > a && link.relation == Relation::pieces) join(a, link);
      }
    }
  }

  const Group& group_of(int rank) const { return groups_[group_of_[rank]]; }

  /// The one raster of a group. Its lattice is that of the member that comes first, its corner that of the members
  /// there.
  Raster mosaic(const Group& group) const {
    const Raster& lead = *tiles_[group.members.front()];
    Raster r;
    r.width = static_cast<int>(group.high.i - group.low.i);
    r.height = static_cast<int>(group.high.j - group.low.j);
    r.dx = lead.dx;
    r.dy = lead.dy;
    r.samples.assign(static_cast<std::size_t>(r.width) * r.height, std::numeric_limits<double>::quiet_NaN());
    for (auto m = group.members.rbegin(); m != group.members.rend(); ++m) {
      const Raster& tile = *tiles_[*m];
      const std::int64_t i0 = place_[*m].i - group.low.i, j0 = place_[*m].j - group.low.j;
      if (i0 == 0) r.x0 = tile.x0;
      if (j0 == 0) r.y0 = tile.y0;
      for (int j = 0; j < tile.height; ++j) {
        double* row = r.samples.data() + static_cast<std::size_t>(j0 + j) * r.width + i0;
        for (int i = 0; i < tile.width; ++i) {
          if (!std::isnan(tile.at(i, j))) row[i] = tile.at(i, j);
        }
      }
    }
    return r;
  }

 private:
  struct Link {
    int to;
    Relation relation;
    Offset offset;
  };

  void join(int a, const Link& link) {
    const int into = std::min(group_of_[a], group_of_[link.to]), from = std::max(group_of_[a], group_of_[link.to]);
    if (into == from) return;
    Group &g = groups_[into], &h = groups_[from];
    // Where h's first member lies, seen from g's first.
    Offset shift{place_[a].i + link.offset.i - place_[link.to].i, place_[a].j + link.offset.j - place_[link.to].j};
    if (group_of_[a] == from) shift = {-shift.i, -shift.j};
    if (!compatible(h, into, shift)) return;
    const Offset low{std::min(g.low.i, h.low.i + shift.i), std::min(g.low.j, h.low.j + shift.j)};
    const Offset high{std::max(g.high.i, h.high.i + shift.i), std::max(g.high.j, h.high.j + shift.j)};
    // A few tiles far apart must not make a raster that is mostly void.
    const double columns = static_cast<double>(high.i - low.i), rows = static_cast<double>(high.j - low.j);
    if (columns * rows > 4 * (g.samples + h.samples) + 1e6) return;
    if (std::max(columns, rows) > std::numeric_limits<int>::max()) return;
    for (const int m : h.members) {
      place_[m] = {place_[m].i + shift.i, place_[m].j + shift.j};
      group_of_[m] = into;
    }
    g.members.insert(g.members.end(), h.members.begin(), h.members.end());
    std::sort(g.members.begin(), g.members.end());
    g.low = low;
    g.high = high;
    g.samples += h.samples;
    h = {};
  }

  /// No member of h contradicts a member of the group `into`, be it by its samples or by where it would come to lie.
  bool compatible(const Group& h, int into, Offset shift) const {
    for (const int m : h.members) {
      for (const Link& link : links_[m]) {
        if (group_of_[link.to] != into) continue;
        if (link.relation == Relation::conflict) return false;
        if (place_[m].i + shift.i + link.offset.i != place_[link.to].i) return false;
        if (place_[m].j + shift.j + link.offset.j != place_[link.to].j) return false;
      }
    }
    return true;
  }

  const std::vector<const Raster*>& tiles_;
  std::vector<std::vector<Link>> links_;
  std::vector<Group> groups_;
  std::vector<int> group_of_;
  std::vector<Offset> place_;  // relative to the first member of the group
};

}  // namespace

std::vector<Raster> join_on_lattice(const std::vector<Raster>& tiles, bool join_overlaps, std::vector<int>& groups) {
  const std::vector<int> order = order_by_content(tiles);
  std::vector<int> rank(tiles.size());
  std::vector<const Raster*> ranked(tiles.size());
  for (std::size_t r = 0; r < order.size(); ++r) {
    rank[order[r]] = static_cast<int>(r);
    ranked[r] = &tiles[order[r]];
  }
  const Joiner joiner(ranked, join_overlaps);
  groups.assign(tiles.size(), -1);
  std::vector<Raster> joined;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    if (groups[t] >= 0) continue;
    const Group& group = joiner.group_of(rank[t]);
    for (const int m : group.members) groups[order[m]] = static_cast<int>(joined.size());
    joined.push_back(group.members.size() == 1 ? tiles[t] : joiner.mosaic(group));
  }
  return joined;
}

}  // namespace terrane
