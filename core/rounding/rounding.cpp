// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/rounding/rounding.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/error.hpp"
#include "core/rounding/greedy.hpp"
#include "core/rounding/kinetic.hpp"
#include "core/rounding/lost_vertices.hpp"
#include "core/rounding/mesh_editor.hpp"
#include "core/shortest.hpp"

namespace terrane {
namespace {

std::vector<Index> bad_faces(const MeshEditor& editor) {
  std::vector<Index> bad;
  for (Index f = 0; f < static_cast<Index>(editor.mesh().faces.size()); ++f)
    if (editor.alive(f) && editor.sign(f) <= 0) bad.push_back(f);
  return bad;
}

std::vector<Index> changed_faces(const MeshEditor& editor) {
  std::vector<Index> changed;
  editor.changed({}, changed);
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  std::erase_if(changed, [&](Index f) { return !editor.alive(f); });
  return changed;
}

/// Adds the faces around those given.
void widen(const MeshEditor& editor, std::vector<Index>& faces) {
  std::vector<Index> around;
  for (std::size_t i = 0, n = faces.size(); i < n; ++i)
    for (const Index v : editor.mesh().faces[faces[i]]) {
      editor.star(v, around);
      faces.insert(faces.end(), around.begin(), around.end());
    }
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
}

/// Gives a face that is farther than the bound from what its label stands for the nearest label that the faces around
/// it have, or had `before`: no face may have it any more. Returns the spill that is left.
double call_label_back(MeshEditor& editor, const Array<Index>& before, const Spill& spill, double bound, Index f) {
  double here = spill(editor.mesh().labels[f], editor.corners(f));
  std::vector<Index> near{f};
  for (int ring = 0; here > bound && ring < 4; ++ring) {
    widen(editor, near);
    for (const Index g : near)
      for (const Index label : {editor.mesh().labels[g], before[g]}) {
        if (label == none) continue;
        const double there = spill(label, editor.corners(f));
        if (there < here) here = there, editor.relabel(f, label);
      }
  }
  return here;
}

/// Part of what a label stands for may be the outside of an input, which has no corners to be far from: a flip may hand
/// it to a face of any size that the border surrounds. So the middle of every face that changed says whether that is
/// outside, and the face gets the label that is at home there where all of it is within the bound.
void take_back_from_outside(MeshEditor& editor, const Spill& spill, const std::function<Index(Index, Point2)>& at_home,
                            double bound) {
  const PlanarMesh& mesh = editor.mesh();
  for (const Index f : changed_faces(editor)) {
    const Face& c = mesh.faces[f];
    const Point2 p = mesh.points[c[0]], q = mesh.points[c[1]], r = mesh.points[c[2]];
    const Point2 middle{p.x + (q.x - p.x) / 3 + (r.x - p.x) / 3, p.y + (q.y - p.y) / 3 + (r.y - p.y) / 3};
    const Index label = at_home(mesh.labels[f], middle);
    if (label != mesh.labels[f] && spill(label, editor.corners(f)) <= bound) editor.relabel(f, label);
  }
}

/// Flips an edge of f where the larger spill of the two faces beside it becomes less. Returns the other face, or none.
Index flip_back(MeshEditor& editor, const Array<Index>& before, const Spill& spill, double bound, Index f) {
  const PlanarMesh& mesh = editor.mesh();
  for (int k = 0; k < 3; ++k) {
    MeshEditor::Quad quad;
    if (!editor.quad(f, k, quad)) continue;
    if (mesh.labels[f] != none && mesh.labels[quad.g] == none) continue;  // nothing is given to the exterior
    const double now =
        std::max(spill(mesh.labels[f], editor.corners(f)), spill(mesh.labels[quad.g], editor.corners(quad.g)));
    const MeshEditor::Mark mark = editor.mark();
    editor.flip(f, k, quad);
    if (editor.sign(f) > 0 && editor.sign(quad.g) > 0 &&
        std::max(call_label_back(editor, before, spill, bound, f),
                 call_label_back(editor, before, spill, bound, quad.g)) < now)
      return quad.g;
    editor.undo(mark);
  }
  return none;
}

/// A row of flips hands a label on from face to face, too far at times, or leaves two fans between two rows of vertices
/// where a zigzag would keep every face near its label. Returns the largest spill that is left.
double call_labels_back(MeshEditor& editor, const Array<Index>& before, const Spill& spill, double bound) {
  std::vector<Index> todo = changed_faces(editor);
  for (std::size_t i = 0; i < todo.size(); ++i) {
    if (call_label_back(editor, before, spill, bound, todo[i]) <= bound) continue;
    const Index g = flip_back(editor, before, spill, bound, todo[i]);
    if (g != none) todo.insert(todo.end(), {todo[i], g});
  }
  double largest = 0;
  for (const Index f : changed_faces(editor))
    largest = std::max(largest, spill(editor.mesh().labels[f], editor.corners(f)));
  return largest;
}

/// The ladder: greedy alone; kinetic for the clusters greedy cannot mend and greedy for the rest; kinetic for all, at
/// once where these clusters are no exception. Kinetic moves need the mesh as it was, since exact places are valid in
/// that one only.
KineticMoves mend(MeshEditor& editor, const std::vector<Index>& bad, const std::function<ExactPlace(Index)>& place,
                  const Spill& spill, double bound, const Array<Index>& before, Context& context) {
  const std::vector<Index> hard = mend_greedily(editor, bad, place, spill, bound);
  if (hard.empty()) return {};
  editor.undo({});
  if (hard.size() > bad.size() / 4) return move_kinetically(editor, bad, place, context);
  const KineticMoves moves = move_kinetically(editor, hard, place, context);
  mend_greedily(editor, bad_faces(editor), place, spill, bound);
  if (bad_faces(editor).empty() && (!spill || call_labels_back(editor, before, spill, bound) <= bound)) return moves;
  editor.undo({});
  // Rounded places that were moved stay moved, and other faces may be bad there.
  const KineticMoves all = move_kinetically(editor, bad_faces(editor), place, context);
  return {all.vertices, all.shift + moves.shift};
}

}  // namespace

Spill farthest_corner(std::function<double(Index, Point2)> distance) {
  return [distance = std::move(distance)](Index label, std::span<const Point2> corners) {
    double largest = 0;
    for (const Point2 p : corners) largest = std::max(largest, distance(label, p));
    return largest;
  };
}

void connect(PlanarMesh& mesh) {
  std::vector<Index> start(mesh.points.size() + 2, 0);
  const auto each = [&](auto&& visit) {
    for (std::size_t f = 0; f < mesh.faces.size(); ++f)
      for (int k = 0; mesh.faces[f][0] != none && k < 3; ++k) {
        const Index p = mesh.faces[f][(k + 1) % 3], q = mesh.faces[f][(k + 2) % 3];
        visit(static_cast<Index>(f), k, std::min(p, q), std::max(p, q));
      }
  };
  each([&](Index, int, Index low, Index) { ++start[low + 2]; });
  for (std::size_t i = 2; i < start.size(); ++i) start[i] += start[i - 1];
  struct Entry {
    Index high, face;
    int k;
  };
  std::vector<Entry> entries(start.back());
  each([&](Index f, int k, Index low, Index high) { entries[start[low + 1]++] = {high, f, k}; });
  mesh.neighbours.assign(mesh.faces.size(), {none, none, none});
  for (std::size_t low = 0; low < mesh.points.size(); ++low) {
    std::sort(entries.begin() + start[low], entries.begin() + start[low + 1],
              [](const Entry& a, const Entry& b) { return a.high < b.high; });
    for (Index i = start[low]; i + 1 < start[low + 1]; ++i)
      if (entries[i].high == entries[i + 1].high) {
        mesh.neighbours[entries[i].face][entries[i].k] = entries[i + 1].face;
        mesh.neighbours[entries[i + 1].face][entries[i + 1].k] = entries[i].face;
      }
  }
}

Rounded round_and_verify(PlanarMesh& mesh, const std::function<ExactPlace(Index)>& place, Context& context,
                         const Spill& spill, const std::function<Index(Index, Point2)>& at_home) {
  Rounded result;
  for (Index v = 0; v < static_cast<Index>(mesh.points.size()); ++v) {
    const ExactPlace exact = place(v);
    if (exact.kind == ExactPlace::input) continue;
    const double bound = exact.kind == ExactPlace::lattice
                             ? std::hypot(mesh.points[v].x - exact.p.x, mesh.points[v].y - exact.p.y)
                             : rounding_bound(exact);
    result.report.max_move = std::max(result.report.max_move, bound);
  }
  MeshEditor editor(mesh);
  const Array<Index> before = mesh.labels;
  const double bound = 3 * result.report.max_move;
  const std::vector<Index> bad = bad_faces(editor);
  if (!bad.empty()) {
    const KineticMoves moves = mend(editor, bad, place, spill, bound, before, context);
    result.report.kinetic = moves.vertices;
    result.report.max_move += moves.shift;
    if (const std::vector<Index> left = bad_faces(editor); !left.empty()) {
      const Point2 at = mesh.points[mesh.faces[left[0]][0]];
      throw Error(
          ErrorKind::input, "rounding",
          "near " + shortest(at.x) + ", " + shortest(at.y) +
              " the surfaces come closer to each other than doubles can tell apart, and " +
              std::to_string(left.size()) +
              " faces cannot be kept positive; snap their vertices together or use coordinates nearer the origin");
    }
    const auto take_back = [&] {
      if (at_home) take_back_from_outside(editor, spill, at_home, 3 * result.report.max_move);
    };
    take_back();
    if (spill) result.report.lost = keep_input_vertices(editor, place, spill, bound);
    take_back();  // vertices are kept with flips
  }
  if (spill) result.report.max_spill = call_labels_back(editor, before, spill, 3 * result.report.max_move);
  result.relabelled = changed_faces(editor);
  result.report.merges = editor.merges();
  result.report.flips = editor.flips();
  result.merged_into = editor.merged_into();
  for (Index v = 0; v < static_cast<Index>(result.merged_into.size()); ++v)  // follow chains of merges to their end
    while (result.merged_into[v] != result.merged_into[result.merged_into[v]])
      result.merged_into[v] = result.merged_into[result.merged_into[v]];
  return result;
}

}  // namespace terrane
