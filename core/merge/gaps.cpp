// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/merge/gaps.hpp"

#include <algorithm>
#include <tuple>

#include "core/box.hpp"
#include "core/merge/border_editor.hpp"
#include "core/plan/region_fill.hpp"
#include "core/plan/segment_index.hpp"
#include "core/predicates.hpp"
#include "core/rounding/rounding.hpp"
#include "core/sum.hpp"

namespace terrane {
namespace {

/// Lengths that are exactly the gap, but for rounding, are within it.
constexpr double a_little_more = 1 + 1e-9;

/// Makes the vertices by which borders that face each other meet square across.
class Facing {
 public:
  Facing(Piece piece, double gap, const PlanMetric& metric, const Context& context)
      : editor_(std::move(piece)), gap_(gap), metric_(metric), context_(context), index_(segments(), 2 * widest()) {}

  Piece run() {
    feet_of_vertices();
    ends_of_slits();
    std::sort(wanted_.begin(), wanted_.end(), [](auto& a, auto& b) {
      return std::tie(a.edge, a.t, a.at.x, a.at.y) < std::tie(b.edge, b.t, b.at.x, b.at.y);
    });
    for (const Wanted& w : wanted_) {
      const auto where = editor_.nearest(w.edge, w.at, metric_);
      if (where.t <= 0 || where.t >= 1 || !editor_.can_insert(where, w.at, {})) continue;
      editor_.insert(w.edge, where, w.at);
    }
    return editor_.piece();
  }

 private:
  struct Wanted {
    Index edge;
    double t;
    Point2 at;
  };

  std::vector<std::array<Point2, 2>> segments() const {
    std::vector<std::array<Point2, 2>> list;
    for (const auto& e : editor_.edges()) list.push_back({editor_.at(e.from), editor_.at(e.to)});
    return list;
  }
  double widest() const {
    double width = 0;
    for (const Index v : editor_.border()) {
      const Box box = metric_.around(editor_.at(v), gap_);
      width = std::max({width, box.xmax - box.xmin, box.ymax - box.ymin});
    }
    return width;
  }

  Index contributor(Index face) const { return editor_.piece().contributors[face]; }

  /// An edge and how far it is from a place.
  struct Near {
    double distance;
    Index edge;
    bool operator<(const Near& other) const { return std::tie(distance, edge) < std::tie(other.distance, other.edge); }
  };
  std::vector<Near> nearest_edges(Point2 p) {
    index_.near(metric_.around(p, gap_), found_);
    std::vector<Near> list;
    for (const Index e : found_) {
      const Point2 a = editor_.at(editor_.edges()[e].from), b = editor_.at(editor_.edges()[e].to);
      const double d = metric_.distance(p, point_along(a, b, nearest_fraction(a, b, p, metric_)));
      if (d <= gap_) list.push_back({d, e});
    }
    std::sort(list.begin(), list.end());
    return list;
  }

  void feet_of_vertices() {
    constexpr int enough = 8;  // where slits meet a vertex faces two or three edges
    for (const Index v : editor_.border()) {
      context_.stop_if_cancelled();
      const std::vector<Near> near = nearest_edges(editor_.at(v));
      const auto& star = editor_.star(v);
      int feet = 0;
      for (std::size_t i = 0; i < near.size() && feet < enough; ++i) {
        const Index other = contributor(editor_.edges()[near[i].edge].face);
        if (std::all_of(star.begin(), star.end(), [&](Index f) { return contributor(f) == other; })) continue;
        feet += add_foot(editor_.at(v), v, none, near[i].edge, near);
      }
    }
  }

