// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/merge/bisected_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <tuple>
#include <utility>

#include "core/error.hpp"
#include "core/predicates.hpp"
#include "core/rounding/rounding.hpp"

namespace terrane {

BisectedMesh::BisectedMesh(Array<Point2> points, Array<Face> faces, std::array<std::vector<double>, 2> values,
                           Point2 metric)
    : values_(std::move(values)), metric_(metric), first_made_(static_cast<Index>(points.size())) {
  PlanarMesh mesh{std::move(points), std::move(faces), {}, {}};
  connect(mesh);
  points_ = std::move(mesh.points);
  faces_ = std::move(mesh.faces);
  neighbours_ = std::move(mesh.neighbours);
  labels_.resize(faces_.size());
  std::iota(labels_.begin(), labels_.end(), 0);
  flips_left_ = 4 * static_cast<Index>(std::min<std::size_t>(faces_.size(), 100'000'000));
  for (const Point2 p : points_) rounding_ = std::max({rounding_, std::fabs(p.x), std::fabs(p.y)});
  rounding_ *= 64 * std::numeric_limits<double>::epsilon();
}

double BisectedMesh::length2(Index f, int k) const {
  const Point2 p = points_[faces_[f][(k + 1) % 3]], q = points_[faces_[f][(k + 2) % 3]];
  const double dx = (q.x - p.x) * metric_.x, dy = (q.y - p.y) * metric_.y;
  return dx * dx + dy * dy;
}

/// Edges have one order, whichever face is asked: a path along ever longer ones ends.
bool BisectedMesh::edge_before(Index f, int k, int j) const {
  const auto key = [&](int corner) {
    const auto [low, high] = std::minmax(faces_[f][(corner + 1) % 3], faces_[f][(corner + 2) % 3]);
    return std::tuple(length2(f, corner), high, low);
  };
  return key(k) < key(j);
}

int BisectedMesh::longest(Index f) const {
  int best = 0;
  for (int k = 1; k < 3; ++k)
    if (edge_before(f, best, k)) best = k;
  return best;
}

double BisectedMesh::longest_edge(Index f) const { return std::sqrt(length2(f, longest(f))); }

namespace {

/// About how many vertices the faces of a queue that are due will take, from some of them. Where a function bends its
/// error goes with the area of a face; where it breaks along a line, with the length of a face, as the number of faces
/// on that line does: either way a face takes as many as the tolerance goes into its error.
double still_needed(std::span<const Index> queue, const std::vector<std::uint8_t>& due,
                    const BisectedMesh::Refinement& how) {
  std::vector<Index> waiting;
  std::copy_if(queue.begin(), queue.end(), std::back_inserter(waiting), [&](Index f) { return due[f] != 0; });
  constexpr std::size_t sample = 2000;
  const std::size_t step = waiting.size() / sample | 1;
  double needed = 0;
  for (std::size_t i = 0; i < waiting.size(); i += step)
    if (const double error = how.error(waiting[i]); error > how.tolerance && std::isfinite(error))
      needed += error / how.tolerance - 1;
  return needed * static_cast<double>(step);
}

[[noreturn]] void refuse(const std::string& needed, Index most) {
  throw Error(ErrorKind::usage, "blend-tolerance",
              "blending to blend-tolerance needs " + needed + " new vertices, and may make " + std::to_string(most) +
                  "; raise blend-tolerance or blend-width");
}

}  // namespace

double BisectedMesh::refine(const Refinement& how, Context& context) {
  std::vector<Index> queue;
  for (Index f = 0; f < static_cast<Index>(faces_.size()); ++f)
    if (how.wanted(f)) queue.push_back(f);
  std::vector<double> errors(faces_.size(), 0);
  std::vector<std::uint8_t> due(faces_.size(), 1);
  Index look_ahead = how.most / 256;
  for (std::size_t i = 0; i < queue.size(); ++i) {
    if (i % 10000 == 0) context.progress("blend", static_cast<double>(i) / static_cast<double>(queue.size()));
    const Index f = queue[i];
    if (!std::exchange(due[f], 0)) continue;
    errors[f] = how.error(f);
    if (errors[f] <= how.tolerance) continue;
    if (made() >= how.most) refuse("more than " + std::to_string(how.most), how.most);
    if (made() > look_ahead) {
      look_ahead = 2 * made();
      const double expected = made() + still_needed(std::span(queue).subspan(i + 1), due, how);
      // The more there are, the surer it is how many there will be; twice as many are never sure.
      if (expected > 2.0 * how.most * std::sqrt(static_cast<double>(how.most) / made()))
        refuse("about " + std::to_string(std::llround(std::min(expected, 1e15))), how.most);
    }
    std::vector<Index> changed;
    if (!bisect(f, how, changed) && std::isinf(errors[f])) errors[f] = 0;
    due.resize(faces_.size(), 0);
    errors.resize(faces_.size(), 0);
    for (const Index g : changed) {
      if (!how.wanted(g)) errors[g] = 0;
      if (how.wanted(g) && !std::exchange(due[g], 1)) queue.push_back(g);
    }
  }
  double largest = 0;
  for (const double e : errors) largest = std::max(largest, e);
  return largest;
}

bool BisectedMesh::bisect(Index f, const Refinement& how, std::vector<Index>& changed) {
  while (true) {
    Index at = f;
    int k = longest(at);
    while (true) {
      const Index g = neighbours_[at][k];
      if (g == none || !how.wanted(g)) break;
      const int j = longest(g);
      if (neighbours_[g][j] == at) break;
      at = g, k = j;
    }
    const bool done = split(at, k, how, changed);
    if (!done && at == f) return false;
    if (!done) return split(f, longest(f), how, changed);
    if (std::find(changed.begin(), changed.end(), f) != changed.end()) return true;
  }
}

/// To a double beside a place, where that one will do.
template <class Room>
static bool step_aside(Point2& place, const Room& room) {
  const auto beside = [](double value, int steps) {
    for (; steps != 0; steps -= steps > 0 ? 1 : -1) value = std::nextafter(value, steps > 0 ? INFINITY : -INFINITY);
    return value;
  };
  for (int reach = 1; reach <= 2; ++reach)
    for (int dx = -reach; dx <= reach; ++dx)
      for (int dy = -reach; dy <= reach; ++dy) {
        const Point2 other = {beside(place.x, dx), beside(place.y, dy)};
        if (!room(other)) continue;
        place = other;
        return true;
      }
  return false;
}

bool BisectedMesh::split(Index f, int k, const Refinement& how, std::vector<Index>& changed) {
  const Index g = neighbours_[f][k], p = faces_[f][(k + 1) % 3], q = faces_[f][(k + 2) % 3];
  const Point2 a = points_[p], b = points_[q];
  int j = 0;
  if (g != none)
    while (faces_[g][(j + 1) % 3] != q) ++j;
  const auto room = [&](Point2 middle) {
    const Point2 r = points_[faces_[f][k]];
    if (orientation(r, a, middle) <= 0 || orientation(r, middle, b) <= 0) return false;
    if (g == none) return true;
    const Point2 s = points_[faces_[g][j]];
    return orientation(s, b, middle) > 0 && orientation(s, middle, a) > 0;
  };
  Point2 middle = {a.x + (b.x - a.x) / 2, a.y + (b.y - a.y) / 2};
  if (!room(middle)) {
    if (flip_flat(f, k, changed) || (g != none && flip_flat(g, j, changed))) return true;
    if (!step_aside(middle, room)) return false;
  }
  const auto m = static_cast<Index>(points_.size());
  points_.push_back(middle);
  how.made(m, p, q, f, g);
  const auto half = static_cast<Index>(faces_.size());
  cut(f, k, m, half);
  changed.insert(changed.end(), {f, half});
  if (g == none) return true;
  cut(g, j, m, half + 1);
  neighbours_[f][(k)] = half + 1;  // p m
  neighbours_[half][0] = g;        // m q
  neighbours_[g][j] = half;
  neighbours_[half + 1][0] = f;
  changed.insert(changed.end(), {g, half + 1});
  return true;
}

/// f = r p q, with r on p q but for rounding, and the face across, s q p, become r p s and r s q. Both are taken for
/// the face across: f is thinner than anything that rounding promises.
bool BisectedMesh::flip_flat(Index f, int k, std::vector<Index>& changed) {
  const Index g = neighbours_[f][k], r = faces_[f][k], p = faces_[f][(k + 1) % 3], q = faces_[f][(k + 2) % 3];
  if (g == none || flips_left_ == 0) return false;
  int j = 0;
  while (faces_[g][(j + 1) % 3] != q) ++j;
  const Index s = faces_[g][j];
  const Point2 a = points_[p], b = points_[q], c = points_[r];
  const double ux = b.x - a.x, uy = b.y - a.y, length2 = ux * ux + uy * uy;
  const double t = ((c.x - a.x) * ux + (c.y - a.y) * uy) / length2;
  if (!(t > 0 && t < 1) || area2_accurate(a, b, c) > rounding_ * std::sqrt(length2)) return false;
  if (orientation(c, a, points_[s]) <= 0 || orientation(c, points_[s], b) <= 0) return false;
  --flips_left_;
  const Index beside_rp = neighbours_[f][(k + 2) % 3], beside_qr = neighbours_[f][(k + 1) % 3];
  const Index beside_ps = neighbours_[g][(j + 1) % 3], beside_sq = neighbours_[g][(j + 2) % 3];
  faces_[f] = {r, p, s};
  faces_[g] = {r, s, q};
  neighbours_[f] = {beside_ps, g, beside_rp};
  neighbours_[g] = {beside_sq, beside_qr, f};
  if (beside_ps != none) relink(beside_ps, g, f);
  if (beside_qr != none) relink(beside_qr, f, g);
  labels_[f] = labels_[g];
  for (std::vector<double>& values : values_) {
    double *of_f = &values[3 * static_cast<std::size_t>(f)], *of_g = &values[3 * static_cast<std::size_t>(g)];
    const double zs = of_g[j], zq = of_g[(j + 1) % 3], zp = of_g[(j + 2) % 3], zr = zp + t * (zq - zp);
    of_f[0] = zr, of_f[1] = zp, of_f[2] = zs;
    of_g[0] = zr, of_g[1] = zs, of_g[2] = zq;
  }
  changed.insert(changed.end(), {f, g});
  return true;
}

/// f = r p q becomes r p m in place, and r m q as the face `half`, which begins at r.
void BisectedMesh::cut(Index f, int k, Index m, Index half) {
  const int kp = (k + 1) % 3, kq = (k + 2) % 3;
  const Index r = faces_[f][k], q = faces_[f][kq], beyond = neighbours_[f][kp];
  faces_.push_back({r, m, q});
  neighbours_.push_back({none, beyond, f});
  labels_.push_back(labels_[f]);
  if (beyond != none) relink(beyond, f, half);
  for (std::vector<double>& values : values_) {
    double* v = &values[3 * static_cast<std::size_t>(f)];
    const double zr = v[k], zq = v[kq], zm = v[kp] + (v[kq] - v[kp]) / 2;
    v[kq] = zm;
    values.insert(values.end(), {zr, zm, zq});
  }
  faces_[f][kq] = m;
  neighbours_[f][kp] = half;
  neighbours_[f][k] = none;
}

void BisectedMesh::relink(Index f, Index from, Index to) {
  for (Index& n : neighbours_[f])
    if (n == from) n = to;
}

}  // namespace terrane
