// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/plan/zone_polygons.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/predicates.hpp"

namespace terrane {
namespace {

class Tracer {
 public:
  explicit Tracer(const ZonedMesh& mesh) : mesh_(mesh), pieces_(pieces_of(mesh)) {
    seen_.assign(3 * mesh.faces.size(), 0);
    at_.assign(mesh.points.size(), none);
  }

  std::vector<std::vector<Polygon>> run() {
    std::vector<Polygon> pieces(pieces_.zone_of_piece.size());
    for (Index f = 0; f < static_cast<Index>(mesh_.faces.size()); ++f)
      for (int k = 0; k < 3; ++k)
        if (is_border(f, k) && !seen_[3 * static_cast<std::size_t>(f) + k])
          trace(f, k, pieces[pieces_.piece_of_face[f]]);
    Index zones = 0;
    for (const Index zone : pieces_.zone_of_piece) zones = std::max(zones, zone + 1);
    std::vector<std::vector<Polygon>> result(zones);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      std::sort(pieces[i].holes.begin(), pieces[i].holes.end(), [](const Line& a, const Line& b) {
        return std::pair(a.front().x, a.front().y) < std::pair(b.front().x, b.front().y);
      });
      result[pieces_.zone_of_piece[i]].push_back(std::move(pieces[i]));
    }
    return result;
  }

 private:
  /// The edge opposite corner k.
  bool is_border(Index f, int k) const {
    const Index g = pieces_.neighbours[f][k];
    return g == none || mesh_.zone[g] != mesh_.zone[f];
  }

  /// Follows a border with its piece on the left, turning through the piece at every corner. A corner that comes again
  /// ends a ring.
  void trace(Index f, int k, Polygon& polygon) {
    std::vector<Index> path;
    while (!seen_[3 * static_cast<std::size_t>(f) + k]) {
      seen_[3 * static_cast<std::size_t>(f) + k] = 1;
      const Index from = mesh_.faces[f][(k + 1) % 3], to = mesh_.faces[f][(k + 2) % 3];
      if (at_[from] != none) take_ring(path, at_[from], polygon);
      at_[from] = static_cast<Index>(path.size());
      path.push_back(from);
      // The next border edge begins at `to`: of the faces around it, through the piece.
      int edge = (k + 1) % 3;
      while (!is_border(f, edge)) {
        f = pieces_.neighbours[f][edge];
        int corner = 0;
        while (mesh_.faces[f][corner] != to) ++corner;
        edge = (corner + 2) % 3;
      }
      k = edge;
    }
    take_ring(path, 0, polygon);
  }

  void take_ring(std::vector<Index>& path, Index first, Polygon& polygon) {
    Line ring;
    for (std::size_t i = static_cast<std::size_t>(first); i < path.size(); ++i) {
      const Point2 p = mesh_.points[path[i]];
      ring.push_back({p.x, p.y, NAN});
      at_[path[i]] = none;
    }
    path.resize(static_cast<std::size_t>(first));
    const auto lowest = std::min_element(ring.begin(), ring.end(), [](const Point& a, const Point& b) {
      return std::pair(a.x, a.y) < std::pair(b.x, b.y);
    });
    std::rotate(ring.begin(), lowest, ring.end());
    // The turn at an extreme corner says exactly which way a simple ring runs.
    const bool outer = orientation(plan(ring.back()), plan(ring[0]), plan(ring[1])) > 0;
    if (outer)
      polygon.outer = std::move(ring);
    else
      polygon.holes.push_back(std::move(ring));
  }

  const ZonedMesh& mesh_;
  ZonePieces pieces_;
  std::vector<std::uint8_t> seen_;  // per half-edge 3 * face + corner opposite
  std::vector<Index> at_;           // per point: where the path passes it
};

}  // namespace

std::vector<std::vector<Polygon>> zone_polygons(const ZonedMesh& mesh) { return Tracer(mesh).run(); }

}  // namespace terrane
