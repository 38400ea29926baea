// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/lost_vertices.hpp"

#include <algorithm>
#include <cmath>

#include "core/greedy.hpp"

namespace terrane {
namespace {

class Keeper {
 public:
  Keeper(MeshEditor& editor, const std::function<ExactPlace(Index)>& place,
         const std::function<double(Index label, Point2)>& distance, double bound)
      : editor_(editor), place_(place), distance_(distance), bound_(bound) {}

  bool labelled(Index v) {
    editor_.star(v, star_);
    return std::any_of(star_.begin(), star_.end(), [&](Index f) { return editor_.mesh().labels[f] != none; });
  }

  bool bring_back(Index v) {
    for (const auto& [distance, c] : beside(v)) {
      const MeshEditor::Mark mark = editor_.mark();
      if (merge(c, v) && sound(mark) && labelled(v)) return true;
      editor_.undo(mark);
    }
    return false;
  }

 private:
  /// The vertices that may be merged into v, the nearest first.
  std::vector<std::pair<double, Index>> beside(Index v) {
    const PlanarMesh& mesh = editor_.mesh();
    std::vector<std::pair<double, Index>> near;
    editor_.star(v, star_);
    for (Index f : star_)
      for (Index c : mesh.faces[f]) {
        const double d = std::hypot(mesh.points[c].x - mesh.points[v].x, mesh.points[c].y - mesh.points[v].y);
        if (c != v && d <= bound_ && place_(c).kind != ExactPlace::input) near.emplace_back(d, c);
      }
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    std::erase_if(near, [&](const auto& c) { return !labelled(c.second); });
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
    if (!mend_greedily(editor_, bad, place_, distance_, bound_).empty()) return false;
    changed.clear();
    editor_.changed(mark, changed);
    for (Index f : changed)
      if (editor_.alive(f))
        for (Index v : editor_.mesh().faces[f])
          if (distance_(editor_.mesh().labels[f], editor_.mesh().points[v]) > bound_) return false;
    return true;
  }

  MeshEditor& editor_;
  const std::function<ExactPlace(Index)>& place_;
  const std::function<double(Index, Point2)>& distance_;
  double bound_;
  std::vector<Index> star_;
};

}  // namespace

Index keep_input_vertices(MeshEditor& editor, const std::function<ExactPlace(Index)>& place,
                          const std::function<double(Index label, Point2)>& distance, double bound) {
  std::vector<Index> candidates;
  editor.labelled_before(candidates);
  std::sort(candidates.begin(), candidates.end());
  candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
  Keeper keeper(editor, place, distance, bound);
  Index lost = 0;
  for (Index v : candidates)
    if (place(v).kind == ExactPlace::input && !keeper.labelled(v) && !keeper.bring_back(v)) ++lost;
  return lost;
}

}  // namespace terrane
