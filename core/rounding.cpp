// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/rounding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/crossing_point.hpp"
#include "core/error.hpp"
#include "core/kinetic.hpp"
#include "core/kinetic_places.hpp"
#include "core/mesh_editor.hpp"
#include "core/predicates.hpp"

namespace terrane {
namespace {

int sign_of(const PlanarMesh& mesh, Index f) {
  const Face& c = mesh.faces[f];
  return orientation(mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]]);
}

std::vector<Index> bad_faces(const PlanarMesh& mesh) {
  std::vector<Index> bad;
  for (Index f = 0; f < static_cast<Index>(mesh.faces.size()); ++f)
    if (mesh.faces[f][0] != none && sign_of(mesh, f) <= 0) bad.push_back(f);
  return bad;
}

/// The first, fast step: per cluster of bad faces merge vertices with equal doubles and flip the edge opposite the
/// middle vertex; taken back as a whole when the cluster does not come out valid and near its parents.
class Greedy {
 public:
  Greedy(MeshEditor& editor, const std::function<ExactPlace(Index)>& place,
         const std::function<double(Index, Point2)>& distance, double bound)
      : editor_(editor), place_(place), distance_(distance), bound_(bound) {}

  /// Returns the faces of the clusters it could not mend.
  std::vector<Index> run(const std::vector<Index>& bad) {
    std::vector<bool> seen(editor_.mesh().faces.size());
    std::vector<Index> left;
    for (Index f : bad) {
      if (seen[f] || !editor_.alive(f) || sign_of(editor_.mesh(), f) > 0) continue;
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
        if (g != none && !seen[g] && sign_of(editor_.mesh(), g) <= 0) {
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
      if (!editor_.alive(f) || sign_of(editor_.mesh(), f) > 0) continue;
      const MeshEditor::Mark before = editor_.mark();
      if (!merge_equal(f) && !flip_middle(f)) return false;
      editor_.changed(before, todo);
    }
    if (!distance_) return true;
    std::vector<Index> changed;
    editor_.changed(mark, changed);
    for (Index f : changed)
      if (editor_.alive(f))
        for (Index v : editor_.mesh().faces[f])
          if (distance_(editor_.mesh().labels[f], editor_.mesh().points[v]) > bound_) return false;
    return true;
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
    if (mesh.neighbours[f][longest] == none) return editor_.trim(f, longest);  // a sliver of the border, an ulp thick
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
  const std::function<double(Index, Point2)>& distance_;
  double bound_;
};

/// The ladder: greedy alone; kinetic for the clusters greedy cannot mend and greedy for the rest; kinetic for all, at
/// once where these clusters are no exception. Kinetic moves need the mesh as it was, since exact places are valid in
/// that one only. Returns the vertices moved kinetically.
Index mend(MeshEditor& editor, const std::vector<Index>& bad, const std::function<ExactPlace(Index)>& place,
           const std::function<double(Index, Point2)>& distance, double bound, Context& context) {
  const std::vector<Index> hard = Greedy(editor, place, distance, bound).run(bad);
  if (hard.empty()) return 0;
  editor.undo({});
  if (hard.size() > bad.size() / 4) return move_kinetically(editor, bad, place, context);
  const Index moved = move_kinetically(editor, hard, place, context);
  Greedy(editor, place, distance, bound).run(bad_faces(editor.mesh()));
  if (bad_faces(editor.mesh()).empty()) return moved;
  editor.undo({});
  return move_kinetically(editor, bad, place, context);
}

}  // namespace

Point2 rounded(const ExactPlace& place) {
  if (place.kind == ExactPlace::ratio) {
    constexpr Point2 any{0, 0}, other{1, 1};
    const double to_p = std::fabs(place.dp), to_q = std::fabs(place.dq);
    const bool far = to_p > to_q;
    const Point2 at = point_on_segment(any, other, far ? place.q : place.p, far ? place.p : place.q,
                                       (far ? to_q : to_p) / (to_p + to_q));
    return is_long(place.p, place.q) ? refined(place, at) : at;
  }
  return crossing_point(place.p, place.q, place.r, place.s, std::fabs(area2_accurate(place.p, place.q, place.r)),
                        std::fabs(area2_accurate(place.p, place.q, place.s)));
}

double rounding_bound(const ExactPlace& place) {
  return place.kind == ExactPlace::ratio ? larger_bound(0, place.p, place.q) : larger_bound(0, place.r, place.s);
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
  for (std::size_t low = 0; low < mesh.points.size(); ++low)
    for (Index i = start[low]; i < start[low + 1]; ++i)
      for (Index j = i + 1; j < start[low + 1]; ++j)
        if (entries[i].high == entries[j].high) {
          mesh.neighbours[entries[i].face][entries[i].k] = entries[j].face;
          mesh.neighbours[entries[j].face][entries[j].k] = entries[i].face;
        }
}

Rounded round_and_verify(PlanarMesh& mesh, const std::function<ExactPlace(Index)>& place, Context& context,
                         const std::function<double(Index, Point2)>& distance) {
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
  const double bound = 3 * result.report.max_move;
  const std::vector<Index> bad = bad_faces(mesh);
  if (!bad.empty()) {
    result.report.kinetic = mend(editor, bad, place, distance, bound, context);
    if (const std::vector<Index> left = bad_faces(mesh); !left.empty()) {
      const Point2 at = mesh.points[mesh.faces[left[0]][0]];
      throw Error(
          ErrorKind::input, "rounding",
          "near " + std::to_string(at.x) + ", " + std::to_string(at.y) +
              " the surfaces come closer to each other than doubles can tell apart, and " +
              std::to_string(left.size()) +
              " faces cannot be kept positive; snap their vertices together or use coordinates nearer the origin");
    }
  }
  editor.changed({}, result.relabelled);
  std::sort(result.relabelled.begin(), result.relabelled.end());
  result.relabelled.erase(std::unique(result.relabelled.begin(), result.relabelled.end()), result.relabelled.end());
  std::erase_if(result.relabelled, [&](Index f) { return !editor.alive(f); });
  if (distance)
    for (Index f : result.relabelled)
      for (Index v : mesh.faces[f])
        result.report.max_spill = std::max(result.report.max_spill, distance(mesh.labels[f], mesh.points[v]));
  result.report.merges = editor.merges();
  result.report.flips = editor.flips();
  result.merged_into = editor.merged_into();
  for (Index v = 0; v < static_cast<Index>(result.merged_into.size()); ++v)  // follow chains of merges to their end
    while (result.merged_into[v] != result.merged_into[result.merged_into[v]])
      result.merged_into[v] = result.merged_into[result.merged_into[v]];
  return result;
}

}  // namespace terrane
