// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/polygon.hpp"

#include "core/predicates.hpp"

namespace terrane {

namespace {

/// A polygon in plan whose ears are cut off one by one. `sign` turns clockwise ones over for the tests.
class EarClipper {
 public:
  EarClipper(const std::vector<Point>& vertices, std::span<const Index> corners, int sign)
      : vertices_(vertices), left_(corners.begin(), corners.end()), sign_(sign) {}

  bool clip(std::vector<Face>& faces) {
    const std::size_t before = faces.size();
    while (left_.size() > 3) {
      const std::size_t ear = find_ear();
      if (ear == left_.size()) {
        faces.resize(before);
        return false;
      }
      const std::size_t n = left_.size();
      faces.push_back({left_[(ear + n - 1) % n], left_[ear], left_[(ear + 1) % n]});
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    if (turn(left_[0], left_[1], left_[2]) < 0) {
      faces.resize(before);
      return false;
    }
    faces.push_back({left_[0], left_[1], left_[2]});
    return true;
  }

 private:
  Point2 at(Index v) const { return plan(vertices_[v]); }
  int turn(Index a, Index b, Index c) const { return sign_ * orientation(at(a), at(b), at(c)); }

  std::size_t find_ear() const {
    const std::size_t n = left_.size();
    for (std::size_t k = 0; k < n; ++k)
      if (is_ear(left_[(k + n - 1) % n], left_[k], left_[(k + 1) % n])) return k;
    return n;
  }

  bool is_ear(Index a, Index b, Index c) const {
    if (turn(a, b, c) <= 0) return false;
    for (Index v : left_) {
      const Point2 p = at(v);
      if (p == at(a) || p == at(b) || p == at(c)) continue;
      if (turn(a, b, v) >= 0 && turn(b, c, v) >= 0 && turn(c, a, v) >= 0) return false;
    }
    return true;
  }

  const std::vector<Point>& vertices_;
  std::vector<Index> left_;
  int sign_;
};

struct Turns {
  bool left = false, right = false, straight = false;
};

Turns turns_of(const std::vector<Point>& vertices, std::span<const Index> corners) {
  Turns turns;
  const std::size_t n = corners.size();
  for (std::size_t k = 0; k < n; ++k) {
    const int s = orientation(plan(vertices[corners[k]]), plan(vertices[corners[(k + 1) % n]]),
                              plan(vertices[corners[(k + 2) % n]]));
    turns.left |= s > 0;
    turns.right |= s < 0;
    turns.straight |= s == 0;
  }
  return turns;
}

/// Corners that each stand over or under a neighbour make no turn either, wherever they are.
bool on_one_line(const std::vector<Point>& vertices, std::span<const Index> corners) {
  const Point2 p = plan(vertices[corners[0]]);
  Point2 q = p;  // the first that is elsewhere
  for (const Index v : corners)
    if (q == p) q = plan(vertices[v]);
    else if (orientation(p, q, plan(vertices[v])) != 0) return false;
  return true;
}

/// The orientation of the whole polygon is the turn at its lowest, leftmost corner.
int polygon_sign(const std::vector<Point>& vertices, std::span<const Index> corners) {
  const std::size_t n = corners.size();
  std::size_t low = 0;
  const auto before = [&](std::size_t a, std::size_t b) {
    const Point2 p = plan(vertices[corners[a]]), q = plan(vertices[corners[b]]);
    return p.y < q.y || (p.y == q.y && p.x < q.x);
  };
  for (std::size_t k = 1; k < n; ++k)
    if (before(k, low)) low = k;
  return orientation(plan(vertices[corners[(low + n - 1) % n]]), plan(vertices[corners[low]]),
                     plan(vertices[corners[(low + 1) % n]]));
}

/// All turns to one side make a polygon convex only when it goes round once: a pentagram turns to one side too. Around
/// once, the fan's triangles all have that side, and the direction of the edges changes its vertical sense twice.
bool goes_round_once(const std::vector<Point>& vertices, std::span<const Index> corners) {
  const std::size_t n = corners.size();
  int changes = 0, last = 0, first = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const Point2 p = plan(vertices[corners[k]]), q = plan(vertices[corners[(k + 1) % n]]);
    // Level edges count with the direction of their x, so that a flat bottom is neither up nor down twice.
    const int sense = q.y != p.y ? (q.y > p.y ? 1 : -1) : q.x != p.x ? (q.x > p.x ? 1 : -1) : 0;
    if (sense == 0) continue;
    if (last != 0 && sense != last) ++changes;
    if (first == 0) first = sense;
    last = sense;
  }
  if (first != last) ++changes;
  return changes <= 2;
}

}  // namespace

bool append_polygon(std::vector<Face>& faces, const std::vector<Point>& vertices, std::span<const Index> corners) {
  const std::size_t n = corners.size();
  if (n < 3 || n > max_polygon_corners) return false;
  if (n > 3) {
    const Turns turns = turns_of(vertices, corners);
    const bool vertical = !turns.left && !turns.right && on_one_line(vertices, corners);
    // A fan over straight corners would make faces without area; ears leave none.
    const bool convex = !turns.straight && turns.left != turns.right && goes_round_once(vertices, corners);
    if (!vertical && !convex) {
      const int sign = polygon_sign(vertices, corners);
      return sign != 0 && EarClipper(vertices, corners, sign).clip(faces);
    }
  }
  for (std::size_t k = 1; k + 1 < n; ++k) faces.push_back({corners[0], corners[k], corners[k + 1]});
  return true;
}

}  // namespace terrane