  /// The foot of a place on an edge that faces it, unless another edge lies between. `v`: the vertex that stands there,
  /// or none; `own`: the edge that the place lies on; `near`: the edges near the place.
  bool add_foot(Point2 p, Index v, Index own, Index e, const std::vector<Near>& near) {
    const auto& edge = editor_.edges()[e];
    const Point2 a = editor_.at(edge.from), b = editor_.at(edge.to);
    if (edge.from == v || edge.to == v || orientation(a, b, p) >= 0) return false;
    const double t = nearest_fraction(a, b, p, metric_);
    const Point2 foot = point_along(a, b, t);
    const double distance = metric_.distance(p, foot);
    if (t <= 0 || t >= 1 || foot == a || foot == b || distance > gap_) return false;
    for (const auto& [nearer, i] : near) {
      if (nearer > distance * a_little_more) break;
      const auto& between = editor_.edges()[i];
      if (i == e || i == own || between.from == v || between.to == v) continue;
      if (meet(p, foot, editor_.at(between.from), editor_.at(between.to))) return false;
    }
    wanted_.push_back({e, t, foot});
    return true;
  }

  /// Where two edges that face each other are the gap apart, on both of them.
  void ends_of_slits() {
    std::vector<Index> near;
    for (Index e = 0; e < static_cast<Index>(editor_.edges().size()); ++e) {
      context_.stop_if_cancelled();
      const auto& edge = editor_.edges()[e];
      const Point2 a = editor_.at(edge.from), b = editor_.at(edge.to);
      if (metric_.distance(a, b) <= gap_) continue;  // its ends say it well enough
      Box box = around(metric_.around(a, gap_), metric_.around(b, gap_));
      index_.near(box, near);
      for (const Index other : near)
        if (other != e && contributor(editor_.edges()[other].face) != contributor(edge.face)) end_of_slit(e, other);
    }
  }

  void end_of_slit(Index e, Index other) {
    const Point2 a = editor_.at(editor_.edges()[e].from), b = editor_.at(editor_.edges()[e].to);
    const Point2 c = editor_.at(editor_.edges()[other].from), d = editor_.at(editor_.edges()[other].to);
    const Point2 unit = metric_.at((a.y + b.y) / 2);
    const double ux = (d.x - c.x) * unit.x, uy = (d.y - c.y) * unit.y, length = std::hypot(ux, uy);
    const auto outward = [&](Point2 p) {  // the distance from the line of the other edge, beyond it
      return ((p.x - c.x) * unit.x * uy - (p.y - c.y) * unit.y * ux) / length;
    };
    const double wanted = gap_ * (1 - 1e-9), from = outward(a) - wanted, to = outward(b) - wanted;
    if (!(from * to < 0)) return;
    const double t = from / (from - to);
    const Point2 p = point_along(a, b, t);
    if (p == a || p == b) return;
    if (add_foot(p, none, e, other, nearest_edges(p))) wanted_.push_back({e, t, p});
  }

  BorderEditor editor_;
  double gap_;
  const PlanMetric& metric_;
  const Context& context_;
  SegmentIndex index_;
  std::vector<Wanted> wanted_;
  std::vector<Index> found_;
};

/// The faces outside a surface that bridge its slits.
class Bridges {
 public:
  Bridges(const Piece& piece, double gap, const PlanMetric& metric)
      : piece_(piece), gap_(gap * a_little_more), metric_(metric) {}

  /// False when the borders do not bound in doubles.
  bool find() {
    surround();
    outside_ = fill_region(points_, border_);
    if (!outside_.sound) return false;
    const Index count = static_cast<Index>(outside_.faces.size());
    chosen_.assign(count, 0);
    for (Index f = 0; f < count; ++f) chosen_[f] = is_narrow(f);
    for (Index f = 0; f < count; ++f) drop_if_open(f);
    keep_between_tiles();
    return true;
  }

