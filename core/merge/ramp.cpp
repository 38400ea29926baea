// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/merge/ramp.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/corner_heights.hpp"
#include "core/plan/region_fill.hpp"
#include "core/predicates.hpp"
#include "core/rounding/rounding.hpp"
#include "core/sum.hpp"

namespace terrane {
namespace {

bool differ(double a, double b) { return std::fabs(a - b) > std::max(rounding_jump(a), rounding_jump(b)); }

class Ramper {
 public:
  Ramper(CornerSurface surface, const RampGround& ground, Meeting meeting)
      : before_(std::move(surface)), ground_(ground), meeting_(meeting) {}

  Ramped run(Context& context) {
    context.progress("ramp", 0);
    PlanarMesh mesh{before_.points, before_.faces, {}, {}};
    connect(mesh);
    neighbours_ = std::move(mesh.neighbours);
    mark_border();
    set_targets();
    if (std::none_of(touched_.begin(), touched_.end(), [](auto t) { return t != 0; })) return unchanged();
    context.progress("ramp", 0.3);
    take_cut_faces();
    drop_parts_without_room();
    context.progress("ramp", 0.5);
    return rebuilt();
  }

 private:
  Index faces() const { return static_cast<Index>(before_.faces.size()); }
  double z(Index f, int corner) const { return before_.z[3 * static_cast<std::size_t>(f) + corner % 3]; }
  int rank(Index f) const { return ground_.rank[f]; }
  bool outside(Index f) const { return rank(f) == 0; }
  /// Faces of one surface, which none of the two holds against the other.
  bool alike(Index f, Index g) const { return rank(f) == rank(g) && (!outside(f) || side(f) == side(g)); }
  Index side(Index f) const { return ground_.origin[f][0]; }
  int corner_of(Index f, Index v) const { return before_.faces[f][0] == v ? 0 : before_.faces[f][1] == v ? 1 : 2; }
  Index label(Index f) const { return ground_.classes ? (*ground_.classes)[f] : 0; }

  /// Vertices where faces meet that are not alike.
  void mark_border() {
    border_.assign(before_.points.size(), 0);
    std::vector<Index> seen(before_.points.size(), none);
    for (Index f = 0; f < faces(); ++f)
      for (const Index v : before_.faces[f]) {
        if (seen[v] == none) seen[v] = f;
        if (!alike(f, seen[v])) border_[v] = 1;
      }
  }

  /// The height that corner c of face f meets when its vertex is gone around in one direction, through faces that do
  /// not hold against it; none where that ends or jumps.
  std::optional<double> met(Index f, int c, bool counter_clockwise) const {
    const Index start = f, v = before_.faces[f][c];
    const int own = rank(f);
    do {
      const Index g = neighbours_[f][(c + (counter_clockwise ? 1 : 2)) % 3];
      if (g == none) return {};
      const int j = corner_of(g, v);
      if (rank(g) > own) return held_height(3 * static_cast<std::size_t>(g) + j);
      if (own == 0 && side(g) != side(f)) return meeting_height(z(f, c), z(g, j));
      if (differ(z(f, c), z(g, j))) return {};
      f = g, c = j;
    } while (f != start);
    return {};
  }

  /// The height a corner ends with: those of higher rank are settled first.
  double held_height(std::size_t corner) const {
    return std::isnan(target_[corner]) ? before_.z[corner] : target_[corner];
  }

  double meeting_height(double a, double b) const {
    if (meeting_ == Meeting::mean) return 0.5 * (a + b);
    return meeting_ == Meeting::lower ? std::min(a, b) : std::max(a, b);
  }

  /// The one height that the highest rank holds at a vertex, for faces that only touch it there.
  std::optional<double> only_held(Index f, Index v) {
    if (places_.first.empty()) places_ = corners_by_place(before_.faces, before_.points.size());
    int highest = rank(f) + 1;
    for (std::size_t i = places_.first[v]; i < places_.first[v + 1]; ++i)
      highest = std::max(highest, rank(static_cast<Index>(places_.corners[i] / 3)));
    std::optional<double> only;
    for (std::size_t i = places_.first[v]; i < places_.first[v + 1]; ++i) {
      const std::size_t c = places_.corners[i];
      if (rank(static_cast<Index>(c / 3)) != highest) continue;
      if (only && differ(*only, held_height(c))) return {};
      if (!only) only = held_height(c);
    }
    return only;
  }

  /// What corners at the border are to become, where that is not what they are; the highest rank first.
  void set_targets() {
    target_.assign(before_.z.size(), NAN);
    touched_.assign(before_.faces.size(), 0);
    std::vector<Index> order;
    for (Index f = 0; f < faces(); ++f)
      if (border_[before_.faces[f][0]] || border_[before_.faces[f][1]] || border_[before_.faces[f][2]])
        order.push_back(f);
    std::stable_sort(order.begin(), order.end(), [&](Index f, Index g) { return rank(f) > rank(g); });
    for (const Index f : order)
      for (int k = 0; k < 3; ++k) {
        if (!border_[before_.faces[f][k]]) continue;
        std::optional<double> wanted = met(f, k, true);
        if (!wanted) wanted = met(f, k, false);
        if (!wanted) wanted = only_held(f, before_.faces[f][k]);
        if (!wanted || !differ(*wanted, z(f, k))) continue;
        target_[3 * static_cast<std::size_t>(f) + k] = *wanted;
        touched_[f] = 1;
      }
  }

