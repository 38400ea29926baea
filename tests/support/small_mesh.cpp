// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/small_mesh.hpp"

#include <algorithm>
#include <map>

#include "support/exact.hpp"

namespace terrane::support {
namespace {

/// The edge between two faces and their other corners: the faces are (u, v, left) and (v, u, right).
struct Diagonal {
  std::size_t left_face, right_face;
  Index u, v, left, right;
};

class Flipper {
 public:
  explicit Flipper(Tin& tin) : tin_(tin) {
    for (std::size_t f = 0; f < tin.faces.size(); ++f) remember(f);
  }

  std::size_t size() const { return tin_.faces.size(); }

  /// The diagonal at corner k of a face; false at the border.
  bool diagonal(std::size_t f, int k, Diagonal& d) const {
    const Face& t = tin_.faces[f];
    d = {f, 0, t[(k + 1) % 3], t[(k + 2) % 3], t[k], none};
    const auto across = face_of_.find({d.v, d.u});
    if (across == face_of_.end()) return false;
    d.right_face = across->second;
    for (const Index v : tin_.faces[d.right_face])
      if (v != d.u && v != d.v) d.right = v;
    return true;
  }

  bool convex(const Diagonal& d) const {
    return turn(at(d.left), at(d.u), at(d.right)) > 0 && turn(at(d.right), at(d.v), at(d.left)) > 0;
  }

  /// Whether the circle through one face holds the other's corner; near the circle either answer does.
  bool illegal(const Diagonal& d) const {
    const auto lifted = [&](Index v, long double(&row)[3]) {
      row[0] = static_cast<long double>(at(v).x) - at(d.right).x;
      row[1] = static_cast<long double>(at(v).y) - at(d.right).y;
      row[2] = row[0] * row[0] + row[1] * row[1];
    };
    long double p[3], q[3], r[3];
    lifted(d.u, p), lifted(d.v, q), lifted(d.left, r);
    return p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0]) +
               p[2] * (q[0] * r[1] - q[1] * r[0]) >
           0;
  }

  void flip(const Diagonal& d) {
    forget(d.left_face), forget(d.right_face);
    tin_.faces[d.left_face] = {d.left, d.u, d.right};
    tin_.faces[d.right_face] = {d.right, d.v, d.left};
    remember(d.left_face), remember(d.right_face);
  }

 private:
  Point2 at(Index v) const { return plan(tin_.vertices[v]); }
  void remember(std::size_t f) {
    for (int k = 0; k < 3; ++k) face_of_[{tin_.faces[f][k], tin_.faces[f][(k + 1) % 3]}] = f;
  }
  void forget(std::size_t f) {
    for (int k = 0; k < 3; ++k) face_of_.erase({tin_.faces[f][k], tin_.faces[f][(k + 1) % 3]});
  }

  Tin& tin_;
  std::map<std::pair<Index, Index>, std::size_t> face_of_;
};

}  // namespace

Tin swept(const std::vector<Point>& points) {
  Tin tin{points, {}};
  const auto before = [](const Point& p, const Point& q) { return p.x != q.x ? p.x < q.x : p.y < q.y; };
  std::stable_sort(tin.vertices.begin(), tin.vertices.end(), before);
  const auto same = [](const Point& p, const Point& q) { return p.x == q.x && p.y == q.y; };
  tin.vertices.erase(std::unique(tin.vertices.begin(), tin.vertices.end(), same), tin.vertices.end());
  const Index n = static_cast<Index>(tin.vertices.size());
  const auto at = [&](Index v) { return plan(tin.vertices[v]); };

  Index apex = 2;  // the first point that is not on the line of all before it
  while (apex < n && turn(at(0), at(1), at(apex)) == 0) ++apex;
  if (apex >= n) return tin;
  const bool left = turn(at(0), at(1), at(apex)) > 0;
  std::vector<Index> hull;  // counter-clockwise
  for (Index i = 0; i < apex; ++i) hull.push_back(left ? i : apex - 1 - i);
  hull.push_back(apex);
  for (std::size_t i = 0; i + 2 < hull.size(); ++i) tin.faces.push_back({hull[i], hull[i + 1], apex});

  // A point after all others sees a run of the hull's edges.
  for (Index p = apex + 1; p < n; ++p) {
    const std::size_t size = hull.size();
    const auto visible = [&](std::size_t i) { return turn(at(hull[i % size]), at(hull[(i + 1) % size]), at(p)) < 0; };
    std::size_t first = 0;
    while (!(visible(first) && !visible(first + size - 1))) ++first;
    std::size_t last = first;
    for (; visible(last); ++last) tin.faces.push_back({hull[(last + 1) % size], hull[last % size], p});
    std::vector<Index> next{p};
    for (std::size_t i = last; i <= first + size; ++i) next.push_back(hull[i % size]);
    hull = std::move(next);
  }
  return tin;
}

Tin flipped(Tin tin, int flips, Random& random) {
  if (tin.faces.empty()) return tin;
  Flipper flipper(tin);
  for (int i = 0; i < flips; ++i) {
    const std::size_t f = below(random, static_cast<int>(flipper.size()));
    Diagonal d;
    if (flipper.diagonal(f, below(random, 3), d) && flipper.convex(d)) flipper.flip(d);
  }
  return tin;
}

void flip(Tin& tin, std::size_t which) {
  Flipper flipper(tin);
  Diagonal d;
  if (flipper.diagonal(which / 3 % flipper.size(), static_cast<int>(which % 3), d) && flipper.convex(d))
    flipper.flip(d);
}

Tin made_delaunay(Tin tin) {
  Flipper flipper(tin);
  // Rounding may see a cycle of flips where there is none; any triangulation is good enough then.
  for (int round = 0, flips = 1; flips > 0 && round < 100; ++round) {
    flips = 0;
    for (std::size_t f = 0; f < flipper.size(); ++f)
      for (int k = 0; k < 3; ++k) {
        Diagonal d;
        if (!flipper.diagonal(f, k, d) || !flipper.convex(d) || !flipper.illegal(d)) continue;
        flipper.flip(d);
        ++flips;
      }
  }
  return tin;
}

}  // namespace terrane::support
