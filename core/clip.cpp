// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/clip.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/box.hpp"
#include "core/corner_heights.hpp"
#include "core/parallel.hpp"
#include "core/plan/region_cells.hpp"
#include "core/surface.hpp"
#include "core/surface/cut_walls.hpp"

namespace terrane {
namespace {

using Where = RegionCells::Where;

/// Where every face lies. `all_near`: no face is taken for far.
std::vector<Where> where_faces_lie(const Tin& tin, const PlanRegion& region, bool all_near, const Context& context) {
  if (all_near) return std::vector<Where>(tin.faces.size(), Where::near);
  const Box whole = bounds(tin.vertices, context), part = bounds(region.tin);
  const double width = std::min(whole.xmax, part.xmax) - std::max(whole.xmin, part.xmin);
  const double height = std::min(whole.ymax, part.ymax) - std::max(whole.ymin, part.ymin);
  if (width < 0 || height < 0) return std::vector<Where>(tin.faces.size(), Where::outside);
  // Cells about as large as faces, if these were spread evenly.
  const double share =
      width / std::max(whole.xmax - whole.xmin, 1e-300) * (height / std::max(whole.ymax - whole.ymin, 1e-300));
  const RegionCells cells(region, whole, static_cast<std::size_t>(share * static_cast<double>(tin.faces.size())));
  std::vector<Where> where(tin.faces.size());
  parallel_for(context, tin.faces.size(), 1 << 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) where[f] = cells(box_of(tin, tin.faces[f]));
  });
  return where;
}

std::uint64_t key(Index from, Index to) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(from)) << 32 | static_cast<std::uint32_t>(to);
}

/// Cuts what lies near the border and puts both sides together.
class Cutter {
 public:
  Cutter(const Tin& surface, const PlanRegion& region, std::vector<Where> where, Context& context)
      : surface_(surface), region_(region), where_(std::move(where)), context_(context) {}

  /// False when rounding has changed an edge between what lies near and what lies far.
  bool run() {
    take_near();
    if (near_.empty()) return true;
    OverlayOptions options;
    options.refinement = Refinement::outline;
    overlay_ = overlay(strip(), region_.tin, options, context_);
    find_corners();
    return seam_is_whole();
  }

  Clipped take(Side side) {
    Clipped result;
    result.rounding = overlay_.rounding;
    result.tin.vertices = surface_.vertices;
    const Where far = side == Side::inside ? Where::inside : Where::outside;
    for (std::size_t f = 0; f < surface_.faces.size(); ++f)
      if (where_[f] == far) result.tin.faces.push_back(surface_.faces[f]);
    std::vector<std::uint8_t> sides(near_.size(), 0);
    std::vector<Face> pieces;
    for (std::size_t p = 0; p < overlay_.faces.size(); ++p) {
      const auto [parent, inside] = overlay_.parents[p];
      if (parent == none) continue;
      sides[parent] |= inside == none ? 1 : 2;
      if ((inside == none) == (side == Side::outside)) pieces.push_back(corners_[p]);
    }
    result.cut = static_cast<std::size_t>(std::count(sides.begin(), sides.end(), 3));
    if (is_torn()) pieces = closed(std::move(pieces));
    result.tin.faces.insert(result.tin.faces.end(), pieces.begin(), pieces.end());
    result.cut += add_walls(side, result.tin.faces);
    result.tin.vertices.insert(result.tin.vertices.end(), made_.begin(), made_.end());
    result.tin = canonical(std::move(result.tin), context_);
    return result;
  }

 private:
  void take_near() {
    for (Index f = 0; f < static_cast<Index>(where_.size()); ++f)
      if (where_[f] == Where::near) (is_wall(surface_, surface_.faces[f]) ? near_walls_ : near_).push_back(f);
  }