  /// Of the faces that the border cuts all pieces outside are taken together, when one of them is touched.
  void take_cut_faces() {
    anew_.assign(before_.faces.size(), 0);
    std::vector<std::array<Index, 2>> cut;
    for (Index f = 0; f < faces(); ++f)
      if (outside(f) && touched_[f]) cut.push_back(ground_.origin[f]);
    std::sort(cut.begin(), cut.end());
    cut.erase(std::unique(cut.begin(), cut.end()), cut.end());
    const auto number = [&](Index f) -> std::ptrdiff_t {
      const auto it = std::lower_bound(cut.begin(), cut.end(), ground_.origin[f]);
      return it != cut.end() && *it == ground_.origin[f] ? it - cut.begin() : -1;
    };
    std::vector<double> left(cut.size(), 0);
    std::vector<std::pair<Index, std::ptrdiff_t>> pieces;
    for (Index f = 0; f < faces(); ++f) {
      if (!outside(f)) continue;
      const std::ptrdiff_t n = number(f);
      if (n < 0) continue;
      pieces.emplace_back(f, n);
      const Face& corners = before_.faces[f];
      left[n] += area2_accurate(before_.points[corners[0]], before_.points[corners[1]], before_.points[corners[2]]);
    }
    std::vector<std::uint8_t> whole(cut.size());
    for (std::size_t n = 0; n < cut.size(); ++n) whole[n] = left[n] >= (1 - 1e-9) * ground_.area(cut[n][0], cut[n][1]);
    for (const auto& [f, n] : pieces)
      if (!whole[n]) anew_[f] = touched_[f] = 1;
  }

  /// Whether f and the face across its side k are one smooth piece of one surface.
  bool connected(Index f, int k) const {
    const Index g = neighbours_[f][k];
    if (g == none || !alike(f, g)) return false;
    const Index p = before_.faces[f][(k + 1) % 3], q = before_.faces[f][(k + 2) % 3];
    return !differ(z(f, k + 1), z(g, corner_of(g, p))) && !differ(z(f, k + 2), z(g, corner_of(g, q)));
  }

  void drop_parts_without_room() {
    std::vector<std::uint8_t> seen(before_.faces.size(), 0);
    std::vector<Index> part;
    for (Index start = 0; start < faces(); ++start) {
      if (!touched_[start] || seen[start]) continue;
      part.assign(1, start);
      seen[start] = 1;
      bool room = false;
      for (std::size_t i = 0; i < part.size(); ++i)
        for (int k = 0; k < 3; ++k) {
          room = room || std::isnan(target_[3 * static_cast<std::size_t>(part[i]) + k]);
          if (!connected(part[i], k)) continue;
          const Index g = neighbours_[part[i]][k];
          if (seen[g] || !touched_[g]) continue;
          seen[g] = 1;
          part.push_back(g);
        }
      if (room) continue;
      for (const Index f : part) touched_[f] = anew_[f] = 0;
    }
  }

  Ramped unchanged() {
    Ramped result;
    result.from.resize(before_.faces.size());
    std::iota(result.from.begin(), result.from.end(), 0);
    result.sloped.assign(before_.faces.size(), 0);
    result.surface = std::move(before_);
    return result;
  }

  /// The edges around and within what is triangulated anew, what is left of them to be filled; tagged 3 * face + side.
  std::vector<BorderEdge> frame() const {
    std::vector<BorderEdge> edges;
    for (Index f = 0; f < faces(); ++f) {
      if (!anew_[f]) continue;
      for (int k = 0; k < 3; ++k) {
        const Index g = neighbours_[f][k];
        if (connected(f, k) && anew_[g] && label(f) == label(g)) continue;
        edges.push_back({before_.faces[f][(k + 1) % 3], before_.faces[f][(k + 2) % 3], 3 * f + k});
      }
    }
    return edges;
  }

  /// Vertices of what is triangulated anew that lie inside it.
  std::vector<Index> inner(const std::vector<BorderEdge>& edges) const {
    std::vector<std::uint8_t> state(before_.points.size(), 0);
    for (const BorderEdge& e : edges) state[e.from] = state[e.to] = 1;
    std::vector<Index> found;
    for (Index f = 0; f < faces(); ++f)
      for (int k = 0; anew_[f] && k < 3; ++k)
        if (!std::exchange(state[before_.faces[f][k]], 1)) found.push_back(before_.faces[f][k]);
    return found;
  }

