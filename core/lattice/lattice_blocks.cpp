// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/lattice/lattice_blocks.hpp"

#include <algorithm>
#include <utility>

namespace terrane {

namespace {

int block_of(const LatticeMesh& mesh, const LatticeTriangle& t, const LatticeGrid& grid) {
  std::int64_t x = 0, y = 0;  // three times the centroid
  for (const Index v : t.v) x += mesh.points[v].x, y += mesh.points[v].y;
  const auto column = std::min<std::int64_t>(x * grid.columns / (3 * (grid.width - 1)), grid.columns - 1);
  const auto row = std::min<std::int64_t>(y * grid.rows / (3 * (grid.height - 1)), grid.rows - 1);
  return static_cast<int>(row * grid.columns + column);
}

/// What stands for the neighbour beyond a seam, below `none`: the same from both sides.
Index seam_code(const LatticeMesh& mesh, Index t, int k) {
  const Index o = mesh.triangles[t].n[k];
  if (o < t) {
    const auto& n = mesh.triangles[o].n;
    return seam_code(mesh, o, static_cast<int>(std::find(n.begin(), n.end(), t) - n.begin()));
  }
  return none - 1 - (3 * t + k);
}

}  // namespace

LatticeBlocks::LatticeBlocks(LatticeMesh whole, const LatticeGrid& grid)
    : blocks(static_cast<std::size_t>(grid.columns) * grid.rows, LatticeMesh(grid.width, grid.height)),
      whole_(std::move(whole)),
      vertex_(blocks.size()) {
  std::vector<int> block(whole_.triangles.size());
  std::vector<Index> place(whole_.triangles.size());
  std::vector<std::vector<Index>> members(blocks.size());
  for (std::size_t t = 0; t < block.size(); ++t) {
    block[t] = block_of(whole_, whole_.triangles[t], grid);
    place[t] = static_cast<Index>(members[block[t]].size());
    members[block[t]].push_back(static_cast<Index>(t));
  }
  std::vector<Index> number(whole_.points.size(), none);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    LatticeMesh& mesh = blocks[b];
    mesh.points.clear();
    mesh.triangles.clear();
    for (const Index t : members[b]) {
      LatticeTriangle part = whole_.triangles[t];
      for (Index& v : part.v) {
        if (number[v] == none) {
          number[v] = static_cast<Index>(mesh.points.size());
          mesh.points.push_back(whole_.points[v]);
          vertex_[b].push_back(v);
        }
        v = number[v];
      }
      for (int k = 0; k < 3; ++k) {
        Index& o = part.n[k];
        if (o != none) o = block[o] == static_cast<int>(b) ? place[o] : seam_code(whole_, t, k);
      }
      mesh.triangles.push_back(part);
    }
    for (const Index v : vertex_[b]) number[v] = none;
  }
}

LatticeMesh LatticeBlocks::join() {
  LatticeMesh whole = std::move(whole_);
  whole.triangles.clear();
  struct Side {
    Index seam, t;
    int k;
  };
  std::vector<Side> sides;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const LatticeMesh& mesh = blocks[b];
    std::vector<Index>& vertex = vertex_[b];
    for (std::size_t v = vertex.size(); v < mesh.points.size(); ++v) {
      vertex.push_back(static_cast<Index>(whole.points.size()));
      whole.points.push_back(mesh.points[v]);
    }
    const Index first = static_cast<Index>(whole.triangles.size());
    for (LatticeTriangle t : mesh.triangles) {
      for (Index& v : t.v) v = vertex[v];
      for (int k = 0; k < 3; ++k) {
        if (t.n[k] >= 0) t.n[k] += first;
        if (t.n[k] < none) sides.push_back({t.n[k], static_cast<Index>(whole.triangles.size()), k});
      }
      whole.triangles.push_back(t);
    }
    blocks[b] = LatticeMesh(2, 2);
    vertex = {};
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::pair{a.seam, a.t} < std::pair{b.seam, b.t};
  });
  std::vector<std::array<Index, 2>> seams;
  for (std::size_t i = 0; i + 1 < sides.size(); i += 2) {
    const Side &a = sides[i], &b = sides[i + 1];
    whole.triangles[a.t].n[a.k] = b.t;
    whole.triangles[b.t].n[b.k] = a.t;
    seams.push_back({a.t, a.k});
  }
  whole.restore_delaunay(std::move(seams));
  return whole;
}

}  // namespace terrane