  /// Adds them to the surface they were found for.
  Bridged add_to(Piece& piece, ContributorSets& sets) const {
    Bridged bridged{static_cast<std::size_t>(slits_), 0, 0};
    std::vector<Index> set_of_slit(slits_, none);
    for (Index f = 0; f < static_cast<Index>(outside_.faces.size()); ++f) {
      if (!chosen_[f]) continue;
      for (int k = 0; k < 3; ++k) {
        const Index h = half_edge(f, k);
        if (h == none) continue;
        Index& set = set_of_slit[slit_of_[f]];
        for (const int tile : sets.members(piece.contributors[h / 3]))
          set = set == none ? sets.single(tile) : joined(sets, set, tile);
      }
    }
    // In an order that does not depend on how they were found.
    std::vector<std::pair<Face, Index>> faces;
    for (Index f = 0; f < static_cast<Index>(outside_.faces.size()); ++f)
      if (chosen_[f]) faces.emplace_back(rotated(outside_.faces[f]), f);
    std::sort(faces.begin(), faces.end());
    Sum area;
    for (const auto& [corners, f] : faces) {
      piece.surface.faces.push_back(corners);
      for (const Index v : corners) {
        piece.surface.z.push_back(height(f, v));
        piece.surface.firm.push_back(0);
      }
      piece.contributors.push_back(set_of_slit[slit_of_[f]]);
      area.add(0.5 * area2_accurate(points_[corners[0]], points_[corners[1]], points_[corners[2]]));
    }
    bridged.faces = faces.size();
    bridged.area = area.value();
    return bridged;
  }

 private:
  static Index joined(ContributorSets& sets, Index set, int tile) {
    const auto& members = sets.members(set);
    return std::binary_search(members.begin(), members.end(), tile) ? set : sets.with(set, tile);
  }
  static Face rotated(Face f) {
    std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
    return f;
  }

  /// The border seen from outside, and a box around it.
  void surround() {
    const CornerSurface& surface = piece_.surface;
    PlanarMesh mesh{surface.points, surface.faces, {}, {}};
    connect(mesh);
    points_.assign(surface.points.begin(), surface.points.end());
    Box box = no_box;
    for (Index f = 0; f < static_cast<Index>(mesh.faces.size()); ++f)
      for (int k = 0; k < 3; ++k)
        if (mesh.neighbours[f][k] == none) {
          const Index p = mesh.faces[f][(k + 1) % 3], q = mesh.faces[f][(k + 2) % 3];
          border_.push_back({q, p, 3 * f + k});
          box = around(around(box, points_[p]), points_[q]);
        }
    box = frame_around(box);
    first_corner_ = static_cast<Index>(points_.size());
    points_.insert(points_.end(),
                   {{box.xmin, box.ymin}, {box.xmax, box.ymin}, {box.xmax, box.ymax}, {box.xmin, box.ymax}});
    for (int k = 0; k < 4; ++k) border_.push_back({first_corner_ + k, first_corner_ + (k + 1) % 4, none});
  }

  /// The surface's half-edge, 3 * face + opposite corner, across the side from corner k to k + 1; none when there is
  /// none.
  Index half_edge(Index f, int k) const {
    const Index across = outside_.across[f][k];
    return across >= 0 ? none : border_[-1 - across].tag;
  }
  double length(Index f, int k) const {
    const Face& c = outside_.faces[f];
    return metric_.distance(points_[c[k]], points_[c[(k + 1) % 3]]);
  }

  bool is_narrow(Index f) const {
    const Face& c = outside_.faces[f];
    if (std::max({c[0], c[1], c[2]}) >= first_corner_) return false;
    bool base = false;
    for (int k = 0; k < 3; ++k) {
      if (half_edge(f, k) == none) continue;
      base = true;
      const Point2 p = points_[c[k]], q = points_[c[(k + 1) % 3]], top = points_[c[(k + 2) % 3]];
      if (metric_.distance(top, point_along(p, q, nearest_fraction(p, q, top, metric_))) <= gap_) return true;
    }
    if (base) return false;
    return (length(f, 0) <= gap_) + (length(f, 1) <= gap_) + (length(f, 2) <= gap_) >= 2;
  }

