// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/rounding/greedy.hpp"

#include <algorithm>
#include <cmath>

#include "core/predicates.hpp"

namespace terrane {
namespace {

class Greedy {
 public:
  Greedy(MeshEditor& editor, const std::function<ExactPlace(Index)>& place, const Spill& spill, double bound)
      : editor_(editor), place_(place), spill_(spill), bound_(bound) {}

  std::vector<Index> run(const std::vector<Index>& bad) {
    std::vector<bool> seen(editor_.mesh().faces.size());
    std::vector<Index> left;
    for (Index f : bad) {
      if (seen[f] || !editor_.alive(f) || editor_.sign(f) > 0) continue;
      const std::vector<Index> cluster = collect(f, seen);
      const MeshEditor::Mark mark = editor_.mark();
      if (mend(cluster, mark)) continue;
      editor_.undo(mark);
      left.insert(left.end(), cluster.begin(), cluster.end());
    }
    return left;
  }

 private:
  std::vector<Index> collect(Index start, std::vector<bool>& seen) {
    std::vector<Index> cluster{start};
    seen[start] = true;
    for (std::size_t i = 0; i < cluster.size(); ++i)
      for (Index g : editor_.mesh().neighbours[cluster[i]])
        if (g != none && !seen[g] && editor_.sign(g) <= 0) {
          seen[g] = true;
          cluster.push_back(g);
        }
    return cluster;
  }

  bool mend(std::vector<Index> todo, MeshEditor::Mark mark) {
    std::size_t budget = 20 * todo.size() + 40;
    while (!todo.empty()) {
      if (budget-- == 0) return false;
      const Index f = todo.back();
      todo.pop_back();
      if (!editor_.alive(f) || editor_.sign(f) > 0) continue;
      const MeshEditor::Mark before = editor_.mark();
      if (!merge_equal(f) && !flip_middle(f)) return false;
      editor_.changed(before, todo);
    }
    if (!spill_) return true;
    std::vector<Index> changed;
    editor_.changed(mark, changed);
    return std::all_of(changed.begin(), changed.end(), [&](Index f) {
      return !editor_.alive(f) || spill_(editor_.mesh().labels[f], editor_.corners(f)) <= bound_;
    });
  }

  bool merge_equal(Index f) {
    const PlanarMesh& mesh = editor_.mesh();
    for (int k = 0; k < 3; ++k) {
      const Index p = mesh.faces[f][(k + 1) % 3], q = mesh.faces[f][(k + 2) % 3];
      if (!(mesh.points[p] == mesh.points[q])) continue;
      const bool p_fixed = place_(p).kind == ExactPlace::input, q_fixed = place_(q).kind == ExactPlace::input;
      if (p_fixed && q_fixed) continue;
      if (editor_.merge(f, k, p_fixed ? p : q_fixed ? q : std::min(p, q))) return true;
    }
    return false;
  }

  /// The middle vertex of a flat or turned-over face lies between the ends of the edge opposite it, or beyond it.
  bool flip_middle(Index f) {
    const PlanarMesh& mesh = editor_.mesh();
    int longest = 0;
    double length = -1;
    for (int k = 0; k < 3; ++k) {
      const Point2 p = mesh.points[mesh.faces[f][(k + 1) % 3]], q = mesh.points[mesh.faces[f][(k + 2) % 3]];
      const double l = std::hypot(q.x - p.x, q.y - p.y);
      if (l > length) length = l, longest = k;
    }
    MeshEditor::Quad quad;
    if (!editor_.quad(f, longest, quad)) return false;
    const auto positive = [&](Index a, Index b, Index c) {
      return orientation(mesh.points[a], mesh.points[b], mesh.points[c]) > 0;
    };
    if (!positive(quad.u, quad.p, quad.w) || !positive(quad.u, quad.w, quad.q)) return false;
    editor_.flip(f, longest, quad);
    return true;
  }

  MeshEditor& editor_;
  const std::function<ExactPlace(Index)>& place_;
  const Spill& spill_;
  double bound_;
};

}  // namespace

std::vector<Index> mend_greedily(MeshEditor& editor, const std::vector<Index>& bad,
                                 const std::function<ExactPlace(Index)>& place, const Spill& spill, double bound) {
  return Greedy(editor, place, spill, bound).run(bad);
}

}  // namespace terrane