  double new_height(std::size_t corner) const {
    return touched_[corner / 3] && !std::isnan(target_[corner]) ? target_[corner] : before_.z[corner];
  }

  Ramped rebuilt() {
    const std::vector<BorderEdge> edges = frame();
    FilledRegion filled;
    if (!edges.empty()) {
      filled = fill_region(before_.points, edges, inner(edges));
      if (!filled.sound) std::fill(anew_.begin(), anew_.end(), 0);  // then the plan stays as it is
    }
    Ramped result;
    for (Index f = 0; f < faces(); ++f)
      if (!anew_[f]) keep(f, result);
    if (filled.sound) append(filled, edges, result);
    result.surface.points = std::move(before_.points);
    return result;
  }

  void keep(Index f, Ramped& result) const {
    result.surface.faces.push_back(before_.faces[f]);
    result.from.push_back(f);
    result.sloped.push_back(touched_[f]);
    for (std::size_t c = 3 * static_cast<std::size_t>(f), end = c + 3; c < end; ++c) {
      result.surface.z.push_back(new_height(c));
      if (!before_.firm.empty()) result.surface.firm.push_back(before_.firm[c] && new_height(c) == before_.z[c]);
    }
  }

  /// Heights come from the border edges: every edge gives its own to the corners between it and the next one around
  /// its origin. Only vertices inside have one height by themselves.
  void append(const FilledRegion& filled, const std::vector<BorderEdge>& edges, Ramped& result) const {
    const std::size_t first = result.surface.faces.size();
    for (const Face& f : filled.faces) result.surface.faces.push_back(f);
    result.sloped.resize(result.surface.faces.size(), 1);
    result.from.resize(result.surface.faces.size(), none);
    std::vector<std::size_t> source(3 * filled.faces.size(), std::size_t(-1));  // per corner, a corner of before
    std::vector<Index> reached;
    for (Index t = 0; t < static_cast<Index>(filled.faces.size()); ++t)
      for (int c = 0; c < 3; ++c) {
        if (filled.across[t][c] >= 0) continue;
        const Index tag = edges[-1 - filled.across[t][c]].tag;
        const std::size_t corner = 3 * static_cast<std::size_t>(tag / 3) + (tag % 3 + 1) % 3;
        spread(filled, t, c, corner, source);
        if (std::exchange(result.from[first + t], tag / 3) == none) reached.push_back(t);
      }
    for (std::size_t i = 0; i < reached.size(); ++i)
      for (const Index a : filled.across[reached[i]])
        if (a >= 0 && result.from[first + a / 4] == none) {
          result.from[first + a / 4] = result.from[first + reached[i]];
          reached.push_back(a / 4);
        }
    std::vector<std::size_t> own(before_.points.size(), std::size_t(-1));
    for (Index f = 0; f < faces(); ++f)
      for (int k = 0; anew_[f] && k < 3; ++k) own[before_.faces[f][k]] = 3 * static_cast<std::size_t>(f) + k;
    for (std::size_t c = 0; c < source.size(); ++c) {
      const std::size_t from = source[c] != std::size_t(-1) ? source[c] : own[filled.faces[c / 3][c % 3]];
      result.surface.z.push_back(new_height(from));
      if (!before_.firm.empty())
        result.surface.firm.push_back(before_.firm[from] && new_height(from) == before_.z[from]);
    }
  }

  static void spread(const FilledRegion& filled, Index t, int c, std::size_t corner, std::vector<std::size_t>& source) {
    while (true) {
      source[3 * static_cast<std::size_t>(t) + c] = corner;
      const Index a = filled.across[t][(c + 2) % 3];  // from the corner before to this one
      if (a < 0) return;
      t = a / 4, c = a % 4;
    }
  }

  CornerSurface before_;
  const RampGround& ground_;
  const Meeting meeting_;
  Array<Face> neighbours_;
  std::vector<std::uint8_t> border_;   // per vertex
  std::vector<double> target_;         // per corner; NaN: stays as it is
  std::vector<std::uint8_t> touched_;  // per face: changes
  std::vector<std::uint8_t> anew_;     // per face: is triangulated anew
  CornersByPlace places_;
};

}  // namespace

Tin faces_in_plan(const Array<Point2>& points, const Array<Face>& faces, const std::vector<std::uint8_t>& wanted) {
  Tin tin;
  std::vector<Index> index(points.size(), none);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!wanted[f]) continue;
    Face face = faces[f];
    for (Index& v : face) {
      if (index[v] == none) {
        index[v] = static_cast<Index>(tin.vertices.size());
        tin.vertices.push_back({points[v].x, points[v].y, 0});
      }
      v = index[v];
    }
    tin.faces.push_back(face);
  }
  return tin;
}

Ramped ramp(CornerSurface surface, const RampGround& ground, Meeting meeting, Context& context) {
  return Ramper(std::move(surface), ground, meeting).run(context);
}

}  // namespace terrane