  /// Gives a face up when a side of it would stay open that is longer than the gap, and then those beside it.
  void drop_if_open(Index first) {
    std::vector<Index> stack{first};
    while (!stack.empty()) {
      const Index f = stack.back();
      stack.pop_back();
      if (!chosen_[f]) continue;
      bool open = false;
      for (int k = 0; k < 3; ++k) {
        const Index across = outside_.across[f][k];
        open = open || (across >= 0 && !chosen_[across / 4] && length(f, k) > gap_);
      }
      if (!open) continue;
      chosen_[f] = 0;
      for (const Index across : outside_.across[f])
        if (across >= 0) stack.push_back(across / 4);
    }
  }

  void keep_between_tiles() {
    slit_of_.assign(chosen_.size(), none);
    std::vector<Index> members;
    for (Index seed = 0; seed < static_cast<Index>(chosen_.size()); ++seed) {
      if (!chosen_[seed] || slit_of_[seed] != none) continue;
      members.assign(1, seed);
      slit_of_[seed] = slits_;
      Index contributor = none;
      bool several = false;
      for (std::size_t i = 0; i < members.size(); ++i)
        for (int k = 0; k < 3; ++k) {
          const Index across = outside_.across[members[i]][k], h = half_edge(members[i], k);
          if (h != none) {
            several = several || (contributor != none && piece_.contributors[h / 3] != contributor);
            contributor = piece_.contributors[h / 3];
          } else if (across >= 0 && chosen_[across / 4] && slit_of_[across / 4] == none) {
            slit_of_[across / 4] = slits_;
            members.push_back(across / 4);
          }
        }
      if (several)
        ++slits_;
      else
        for (const Index f : members) chosen_[f] = 0;
    }
  }

  /// At a corner of a face outside: that of the border beside it, the one it lies on before others.
  double height(Index f, Index v) const {
    const Face& c = outside_.faces[f];
    const int k = c[0] == v ? 0 : c[1] == v ? 1 : 2;
    for (const int side : {k, (k + 2) % 3})
      if (const Index h = half_edge(f, side); h != none) return height_beside(h, v);
    // Round the vertex to where the outside ends.
    Index g = f;
    int corner = k;
    while (true) {
      const int side = (corner + 2) % 3;
      if (const Index h = half_edge(g, side); h != none) return height_beside(h, v);
      const Index across = outside_.across[g][side];
      g = across / 4;
      corner = across % 4;
    }
  }
  double height_beside(Index h, Index v) const {
    const Face& c = piece_.surface.faces[h / 3];
    const int k = c[0] == v ? 0 : c[1] == v ? 1 : 2;
    return piece_.surface.z[3 * static_cast<std::size_t>(h / 3) + k];
  }

  const Piece& piece_;
  double gap_;
  const PlanMetric& metric_;
  Array<Point2> points_;
  std::vector<BorderEdge> border_;
  Index first_corner_ = 0, slits_ = 0;
  FilledRegion outside_;
  std::vector<std::uint8_t> chosen_;
  std::vector<Index> slit_of_;
};

}  // namespace

Bridged bridge_gaps(Piece& piece, ContributorSets& sets, double gap, const PlanMetric& metric, Context& context) {
  if (!(gap > 0) || piece.contributors.empty()) return {};
  context.progress("gaps", 0);
  Piece refined = Facing(piece, gap, metric, context).run();
  context.progress("gaps", 0.5);
  Bridges bridges(refined, gap, metric);
  if (bridges.find()) {
    // Without a bridge the surface stays as it was, feet and all.
    Piece bridged = refined;
    const Bridged report = bridges.add_to(bridged, sets);
    if (report.faces > 0) piece = std::move(bridged);
    return report;
  }
  Bridges plain(piece, gap, metric);
  if (!plain.find()) {
    context.warn({"gap-skipped", "", "",
                  "no gap was bridged: borders lie so near each other that doubles cannot tell them apart",
                  "snap the tiles to each other first"});
    return {};
  }
  Piece bridged = piece;
  const Bridged report = plain.add_to(bridged, sets);
  piece = std::move(bridged);
  return report;
}

}  // namespace terrane
