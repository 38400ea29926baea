// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "core/rounding/rounding.hpp"

// Local surgery on a planar mesh: stars, edge flips, merges of two vertices, and taking them back.
namespace terrane {

class MeshEditor {
 public:
  explicit MeshEditor(PlanarMesh& mesh);

  PlanarMesh& mesh() { return mesh_; }
  const PlanarMesh& mesh() const { return mesh_; }
  bool alive(Index f) const { return mesh_.faces[f][0] != none; }
  /// Of the area of face f, exactly.
  int sign(Index f) const;
  std::array<Point2, 3> corners(Index f) const {
    const Face& c = mesh_.faces[f];
    return {mesh_.points[c[0]], mesh_.points[c[1]], mesh_.points[c[2]]};
  }
  int corner_of(Index f, Index v) const { return mesh_.faces[f][0] == v ? 0 : mesh_.faces[f][1] == v ? 1 : 2; }
  /// The live faces around v.
  void star(Index v, std::vector<Index>& faces) const;
  /// What a flip of the edge opposite corner k of face f would work on; false when there is none across or it exists
  /// already.
  struct Quad {
    Index g;           // the face across
    Index u, p, q, w;  // f = u p q, g = w q p; the flip makes u p w and u w q
  };
  bool quad(Index f, int k, Quad& quad) const;
  /// Flips; both faces get the label of the face across.
  void flip(Index f, int k, const Quad& quad);
  /// Merges the ends of the edge opposite corner k of f into `keep`, one of them; false when the result would be no
  /// mesh.
  bool merge(Index f, int k, Index keep);

  void relabel(Index f, Index label) {
    save(f);
    mesh_.labels[f] = label;
  }

  /// Everything done since the mark is undone, in reverse.
  struct Mark {
    std::size_t entries = 0;
    Index flips = 0;
  };
  Mark mark() const { return {journal_.size(), flips_}; }
  void undo(Mark mark);
  /// Faces changed since the mark, each possibly several times.
  void changed(Mark mark, std::vector<Index>& faces) const;
  /// The vertices that were corners of a labelled face before it changed, each possibly several times.
  void labelled_before(std::vector<Index>& vertices) const;
  const std::vector<Index>& merged_into() const { return merged_into_; }
  Index merges() const { return merges_; }
  Index flips() const { return flips_; }

 private:
  struct Entry {  // a face as it was; or, with face == none, a vertex that was merged
    Index face;
    Face corners, neighbours;
    Index label, vertex;
  };
  void save(Index f) { journal_.push_back({f, mesh_.faces[f], mesh_.neighbours[f], mesh_.labels[f], none}); }
  void relink(Index f, Index from, Index to);
  void anchor(Index f) {
    for (Index v : mesh_.faces[f]) face_of_[v] = f;
  }

  PlanarMesh& mesh_;
  std::vector<Index> face_of_;  // some live face at each vertex
  std::vector<Index> merged_into_;
  std::vector<Entry> journal_;
  Index merges_ = 0, flips_ = 0;
  mutable std::vector<Index> scratch_[2];
};

}  // namespace terrane
