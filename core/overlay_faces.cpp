// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay_faces.hpp"

#include <algorithm>

#include "core/region_fill.hpp"
#include "core/convex.hpp"
#include "core/error.hpp"

namespace terrane {
namespace {

/// A piece of the border of a region that ghost edges cut up.
struct GroupedPiece {
  Index group;
  Piece piece;
};

class FaceBuilder {
 public:
  FaceBuilder(const Arrangement& arrangement, Refinement refinement, bool exactly)
      : arrangement_(arrangement),
        paste_(refinement == Refinement::paste),
        exactly_(exactly),
        faces_of_a_(arrangement.mesh(0).faces()),
        exterior_(faces_of_a_ + arrangement.mesh(1).faces()) {
    for (int m = 0; m < 2; ++m) rate_edges(m);
    place_points();
  }

  OverlayFaces build() {
    arrangement_.trace([&](Region& region) { take(region); });
    if (paste_)
      for (Index f = 0; f < arrangement_.mesh(0).real_faces; ++f) emit_whole(f);
    emit_groups();
    return std::move(out_);
  }

 private:
  bool real(int m, Index face) const { return face != none && arrangement_.mesh(m).real(face); }

  /// How many real faces an edge has; an edge of the box counts as one of the exterior's.
  void rate_edges(int m) {
    const CompletedMesh& mesh = arrangement_.mesh(m);
    real_sides_[m].resize(mesh.half.size());
    for (std::size_t e = 0; e < mesh.half.size(); ++e) {
      const Index h = mesh.half[e], t = mesh.twin[h];
      real_sides_[m][e] = t == none ? 1 : mesh.real(h >> 2) + mesh.real(t >> 2);
    }
  }

  void place_points() {
    out_.points = arrangement_.mesh(0).places;
    const std::vector<Point2>& b = arrangement_.mesh(1).places;
    out_.points.insert(out_.points.end(), b.begin(), b.end());
    out_.points.reserve(arrangement_.vertices());
    for (Index v = arrangement_.first_crossing(); v < arrangement_.vertices(); ++v)
      out_.points.push_back(rounded(crossing_place(arrangement_, v)));
  }

  bool significant(const Piece& p) const {
    return real_sides_[p.mesh][p.edge] > 0 || (p.edge_of_b != none && real_sides_[1][p.edge_of_b] > 0);
  }

  /// Is a vertex in the middle of a chain one of the result?
  bool kept(Index v) const {
    if (v >= arrangement_.first_crossing()) {
      const Crossing& c = arrangement_.crossing(v);
      return (paste_ ? real_sides_[0][c.edge[0]] == 1 : real_sides_[0][c.edge[0]] > 0) && real_sides_[1][c.edge[1]] > 0;
    }
    if (!paste_ || arrangement_.is_place_of(0, v)) return true;
    const Location& where = arrangement_.location(1, arrangement_.place(1, v));
    if (where.kind == Location::face) return !real(0, where.index);
    return real_sides_[0][arrangement_.mesh(0).edge[where.index]] < 2;
  }

  void take(Region& region) {
    const bool in_a = real(0, region.parent[0]), in_b = real(1, region.parent[1]);
    if (paste_ && in_a) return;  // the face of A stays whole
    if (in_a && in_b) {
      begin_region(region.parent[0], region.parent[1]);
      emit_convex(region.corners, region.flat);
      return;
    }
    const Index group = in_a ? region.parent[0] : in_b ? faces_of_a_ + region.parent[1] : exterior_;
    for (const Piece& p : region.pieces)
      if (significant(p)) grouped_.push_back({group, p});
  }

  void begin_region(Index a, Index b) {
    out_.regions.push_back({a, b});
    ++out_.region_count;
  }
  void emit(Index a, Index b, Index c) {
    out_.faces.push_back({a, b, c});
    out_.region_of_face.push_back(static_cast<Index>(out_.regions.size()) - 1);
  }
  void emit_convex(const std::vector<Index>& corners, const std::vector<bool>& flat) {
    ConvexTriangulator(
        std::span<const Index>(corners), flat, [&](Index v) { return out_.points[v]; },
        [&](Index a, Index b, Index c) { emit(a, b, c); })
        .run();
  }

