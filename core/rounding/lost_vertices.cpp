// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/rounding/lost_vertices.hpp"

#include <algorithm>
#include <cmath>

#include "core/rounding/greedy.hpp"

namespace terrane {
namespace {

class Keeper {
 public:
  Keeper(MeshEditor& editor, const std::function<ExactPlace(Index)>& place, const Spill& spill, double bound)
      : editor_(editor), place_(place), spill_(spill), bound_(bound) {}

  /// The input vertices that have lost their labelled faces.
  std::vector<Index> without_faces() {
    std::vector<Index> vertices;
    editor_.labelled_before(vertices);
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    std::erase_if(vertices, [&](Index v) { return place_(v).kind != ExactPlace::input || labelled(v); });
    return vertices;
  }

  bool labelled(Index v) {
    editor_.star(v, star_);
    return std::any_of(star_.begin(), star_.end(), [&](Index f) { return editor_.mesh().labels[f] != none; });
  }

  /// Whether v lies in what the label stands for, or no farther from it than one move. To be kept by others only would
  /// add more to the area, along the whole border, than moves may.
  bool at_home(Index v, Index label) {
    return label != none && spill_(label, {&editor_.mesh().points[v], 1}) <= bound_ / 3;
  }
  bool at_home(Index v) {
    editor_.star(v, star_);
    return std::any_of(star_.begin(), star_.end(), [&](Index f) { return at_home(v, editor_.mesh().labels[f]); });
  }

  /// Gives a face of the exterior beside v to the region next to it, where it is no farther from that than rounding.
  bool widen(Index v) {
    const PlanarMesh& mesh = editor_.mesh();
    editor_.star(v, star_);
    for (const Index f : star_)
      for (const Index g : mesh.neighbours[f]) {
        const Index label = g == none ? none : mesh.labels[g];
        if (!at_home(v, label) || !within_bound(f, label)) continue;
        editor_.relabel(f, label);
        return true;
      }
    return false;
  }

  /// The same after a flip: a face of the exterior that is not at v may lie between v and the region.
  bool flip_and_widen(Index v) {
    std::vector<Index> around;
    editor_.star(v, around);
    for (const Index f : around) {
      MeshEditor::Quad quad;
      const int k = editor_.corner_of(f, v);
      if (!editor_.quad(f, k, quad) || editor_.mesh().labels[quad.g] != none) continue;
      const MeshEditor::Mark mark = editor_.mark();
      editor_.flip(f, k, quad);
      if (editor_.sign(f) > 0 && editor_.sign(quad.g) > 0 && widen(v)) return true;
      editor_.undo(mark);
    }
    return false;
  }

  /// By a merge, after vertices of the exterior that stand between, however many, were merged into v as well. With
  /// `widening` merges may also leave v with faces of the exterior only, when one of these can go to the region next to
  /// it.
  bool bring_back(Index v, bool widening) {
    const MeshEditor::Mark start = editor_.mark();
    for (bool nearer = true; nearer;) {
      nearer = false;
      for (const Candidate& c : beside(v)) {
        const MeshEditor::Mark mark = editor_.mark();
        if (merge(c.vertex, v) && sound(mark)) {
          if (at_home(v) || (widening && widen(v))) return true;
          if ((nearer = c.exterior)) break;
        }
        editor_.undo(mark);
      }
    }
    editor_.undo(start);
    return false;
  }

 private:
  struct Candidate {
    bool exterior;  // has no labelled face
    double distance;
    Index vertex;
    auto operator<=>(const Candidate&) const = default;
  };

  /// The vertices that may be merged into v: those with a labelled face first, the nearest first.
  std::vector<Candidate> beside(Index v) {
    const PlanarMesh& mesh = editor_.mesh();
    std::vector<Candidate> near;
    editor_.star(v, star_);
    for (Index f : star_)
      for (Index c : mesh.faces[f]) {
        const double d = std::hypot(mesh.points[c].x - mesh.points[v].x, mesh.points[c].y - mesh.points[v].y);
        if (c != v && d <= bound_ && place_(c).kind != ExactPlace::input) near.push_back({false, d, c});
      }
    for (Candidate& c : near) c.exterior = !labelled(c.vertex);
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    return near;
  }

  bool merge(Index gone, Index keep) {
    editor_.star(keep, star_);
    for (Index f : star_) {
      const int k = editor_.corner_of(f, keep);
      for (const int apex : {(k + 1) % 3, (k + 2) % 3})
        if (editor_.mesh().faces[f][3 - k - apex] == gone) return editor_.merge(f, apex, keep);
    }
    return false;
  }

  bool sound(MeshEditor::Mark mark) {
    std::vector<Index> changed, bad;
    editor_.changed(mark, changed);
    for (Index f : changed)
      if (editor_.alive(f) && editor_.sign(f) <= 0) bad.push_back(f);
    if (!mend_greedily(editor_, bad, place_, spill_, bound_).empty()) return false;
    changed.clear();
    editor_.changed(mark, changed);
    for (Index f : changed)
      if (editor_.alive(f) && !within_bound(f, editor_.mesh().labels[f])) return false;
    return true;
  }

  bool within_bound(Index f, Index label) const { return spill_(label, editor_.corners(f)) <= bound_; }

  MeshEditor& editor_;
  const std::function<ExactPlace(Index)>& place_;
  const Spill& spill_;
  double bound_;
  std::vector<Index> star_;
};

}  // namespace

Index keep_input_vertices(MeshEditor& editor, const std::function<ExactPlace(Index)>& place, const Spill& spill,
                          double bound) {
  Keeper keeper(editor, place, spill, bound);
  std::vector<Index> lost = keeper.without_faces();
  for (std::size_t before = lost.size() + 1; !lost.empty() && lost.size() < before;) {
    before = lost.size();
    for (const Index v : lost)
      if (!keeper.labelled(v) && !keeper.bring_back(v, false) && !keeper.widen(v) && !keeper.flip_and_widen(v))
        keeper.bring_back(v, true);
    lost = keeper.without_faces();  // one that is back may let others in that stand behind it, or have cost another's
  }
  return static_cast<Index>(lost.size());
}

}  // namespace terrane
