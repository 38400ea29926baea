// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/synthesize.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "core/box.hpp"
#include "core/error.hpp"
#include "core/plan/filled_ring.hpp"
#include "core/triangle_height.hpp"

namespace terrane {
namespace {

/// Cosine and sine of n / of of a full turn; the same digits in every eighth of it, and exact at quarters.
std::array<double, 2> turned_by(double n, double of) {
  double eighths = 8 * std::fmod(n, of) / of;  // exact first: 8 n may be more than numbers hold
  if (eighths < 0) eighths += 8;
  const int quarter = static_cast<int>((eighths + 1) / 2) % 4;  // the nearest axis
  double rest = eighths - 2 * quarter;                          // -1 to 1 eighth from it
  if (rest > 4) rest -= 8;
  const double angle = rest * std::numbers::pi / 4, c = std::cos(angle), s = std::sin(angle);
  if (quarter == 0) return {c, s};
  if (quarter == 1) return {-s, c};
  if (quarter == 2) return {-c, -s};
  return {s, -c};
}

void refuse_too_many(double faces) {
  if (!(faces > 2e7)) return;
  throw Error(ErrorKind::usage, "max-edge",
              "with that max-edge the surface would have more than 20 million faces; make it larger");
}

/// Second derivatives of the periodic spline at its knots, one coordinate: h[i] is the step from knot i to the next.
/// The cyclic tridiagonal system as a plain one and a correction of rank one (Sherman & Morrison).
std::vector<double> second_derivatives(const std::vector<double>& h, const std::vector<double>& y) {
  const std::size_t n = h.size();
  std::vector<double> diagonal(n), right(n), other(n, 0), upper(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t before = (i + n - 1) % n, after = (i + 1) % n;
    diagonal[i] = 2 * (h[before] + h[i]);
    right[i] = 6 * ((y[after] - y[i]) / h[i] - (y[i] - y[before]) / h[before]);
  }
  const double corner = h[n - 1], gamma = -diagonal[0];
  diagonal[0] -= gamma;
  diagonal[n - 1] -= corner * corner / gamma;
  other[0] = gamma, other[n - 1] = corner;
  for (std::size_t i = 0; i < n; ++i) {  // both right sides at once
    const double lower = i == 0 ? 0 : h[i - 1];
    const double pivot = diagonal[i] - (i == 0 ? 0 : lower * upper[i - 1]);
    upper[i] = h[i] / pivot;
    right[i] = (right[i] - (i == 0 ? 0 : lower * right[i - 1])) / pivot;
    other[i] = (other[i] - (i == 0 ? 0 : lower * other[i - 1])) / pivot;
  }
  for (std::size_t i = n - 1; i-- > 0;) {
    right[i] -= upper[i] * right[i + 1];
    other[i] -= upper[i] * other[i + 1];
  }
  const double factor = (right[0] + right[n - 1] * corner / gamma) / (1 + other[0] + other[n - 1] * corner / gamma);
  for (std::size_t i = 0; i < n; ++i) right[i] -= factor * other[i];
  return right;
}

/// How many samples each span gets: one for its first knot, the others in proportion to its length.
std::vector<int> shares(const std::vector<double>& h, int samples) {
  const std::size_t n = h.size();
  const double total = std::accumulate(h.begin(), h.end(), 0.0), more = samples - static_cast<double>(n);
  std::vector<int> share(n, 1);
  std::vector<std::size_t> order(n);
  std::vector<double> rest(n);
  int given = static_cast<int>(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double exact = more * h[i] / total, whole = std::floor(exact);
    share[i] += static_cast<int>(whole);
    given += static_cast<int>(whole);
    rest[i] = exact - whole;
    order[i] = i;
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return rest[i] > rest[j]; });
  for (std::size_t i = 0; given < samples; ++i, ++given) ++share[order[i % n]];
  return share;
}

}  // namespace

Tin rectangle(const Box& box, double z_xmin, double z_xmax, double max_edge) {
  const double width = box.xmax - box.xmin, height = box.ymax - box.ymin;
  double columns = 1, rows = 1;
  if (max_edge > 0) {  // square cells: their diagonals are the longest edges
    columns = std::max(1.0, std::ceil(width * std::numbers::sqrt2 / max_edge));
    rows = std::max(1.0, std::ceil(height * std::numbers::sqrt2 / max_edge));
    refuse_too_many(2 * columns * rows);
  }
  const Index nx = static_cast<Index>(columns), ny = static_cast<Index>(rows);
  Tin tin;
  for (Index j = 0; j <= ny; ++j)
    for (Index i = 0; i <= nx; ++i) {
      const double u = static_cast<double>(i) / nx, v = static_cast<double>(j) / ny;
      tin.vertices.push_back({mix(box.xmin, box.xmax, u), mix(box.ymin, box.ymax, v), mix(z_xmin, z_xmax, u)});
    }
  for (Index j = 0; j < ny; ++j)
    for (Index i = 0; i < nx; ++i) {
      const Index a = j * (nx + 1) + i, b = a + 1, c = b + nx + 1, d = c - 1;
      if ((i + j) % 2 == 0)
        tin.faces.insert(tin.faces.end(), {{a, b, c}, {a, c, d}});
      else
        tin.faces.insert(tin.faces.end(), {{a, b, d}, {b, c, d}});
    }
  return canonical(std::move(tin));
}