  /// A whole face of mesh m, with the vertices of the other mesh that stay on its edges.
  void emit_whole(Index f, int m = 0) {
    const CompletedMesh& mesh = arrangement_.mesh(m);
    corners_.clear();
    flat_.clear();
    for (int k = 0; k < 3; ++k) {
      const Index h = 4 * f + k, e = mesh.edge[h];
      corners_.push_back(arrangement_.vertex(m, mesh.origin(h)));
      flat_.push_back(false);
      const Chains& chains = arrangement_.chains(m);
      const Index count = chains.count(e);
      for (Index i = 0; i < count; ++i) {
        const Index v = chains.nodes[chains.first[e] + (mesh.half[e] == h ? i : count - 1 - i)];
        if (!kept(v)) continue;
        corners_.push_back(v);
        flat_.push_back(true);
      }
    }
    begin_region(m == 0 ? f : none, m == 1 ? f : none);
    emit_convex(corners_, flat_);
  }

  void emit_groups() {
    std::stable_sort(grouped_.begin(), grouped_.end(), [](auto& s, auto& t) { return s.group < t.group; });
    for (std::size_t i = 0; i < grouped_.size();) {
      std::size_t j = i;
      bool only[2] = {true, true};
      for (; j < grouped_.size() && grouped_[j].group == grouped_[i].group; ++j)
        only[1 - grouped_[j].piece.mesh] = false;
      const Index group = grouped_[i].group;
      if (group < faces_of_a_ && only[0]) {
        emit_whole(group, 0);
      } else if (group >= faces_of_a_ && group < exterior_ && only[1]) {
        emit_whole(group - faces_of_a_, 1);
      } else {
        emit_polygon(group, {grouped_.data() + i, j - i});
      }
      i = j;
    }
  }

  /// A region with any border: pieces are joined over vertices that do not stay, then filled.
  void emit_polygon(Index group, std::span<const GroupedPiece> pieces) {
    border_.clear();
    for (const GroupedPiece& g : pieces) {
      Piece p = g.piece;
      const Index from = arrangement_.tail(p);
      if (!kept(from)) continue;
      const Index last = p.direction == 0 ? arrangement_.chains(p.mesh).count(p.edge) : 0;
      while (p.position != last && !kept(arrangement_.head(p))) p.position += p.direction == 0 ? 1 : -1;
      border_.push_back({from, arrangement_.head(p)});
    }
    FilledRegion filled;
    if (!exactly_) filled = fill_region(out_.points, border_);
    if (!filled.sound)
      filled = fill_region_exactly(
          out_.points,
          [&](Index v) { return v < arrangement_.first_crossing() ? ExactPlace{} : crossing_place(arrangement_, v); },
          border_);
    if (!filled.sound) throw Error(ErrorKind::internal, "overlay", "a region's border does not close");
    const bool outside = group == exterior_;
    out_.regions.push_back(
        {group < faces_of_a_ ? group : none, !outside && group >= faces_of_a_ ? group - faces_of_a_ : none});
    if (!outside) out_.region_count += filled.parts;
    for (const Face& f : filled.faces) emit(f[0], f[1], f[2]);
  }

  const Arrangement& arrangement_;
  bool paste_, exactly_;
  Index faces_of_a_, exterior_;
  std::vector<std::uint8_t> real_sides_[2];
  OverlayFaces out_;
  std::vector<GroupedPiece> grouped_;
  std::vector<BorderEdge> border_;
  std::vector<Index> corners_;
  std::vector<bool> flat_;
};

}  // namespace

ExactPlace crossing_place(const Arrangement& arrangement, Index vertex) {
  const Crossing& c = arrangement.crossing(vertex);
  const CompletedMesh &a = arrangement.mesh(0), &b = arrangement.mesh(1);
  const Index ha = a.half[c.edge[0]], hb = b.half[c.edge[1]];
  ExactPlace place{ExactPlace::crossing, a.at(a.origin(ha)), a.at(a.target(ha)), b.at(b.origin(hb)),
                   b.at(b.target(hb))};
  // Which way an edge happens to be stored must not show in the last bit.
  const auto after = [](Point2 p, Point2 q) { return p.x > q.x || (p.x == q.x && p.y > q.y); };
  if (after(place.p, place.q)) std::swap(place.p, place.q);
  if (after(place.r, place.s)) std::swap(place.r, place.s);
  return place;
}

OverlayFaces faces_of(const Arrangement& arrangement, Refinement refinement, bool exactly, Context& context) {
  FaceBuilder builder(arrangement, refinement, exactly);
  context.progress("overlay", 0.6);
  OverlayFaces faces = builder.build();
  context.progress("overlay", 0.8);
  return faces;
}

}  // namespace terrane
