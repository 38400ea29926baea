// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/merge/border_editor.hpp"

#include <algorithm>

#include "core/box.hpp"
#include "core/plan/place_order.hpp"
#include "core/predicates.hpp"
#include "core/rounding/rounding.hpp"

namespace terrane {

bool meet(Point2 a, Point2 b, Point2 c, Point2 d) {
  const int abc = orientation(a, b, c), abd = orientation(a, b, d);
  if (abc * abd > 0) return false;
  const int cda = orientation(c, d, a), cdb = orientation(c, d, b);
  if (cda * cdb > 0) return false;
  if (abc != 0 || abd != 0) return true;
  // On one line: do they share more than nothing?
  const auto low = [](Point2 p, Point2 q) { return before(p, q) ? p : q; };
  const auto high = [](Point2 p, Point2 q) { return before(p, q) ? q : p; };
  return !before(high(a, b), low(c, d)) && !before(high(c, d), low(a, b));
}

BorderEditor::BorderEditor(Piece piece) : piece_(std::move(piece)) {
  PlanarMesh mesh{piece_.surface.points, piece_.surface.faces, {}, {}};
  connect(mesh);
  on_border_.assign(mesh.points.size(), 0);
  for (Index f = 0; f < static_cast<Index>(mesh.faces.size()); ++f)
    for (int k = 0; k < 3; ++k) {
      if (mesh.neighbours[f][k] != none) continue;
      const Index p = mesh.faces[f][(k + 1) % 3], q = mesh.faces[f][(k + 2) % 3];
      edges_.push_back({p, q, f});
      chains_.push_back({p, q});
      face_at_[key(p, q)] = f;
      for (const Index v : {p, q}) {
        if (!on_border_[v]) border_.push_back(v);
        on_border_[v] = 1;
        next_[v].push_back(v == p ? q : p);
      }
    }
  std::sort(border_.begin(), border_.end(), [&](Index p, Index q) { return before(at(p), at(q)); });
  for (Index f = 0; f < static_cast<Index>(mesh.faces.size()); ++f)
    for (const Index v : mesh.faces[f])
      if (on_border_[v]) stars_[v].push_back(f);
  for (const Index v : border_) occupied_.emplace(std::pair(at(v).x, at(v).y), v);
}

bool BorderEditor::can_move(Index v, Point2 to, std::span<const Index> own_edges) const {
  if (stands_at(to)) return false;
  for (const Index f : stars_.at(v)) {
    Point2 c[3];
    for (int k = 0; k < 3; ++k) c[k] = face(f)[k] == v ? to : at(face(f)[k]);
    if (orientation(c[0], c[1], c[2]) <= 0) return false;
  }
  for (const Index w : next_.at(v))
    if (crosses_border(to, at(w), v, w, own_edges)) return false;
  return true;
}

void BorderEditor::move(Index v, Point2 to) {
  occupied_.erase({at(v).x, at(v).y});
  piece_.surface.points[v] = to;
  occupied_.emplace(std::pair(to.x, to.y), v);
}

BorderEditor::Nearest BorderEditor::nearest(Index edge, Point2 p, const PlanMetric& metric) const {
  Nearest best;
  const std::vector<Index>& chain = chains_[edge];
  for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
    const Point2 a = at(chain[i]), b = at(chain[i + 1]);
    const double t = nearest_fraction(a, b, p, metric);
    const double d = metric.distance(p, point_along(a, b, t));
    if (best.from == none || d < best.distance) best = {chain[i], chain[i + 1], i, t, d};
  }
  return best;
}

bool BorderEditor::can_insert(const Nearest& where, Point2 p, std::span<const Index> own_edges) const {
  if (stands_at(p)) return false;
  const Index f = face_at_.at(key(where.from, where.to));
  const Point2 a = at(where.from), b = at(where.to), c = at(opposite(f, where.from, where.to));
  if (orientation(a, p, c) <= 0 || orientation(p, b, c) <= 0) return false;
  return !crosses_border(a, p, where.from, where.to, own_edges) &&
         !crosses_border(p, b, where.from, where.to, own_edges);
}

void BorderEditor::insert(Index edge, const Nearest& where, Point2 p) {
  CornerSurface& surface = piece_.surface;
  const Index f = face_at_.at(key(where.from, where.to)), c = opposite(f, where.from, where.to);
  const Index made = static_cast<Index>(surface.points.size()), g = static_cast<Index>(surface.faces.size());
  surface.points.push_back(p);
  const auto z = [&](Index v) { return surface.z[3 * static_cast<std::size_t>(f) + corner(f, v)]; };
  const auto firm = [&](Index v) { return surface.firm[3 * static_cast<std::size_t>(f) + corner(f, v)]; };
  const double za = z(where.from), zb = z(where.to), zc = z(c);
  const double zp = where.t <= 0.5 ? za + where.t * (zb - za) : zb + (1 - where.t) * (za - zb);
  const std::uint8_t firm_a = firm(where.from), firm_b = firm(where.to), firm_c = firm(c);
  surface.faces[f] = {where.from, made, c};
  surface.faces.push_back({made, where.to, c});
  for (const double value : {zp, zb, zc}) surface.z.push_back(value);
  for (const std::uint8_t value : {std::uint8_t{0}, firm_b, firm_c}) surface.firm.push_back(value);
  const double own[3] = {za, zp, zc};
  const std::uint8_t own_firm[3] = {firm_a, 0, firm_c};
  for (int k = 0; k < 3; ++k) {
    surface.z[3 * static_cast<std::size_t>(f) + k] = own[k];
    surface.firm[3 * static_cast<std::size_t>(f) + k] = own_firm[k];
  }
  piece_.contributors.push_back(piece_.contributors[f]);
  face_at_.erase(key(where.from, where.to));
  face_at_[key(where.from, made)] = f;
  face_at_[key(made, where.to)] = g;
  if (const auto it = face_at_.find(key(where.to, c)); it != face_at_.end() && it->second == f) it->second = g;
  stars_[made] = {f, g};
  std::erase(stars_[where.to], f);
  stars_[where.to].push_back(g);
  if (on_border_[c]) stars_[c].push_back(g);
  std::replace(next_[where.from].begin(), next_[where.from].end(), where.to, made);
  std::replace(next_[where.to].begin(), next_[where.to].end(), where.from, made);
  next_[made] = {where.from, where.to};
  on_border_.push_back(1);
  ++made_;
  occupied_.emplace(std::pair(p.x, p.y), made);
  chains_[edge].insert(chains_[edge].begin() + static_cast<std::ptrdiff_t>(where.part) + 1, made);
}

Box BorderEditor::box_of_border_at(Index v, Point2 to) const {
  Box box = around(no_box, to);
  for (const Index w : next_.at(v)) box = around(box, at(w));
  return box;
}

Box BorderEditor::box_of(const Nearest& where, Point2 p) const {
  return around(around(around(no_box, p), at(where.from)), at(where.to));
}

Index BorderEditor::opposite(Index f, Index p, Index q) const {
  for (const Index v : face(f))
    if (v != p && v != q) return v;
  return none;
}

bool BorderEditor::crosses_border(Point2 p, Point2 q, Index v, Index w, std::span<const Index> own_edges) const {
  for (const Index e : own_edges)
    for (std::size_t i = 0; i + 1 < chains_[e].size(); ++i) {
      const Index a = chains_[e][i], b = chains_[e][i + 1];
      if (a == v || b == v || a == w || b == w) continue;
      if (meet(p, q, at(a), at(b))) return true;
    }
  return false;
}

}  // namespace terrane
