// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/rounding/mesh_editor.hpp"

#include <algorithm>
#include <numeric>

#include "core/predicates.hpp"

namespace terrane {

MeshEditor::MeshEditor(PlanarMesh& mesh)
    : mesh_(mesh), face_of_(mesh.points.size(), none), merged_into_(mesh.points.size()) {
  std::iota(merged_into_.begin(), merged_into_.end(), 0);
  for (Index f = 0; f < static_cast<Index>(mesh.faces.size()); ++f)
    if (alive(f)) anchor(f);
}

int MeshEditor::sign(Index f) const {
  const Face& c = mesh_.faces[f];
  return orientation(mesh_.points[c[0]], mesh_.points[c[1]], mesh_.points[c[2]]);
}

void MeshEditor::star(Index v, std::vector<Index>& faces) const {
  faces.clear();
  const Index start = face_of_[v];
  Index f = start;
  do {  // counter-clockwise: across the edge from v to corner k + 2
    faces.push_back(f);
    f = mesh_.neighbours[f][(corner_of(f, v) + 1) % 3];
  } while (f != none && f != start);
  if (f == start) return;
  for (f = mesh_.neighbours[start][(corner_of(start, v) + 2) % 3]; f != none;
       f = mesh_.neighbours[f][(corner_of(f, v) + 2) % 3])
    faces.push_back(f);
}

bool MeshEditor::quad(Index f, int k, Quad& quad) const {
  const Index g = mesh_.neighbours[f][k];
  if (g == none) return false;
  const Face& c = mesh_.faces[f];
  const int j = mesh_.neighbours[g][0] == f && mesh_.faces[g][1] == c[(k + 2) % 3]   ? 0
                : mesh_.neighbours[g][1] == f && mesh_.faces[g][2] == c[(k + 2) % 3] ? 1
                                                                                     : 2;
  quad = {g, c[k], c[(k + 1) % 3], c[(k + 2) % 3], mesh_.faces[g][j]};
  if (quad.u == quad.w) return false;
  star(quad.u, scratch_[0]);
  for (Index h : scratch_[0])
    for (Index v : mesh_.faces[h])
      if (v == quad.w) return false;  // the edge is there already
  return true;
}

void MeshEditor::relink(Index f, Index from, Index to) {
  if (f == none) return;
  save(f);
  for (Index& n : mesh_.neighbours[f])
    if (n == from) {
      n = to;
      return;
    }
}

void MeshEditor::flip(Index f, int k, const Quad& quad) {
  const auto [g, u, p, q, w] = quad;
  const int j = corner_of(g, w);
  const Index uq = mesh_.neighbours[f][(k + 1) % 3], up = mesh_.neighbours[f][(k + 2) % 3];
  const Index wp = mesh_.neighbours[g][(j + 1) % 3], wq = mesh_.neighbours[g][(j + 2) % 3];
  save(f);
  save(g);
  mesh_.faces[f] = {u, p, w};
  mesh_.neighbours[f] = {wp, g, up};
  mesh_.faces[g] = {u, w, q};
  mesh_.neighbours[g] = {wq, uq, f};
  mesh_.labels[f] = mesh_.labels[g];
  relink(wp, g, f);
  relink(uq, f, g);
  anchor(f);
  anchor(g);
  ++flips_;
}

bool MeshEditor::merge(Index f, int k, Index keep) {
  const Index a = mesh_.faces[f][(k + 1) % 3], b = mesh_.faces[f][(k + 2) % 3], gone = keep == a ? b : a;
  const Index g = mesh_.neighbours[f][k];
  // Link condition: the two share no neighbours but the apexes of the faces on their edge.
  star(gone, scratch_[0]);
  star(keep, scratch_[1]);
  std::vector<Index> near[2], shared;
  for (int i = 0; i < 2; ++i) {
    for (Index h : scratch_[i]) near[i].insert(near[i].end(), mesh_.faces[h].begin(), mesh_.faces[h].end());
    std::sort(near[i].begin(), near[i].end());
    near[i].erase(std::unique(near[i].begin(), near[i].end()), near[i].end());
  }
  std::set_intersection(near[0].begin(), near[0].end(), near[1].begin(), near[1].end(), std::back_inserter(shared));
  if (shared.size() != (g == none ? 3u : 4u)) return false;  // keep, gone and the apexes
  const std::vector<Index> around = scratch_[0];
  for (Index dying : {f, g}) {
    if (dying == none) continue;
    const int at_keep = corner_of(dying, keep), at_gone = corner_of(dying, gone);
    const Index n1 = mesh_.neighbours[dying][at_keep], n2 = mesh_.neighbours[dying][at_gone];
    if (n1 == none && n2 == none) return false;
  }
  for (Index dying : {f, g}) {
    if (dying == none) continue;
    const int at_keep = corner_of(dying, keep), at_gone = corner_of(dying, gone);
    const Index n1 = mesh_.neighbours[dying][at_keep], n2 = mesh_.neighbours[dying][at_gone];
    relink(n1, dying, n2);
    relink(n2, dying, n1);
    save(dying);
    mesh_.faces[dying] = {none, none, none};
    for (Index n : {n1, n2})
      if (n != none) anchor(n);
  }
  for (Index h : around) {
    if (!alive(h)) continue;
    save(h);
    mesh_.faces[h][corner_of(h, gone)] = keep;
    anchor(h);
  }
  journal_.push_back({none, {}, {}, none, gone});
  merged_into_[gone] = keep;
  ++merges_;
  return true;
}

void MeshEditor::undo(Mark mark) {
  flips_ = mark.flips;
  std::vector<Index> touched;
  while (journal_.size() > mark.entries) {
    const Entry& e = journal_.back();
    if (e.face == none) {
      merged_into_[e.vertex] = e.vertex;
      --merges_;
    } else {
      mesh_.faces[e.face] = e.corners;
      mesh_.neighbours[e.face] = e.neighbours;
      mesh_.labels[e.face] = e.label;
      touched.push_back(e.face);
    }
    journal_.pop_back();
  }
  for (Index f : touched)
    if (alive(f)) anchor(f);
}

void MeshEditor::changed(Mark mark, std::vector<Index>& faces) const {
  for (std::size_t i = mark.entries; i < journal_.size(); ++i)
    if (journal_[i].face != none) faces.push_back(journal_[i].face);
}

void MeshEditor::labelled_before(std::vector<Index>& vertices) const {
  for (const Entry& e : journal_)
    if (e.face != none && e.label != none) vertices.insert(vertices.end(), e.corners.begin(), e.corners.end());
}

}  // namespace terrane
