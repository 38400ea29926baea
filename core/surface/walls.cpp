// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/surface/walls.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/corner_heights.hpp"

namespace terrane {
namespace {

class Raiser {
 public:
  Raiser(const CornerSurface& surface, const Array<Face>& neighbours) : surface_(surface), neighbours_(neighbours) {}

  Walled run(bool walls) {
    make_vertices();
    if (walls)
      for (Index f = 0; f < static_cast<Index>(surface_.faces.size()); ++f)
        for (int k = 0; k < 3; ++k)
          if (neighbours_[f][k] > f) wall(f, k);
    return std::move(result_);
  }

 private:
  /// Vertices place by place, at each by height: a place's vertices stand in a row from the lowest up.
  void make_vertices() {
    Tin& tin = result_.tin;
    const CornersByPlace places = corners_by_place(surface_.faces, surface_.points.size());
    tin.faces.resize(surface_.faces.size());
    std::vector<double> heights;
    for (std::size_t p = 0; p < surface_.points.size(); ++p) {
      heights.clear();
      for (std::size_t i = places.first[p]; i < places.first[p + 1]; ++i)
        heights.push_back(surface_.z[places.corners[i]]);
      std::sort(heights.begin(), heights.end());
      heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
      const std::size_t lowest = tin.vertices.size();
      for (const double z : heights) tin.vertices.push_back({surface_.points[p].x, surface_.points[p].y, z});
      for (std::size_t i = places.first[p]; i < places.first[p + 1]; ++i) {
        const std::size_t c = places.corners[i];
        const auto at = std::lower_bound(heights.begin(), heights.end(), surface_.z[c]) - heights.begin();
        tin.faces[c / 3][c % 3] = static_cast<Index>(lowest + at);
      }
    }
  }

  /// Closes the edge of f opposite corner k: a strip between the vertices that stand in a row at both ends. It is laid
  /// from the bottom up, the lower next vertex first, so that neither side of the seam is preferred.
  void wall(Index f, int k) {
    const Face& upper = result_.tin.faces[f];
    const Index g = neighbours_[f][k];
    int j = 0;
    while (surface_.faces[g][(j + 1) % 3] != surface_.faces[f][(k + 2) % 3]) ++j;
    const Index fp = upper[(k + 1) % 3], fq = upper[(k + 2) % 3];
    const Index gq = result_.tin.faces[g][(j + 1) % 3], gp = result_.tin.faces[g][(j + 2) % 3];
    if (fp == gp && fq == gq) return;
    const bool f_below = fp < gp || fq < gq;
    assert(f_below ? fp <= gp && fq <= gq : fp >= gp && fq >= gq);
    Index p = f_below ? fp : gp, q = f_below ? fq : gq;
    const Index p_end = f_below ? gp : fp, q_end = f_below ? gq : fq;
    while (p != p_end || q != q_end) {
      if (q == q_end || (p != p_end && comes_first(p + 1, q + 1))) {
        emit(q, p, p + 1, f_below);
        ++p;
      } else {
        emit(q, p, q + 1, f_below);
        ++q;
      }
    }
  }

  bool comes_first(Index p, Index q) const {
    const Point &a = result_.tin.vertices[p], &b = result_.tin.vertices[q];
    if (a.z != b.z) return a.z < b.z;
    return a.x != b.x ? a.x < b.x : a.y < b.y;
  }

  void emit(Index a, Index b, Index c, bool f_below) {
    Tin& tin = result_.tin;
    tin.faces.push_back(f_below ? Face{a, b, c} : Face{a, c, b});
    const Point &u = tin.vertices[a], &v = tin.vertices[b], &w = tin.vertices[c];
    const bool at_b = v.x == w.x && v.y == w.y;  // else a and c stand above each other
    const double length = std::hypot(u.x - v.x, u.y - v.y);
    result_.wall_area += 0.5 * length * std::fabs(at_b ? w.z - v.z : w.z - u.z);
  }

  const CornerSurface& surface_;
  const Array<Face>& neighbours_;
  Walled result_;
};

}  // namespace

Walled raise(const CornerSurface& surface, const Array<Face>& neighbours, bool walls) {
  return Raiser(surface, neighbours).run(walls);
}

}  // namespace terrane