std::vector<Point2> ellipse(Point2 centre, double major, double minor, double azimuth, int samples) {
  const auto [cosine, sine] = turned_by(azimuth, 360);
  std::vector<Point2> ring;
  for (int n = 0; n < samples; ++n) {
    const auto [c, s] = turned_by(n, samples);
    const double along = c * (major / 2), across = s * (minor / 2);
    ring.push_back({centre.x + (along * cosine + across * sine), centre.y + (across * cosine - along * sine)});
  }
  return ring;
}

std::vector<Point2> without_repeats(std::span<const Point2> ring) {
  std::vector<Point2> kept;
  for (const Point2 p : ring)
    if (kept.empty() || !(kept.back() == p)) kept.push_back(p);
  while (kept.size() > 1 && kept.front() == kept.back()) kept.pop_back();
  return kept;
}

std::vector<Point2> closed_spline(std::span<const Point2> points, int samples) {
  const std::vector<Point2> knots = without_repeats(points);
  const std::size_t n = knots.size();
  if (n < 3)
    throw Error(ErrorKind::input, "too-few-points",
                "a closed curve needs three points that differ; there are " + std::to_string(n));
  std::vector<double> h(n), x(n), y(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Point2 p = knots[i], q = knots[(i + 1) % n];
    h[i] = std::sqrt(std::hypot(q.x - p.x, q.y - p.y));
    x[i] = p.x - knots[0].x, y[i] = p.y - knots[0].y;  // small numbers lose no digits
  }
  const std::vector<double> mx = second_derivatives(h, x), my = second_derivatives(h, y);
  const auto at = [&](std::size_t i, double u) -> Point2 {
    if (u == 0) return knots[i];
    const std::size_t j = (i + 1) % n;
    const double a = 1 - u, ca = (a * a * a - a) * h[i] * h[i] / 6, cu = (u * u * u - u) * h[i] * h[i] / 6;
    return {knots[0].x + (a * x[i] + u * x[j] + ca * mx[i] + cu * mx[j]),
            knots[0].y + (a * y[i] + u * y[j] + ca * my[i] + cu * my[j])};
  };
  std::vector<Point2> curve;
  if (static_cast<std::size_t>(samples) >= n) {
    const std::vector<int> share = shares(h, samples);
    for (std::size_t i = 0; i < n; ++i)
      for (int k = 0; k < share[i]; ++k) curve.push_back(at(i, static_cast<double>(k) / share[i]));
    return curve;
  }
  const double total = std::accumulate(h.begin(), h.end(), 0.0);
  std::size_t span = 0;
  double begin = 0;
  for (int k = 0; k < samples; ++k) {
    const double t = total * k / samples;
    while (span + 1 < n && begin + h[span] <= t) begin += h[span++];
    curve.push_back(at(span, std::clamp((t - begin) / h[span], 0.0, 1.0)));
  }
  return curve;
}

std::optional<Crossing> self_contact(std::span<const Point2> ring, const Context& context) {
  const Index n = static_cast<Index>(ring.size());
  std::vector<NodedEdge> edges;
  for (Index i = 0; i < n; ++i) edges.push_back({i, (i + 1) % n, 0});
  std::optional<Crossing> first;
  const std::vector<Crossing> found = find_crossings(ring, edges, 1, context);
  if (!found.empty()) first = found.front();
  // Two corners at one place are ends of edges and no crossing of theirs.
  std::vector<Index> order(n);
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](Index i) { return std::pair(ring[i].x, ring[i].y); };
  std::sort(order.begin(), order.end(), [&](Index i, Index j) { return key(i) == key(j) ? i < j : key(i) < key(j); });
  for (Index i = 0; i + 1 < n; ++i)
    if (ring[order[i]] == ring[order[i + 1]] && (!first || order[i] < first->a))
      first = Crossing{ring[order[i]], order[i], order[i + 1]};
  return first;
}

namespace {

/// The ring with its edges divided evenly into pieces of at most max_edge.
std::vector<Point2> divided(std::span<const Point2> ring, double max_edge) {
  std::vector<Point2> fine;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point2 p = ring[i], q = ring[(i + 1) % ring.size()];
    const double pieces = std::max(1.0, std::ceil(std::hypot(q.x - p.x, q.y - p.y) / max_edge));
    refuse_too_many(static_cast<double>(fine.size()) + pieces);
    for (int k = 0; k < static_cast<int>(pieces); ++k)
      fine.push_back({mix(p.x, q.x, k / pieces), mix(p.y, q.y, k / pieces)});
  }
  return fine;
}

}  // namespace

Tin level_area(std::span<const Point2> ring, double z, double max_edge, const Context& context) {
  if (max_edge > 0) {
    Box box = no_box;
    for (const Point2 p : ring) box = around(box, p);
    refuse_too_many(2 * (box.xmax - box.xmin) / max_edge * ((box.ymax - box.ymin) / max_edge));
  }
  const std::vector<Point2> border = max_edge > 0 ? divided(ring, max_edge) : std::vector(ring.begin(), ring.end());
  PlainMesh mesh = fill_ring(border, max_edge, context);
  if (mesh.faces.empty())
    throw Error(ErrorKind::input, "flat-ring", "all corners of the area lie on one line: there is nothing inside");
  Tin tin;
  for (const Point2 p : mesh.points) tin.vertices.push_back({p.x, p.y, z});
  tin.faces = std::move(mesh.faces);
  return canonical(std::move(tin), context);
}

}  // namespace terrane