  /// The faces near the border as a TIN. Its faces are in the order of near_.
  Tin strip() {
    Tin tin;
    in_strip_.assign(surface_.vertices.size(), false);
    for (const Index f : near_)
      for (const Index v : surface_.faces[f]) in_strip_[v] = true;
    std::vector<Index> number(surface_.vertices.size(), none);
    for (std::size_t v = 0; v < number.size(); ++v) {
      if (!in_strip_[v]) continue;
      number[v] = static_cast<Index>(tin.vertices.size());
      tin.vertices.push_back(surface_.vertices[v]);
    }
    for (const Index f : near_) {
      const Face& face = surface_.faces[f];
      tin.faces.push_back({number[face[0]], number[face[1]], number[face[2]]});
    }
    return tin;
  }

  /// A vertex of the surface where the parent has one there, else one made for the place and height.
  void find_corners() {
    corners_.assign(overlay_.faces.size(), {none, none, none});
    for (std::size_t p = 0; p < overlay_.faces.size(); ++p) {
      const Index parent = overlay_.parents[p][0];
      for (int k = 0; parent != none && k < 3; ++k) {
        const Index v = overlay_.faces[p][k];
        for (const Index own : surface_.faces[near_[parent]])
          if (plan(surface_.vertices[own]) == overlay_.points[v]) corners_[p][k] = own;
        if (corners_[p][k] != none) remember(v, corners_[p][k]);
      }
    }
    for (std::size_t p = 0; p < overlay_.faces.size(); ++p)
      for (int k = 0; overlay_.parents[p][0] != none && k < 3; ++k)
        if (corners_[p][k] == none)
          corners_[p][k] = vertex_at(overlay_.faces[p][k], overlay_.height(0, static_cast<Index>(p), k));
  }

  void remember(Index place, Index vertex) {
    std::vector<Index>& here = at_place_[place];
    if (std::find(here.begin(), here.end(), vertex) == here.end()) here.push_back(vertex);
  }

  /// The vertex at a place of the overlay that has this height, or one that differs by rounding.
  Index vertex_at(Index place, double z) {
    std::vector<Index>& here = at_place_[place];
    Index best = none;
    double nearest = rounding_jump(z);
    for (const Index v : here)
      if (const double d = std::fabs(point(v).z - z); d < nearest || (d == nearest && best == none))
        best = v, nearest = d;
    if (best != none) return best;
    const auto made = static_cast<Index>(surface_.vertices.size() + made_.size());
    made_.push_back({overlay_.points[place].x, overlay_.points[place].y, z});
    here.push_back(made);
    return made;
  }

  /// Mending on a cliff thinner than rounding can leave two heights at a place where the surface has one.
  bool is_torn() const {
    if (std::none_of(at_place_.begin(), at_place_.end(), [](const auto& place) { return place.second.size() > 1; }))
      return false;
    std::vector<std::pair<double, double>> places;
    for (std::size_t v = 0; v < in_strip_.size(); ++v)
      if (in_strip_[v]) places.emplace_back(surface_.vertices[v].x, surface_.vertices[v].y);
    std::sort(places.begin(), places.end());
    return std::adjacent_find(places.begin(), places.end()) == places.end();
  }

  Point point(Index vertex) const {
    const auto own = static_cast<Index>(surface_.vertices.size());
    return vertex < own ? surface_.vertices[vertex] : made_[vertex - own];
  }

  /// Pieces of one side with walls where they are torn.
  std::vector<Face> closed(std::vector<Face> pieces) {
    using Key = std::array<double, 3>;
    std::map<Key, Index> vertex;
    std::map<std::pair<double, double>, Index> place;
    CornerSurface torn;
    for (const Face& f : pieces) {
      Face face;
      for (int k = 0; k < 3; ++k) {
        const Point p = point(f[k]);
        vertex.emplace(Key{p.x, p.y, p.z}, f[k]);
        const auto [it, fresh] = place.try_emplace({p.x, p.y}, static_cast<Index>(torn.points.size()));
        if (fresh) torn.points.push_back(plan(p));
        face[k] = it->second;
        torn.z.push_back(p.z);
        torn.firm.push_back(f[k] < static_cast<Index>(surface_.vertices.size()));
      }
      torn.faces.push_back(face);
    }
    const Tin tin = assemble(std::move(torn), {Seam::wall, 0}, context_).tin;
    pieces.clear();
    for (Face f : tin.faces) {
      for (Index& v : f) {
        const Point p = tin.vertices[v];
        const auto [it, fresh] =
            vertex.try_emplace(Key{p.x, p.y, p.z}, static_cast<Index>(surface_.vertices.size() + made_.size()));
        if (fresh) made_.push_back(p);
        v = it->second;
      }
      pieces.push_back(f);
    }
    return pieces;
  }

  /// Do the pieces have every edge that faces near the border share with faces far from it?
  bool seam_is_whole() const {
    std::vector<std::uint64_t> beyond;
    for (std::size_t f = 0; f < where_.size(); ++f) {
      if (where_[f] == Where::near) continue;
      const Face& face = surface_.faces[f];
      for (int k = 0; k < 3; ++k)
        if (const Index from = face[(k + 1) % 3], to = face[k]; in_strip_[from] && in_strip_[to])
          beyond.push_back(key(from, to));
    }
    std::sort(beyond.begin(), beyond.end());
    std::vector<std::uint8_t> before(beyond.size(), 0), after(beyond.size(), 0);
    const auto note = [&](const Face& face, std::vector<std::uint8_t>& seen) {
      for (int k = 0; k < 3; ++k) {
        const std::uint64_t edge = key(face[k], face[(k + 1) % 3]);
        const auto at = std::lower_bound(beyond.begin(), beyond.end(), edge);
        if (at != beyond.end() && *at == edge) seen[at - beyond.begin()] = 1;
      }
    };
    for (const Index f : near_) note(surface_.faces[f], before);
    for (std::size_t p = 0; p < corners_.size(); ++p)
      if (overlay_.parents[p][0] != none) note(corners_[p], after);
    for (std::size_t i = 0; i < beyond.size(); ++i)
      if (before[i] && !after[i]) return false;
    return true;
  }

  /// Walls near the border; those far from it are among the faces. Returns how many were divided.
  std::size_t add_walls(Side side, std::vector<Face>& faces) {
    if (near_walls_.empty()) return 0;
    return cut_walls(
        {surface_, region_, near_, near_walls_, overlay_}, side == Side::inside,
        [&](Index place, Point2 at, double z) { return wall_vertex(place, at, z); }, faces);
  }

  Index wall_vertex(Index place, Point2 at, double z) {
    if (place != none) return vertex_at(place, z);
    const auto [it, fresh] = free_.try_emplace(
        {std::bit_cast<std::uint64_t>(at.x), std::bit_cast<std::uint64_t>(at.y), std::bit_cast<std::uint64_t>(z)},
        static_cast<Index>(surface_.vertices.size() + made_.size()));
    if (fresh) made_.push_back({at.x, at.y, z});
    return it->second;
  }

  const Tin& surface_;
  const PlanRegion& region_;
  std::vector<Where> where_;
  Context& context_;
  std::vector<Index> near_, near_walls_;  // faces of the surface
  std::vector<bool> in_strip_;            // per vertex of the surface
  Overlay overlay_;                       // of the faces near the border and the region
  std::vector<Face> corners_;             // of its faces: vertices of the surface, then those made
  std::vector<Point> made_;
  std::unordered_map<Index, std::vector<Index>> at_place_;
  std::map<std::array<std::uint64_t, 3>, Index> free_;  // of walls that stand on no edge
};

}  // namespace

Clipped clip(const Tin& surface, const PlanRegion& region, Side side, Context& context) {
  context.progress("clip", 0);
  if (region.empty() || surface.faces.empty()) {
    Clipped all;
    if (side == Side::outside) all.tin = surface;
    return all;
  }
  for (const bool all_near : {false, true}) {
    Cutter cutter(surface, region, where_faces_lie(surface, region, all_near, context), context);
    if (!cutter.run() && !all_near) continue;
    Clipped result = cutter.take(side);
    context.progress("clip", 1);
    return result;
  }
  return {};
}

}  // namespace terrane
