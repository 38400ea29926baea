// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/terrains.hpp"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "core/predicates.hpp"

namespace terrane::support {
namespace {

using Random = std::mt19937_64;

/// std distributions differ between libraries; this does not.
double uniform(Random& random, double lo, double hi) {
  return lo + (hi - lo) * (static_cast<double>(random() >> 11) * 0x1p-53);
}

bool on_border(const Point& p) { return p.x == 0 || p.x == side || p.y == 0 || p.y == side; }

double terrain_height(double x, double y, double seed) {
  double z = 0, amplitude = 200, frequency = 2 * std::numbers::pi / side, phase = 1.7 * seed;
  for (int octave = 0; octave < 7; ++octave) {
    z += amplitude * std::sin(frequency * (x + 0.37 * y) + phase) * std::cos(frequency * (y - 0.21 * x) + 1.3 * phase);
    amplitude *= 0.5;
    frequency *= 2.03;
    phase += 1;
  }
  return z;
}

Tin delaunay(std::vector<Point> points) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Structure = CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_with_info_2<Index, Kernel>>;
  CGAL::Delaunay_triangulation_2<Kernel, Structure> triangulation;
  std::vector<std::pair<Kernel::Point_2, Index>> sites;
  for (std::size_t i = 0; i < points.size(); ++i) sites.emplace_back(Kernel::Point_2(points[i].x, points[i].y), i);
  triangulation.insert(sites.begin(), sites.end());
  Tin tin{std::move(points), {}};
  for (auto f : triangulation.finite_face_handles())
    tin.faces.push_back({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
  return tin;
}

std::vector<Point> random_points(int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Point> points{{0, 0}, {side, 0}, {side, side}, {0, side}};
  const int along = static_cast<int>(std::sqrt(count));
  for (int k = 0; k < 4; ++k)
    for (int i = 0; i + 1 < along; ++i) {
      const double u = uniform(random, 0, side);
      const Point on[4] = {{u, 0}, {side, u}, {u, side}, {0, u}};
      points.push_back(on[k]);
    }
  while (static_cast<int>(points.size()) < count) {
    const double x = uniform(random, 0, side);
    points.push_back({x, uniform(random, 0, side)});
  }
  for (Point& p : points) p.z = terrain_height(p.x, p.y, static_cast<double>(seed));
  return points;
}

void nudge_shared_border(Tin& tin, bool ulps, Random& random) {
  for (Point& p : tin.vertices) {
    if (p.x != side || p.y == 0 || p.y == side) continue;
    if (!ulps) {
      p.x += uniform(random, -1e-9, 1e-9);
      continue;
    }
    const int step = static_cast<int>(random() % 3);
    if (step != 0) p.x = std::nextafter(p.x, step == 1 ? 0 : 2 * side);
  }
}

}  // namespace

Tin random_terrain(int points, std::uint64_t seed) { return canonical(delaunay(random_points(points, seed))); }

Tin grid_terrain(int n, bool rising) {
  Tin tin;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      tin.vertices.push_back({side * i / n, side * j / n, 100.0 * ((i * 7 + j * 13) % 17) / 17 + (rising ? 0 : 1)});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const Index a = j * (n + 1) + i, b = a + 1, d = a + n + 1, c = d + 1;
      if (rising)
        tin.faces.insert(tin.faces.end(), {Face{a, b, c}, Face{a, c, d}});
      else
        tin.faces.insert(tin.faces.end(), {Face{a, b, d}, Face{b, c, d}});
    }
  return canonical(tin);
}

Tin patch(double x, double y, int n, int m, double cell, double lift) {
  Tin tin;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= n; ++i) {
      const double px = x + cell * i, py = y + cell * j;
      tin.vertices.push_back({px, py, terrain_height(px * 100, py * 100, 3) + lift});
    }
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      const Index a = j * (n + 1) + i, b = a + 1, d = a + n + 1, c = d + 1;
      tin.faces.insert(tin.faces.end(), {Face{a, b, c}, Face{a, c, d}});
    }
  return canonical(tin);
}

/// Puts back the corners of faces that are no longer positive, until all are: what remains is a valid terrain.
static Tin put_back(Tin moved, const Tin& original) {
  for (bool changed = true; changed;) {
    changed = false;
    for (const Face& f : moved.faces) {
      const auto at = [&](const Tin& tin, int k) { return plan(tin.vertices[f[k]]); };
      if (orientation(at(moved, 0), at(moved, 1), at(moved, 2)) > 0) continue;
      for (const Index v : f)
        if (!(moved.vertices[v] == original.vertices[v])) moved.vertices[v] = original.vertices[v], changed = true;
    }
  }
  return moved;
}

Tin jittered(Tin tin, double amount, bool border_too, std::uint64_t seed) {
  Random random(seed);
  const Tin original = tin;
  for (Point& p : tin.vertices) {
    if (!border_too && on_border(p)) continue;
    p.x += uniform(random, -amount, amount);
    p.y += uniform(random, -amount, amount);
  }
  return put_back(std::move(tin), original);
}

Tin edited(Tin tin, double amount, std::uint64_t seed) {
  Random random(seed);
  const Tin original = tin;
  for (Point& p : tin.vertices) {
    if (std::max(std::fabs(p.x - side / 2), std::fabs(p.y - side / 2)) > side / 10) continue;
    for (double* v : {&p.x, &p.y, &p.z}) *v += uniform(random, -amount, amount);
  }
  return put_back(std::move(tin), original);
}

Tin ulp_copy(Tin tin, bool border_too, std::uint64_t seed) {
  Random random(seed);
  for (Point& p : tin.vertices) {
    if (!border_too && on_border(p)) continue;
    for (double* v : {&p.x, &p.y}) {
      const int step = static_cast<int>(random() % 3);
      if (*v != 0 && step != 0) *v = std::nextafter(*v, step == 1 ? 1e9 : -1e9);
    }
  }
  return tin;
}

Tin rotated(Tin tin, double degrees, Point2 about) {
  const double angle = degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
  for (Point& p : tin.vertices) {
    const double x = p.x - about.x, y = p.y - about.y;
    p.x = about.x + c * x - s * y;
    p.y = about.y + s * x + c * y;
  }
  return tin;
}

Tin shifted(Tin tin, double dx, double dy, double dz) {
  for (Point& p : tin.vertices) p = {p.x + dx, p.y + dy, p.z + dz};
  return tin;
}

Tin simplified(const Tin& tin, std::uint64_t seed) {
  Random random(seed);
  std::vector<Point> kept;
  for (const Point& p : tin.vertices) {
    const bool corner = (p.x == 0 || p.x == side) && (p.y == 0 || p.y == side);
    if ((random() % 2 != 0) || corner) kept.push_back(p);
  }
  return canonical(delaunay(std::move(kept)));
}

Tin stepped(int points, std::uint64_t seed, double distance) {
  Random random(seed);
  std::vector<Point> all = random_points(points, seed);
  const std::size_t count = all.size();
  for (int i = 0; i < 300; ++i) {
    const Point p = all[random() % count];
    if (on_border(p)) continue;
    const double angle = uniform(random, 0, 2 * std::numbers::pi);
    all.push_back({p.x + distance * std::cos(angle), p.y + distance * std::sin(angle), p.z + 10 + 40.0 * (i % 7) / 7});
  }
  return canonical(delaunay(std::move(all)));
}

Tin with_holes(const Tin& tin) {
  return without(tin, [](Point2 c) {
    return std::hypot(c.x - 3000, c.y - 3000) < 1200 || std::hypot(c.x - 7000, c.y - 5500) < 900;
  });
}

Tin islands(const Tin& tin) {
  return without(tin, [](Point2 c) {
    return std::hypot(c.x - 2500, c.y - 2500) > 1900 && std::hypot(c.x - 7000, c.y - 6500) > 2400;
  });
}

Tin l_shape(const Tin& tin) {
  return without(tin, [](Point2 c) { return c.x > side / 2 && c.y > side / 2; });
}

Tin shuffled(const Tin& tin, std::uint64_t seed) {
  Random random(seed);
  std::vector<Index> order(tin.vertices.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), random);
  Tin result{std::vector<Point>(tin.vertices.size()), tin.faces};
  for (std::size_t i = 0; i < order.size(); ++i) result.vertices[order[i]] = tin.vertices[i];
  for (Face& f : result.faces) {
    for (Index& v : f) v = order[v];
    std::rotate(f.begin(), f.begin() + random() % 3, f.end());
  }
  std::shuffle(result.faces.begin(), result.faces.end(), random);
  return result;
}

Tin without_bad_faces(Tin tin) {
  std::erase_if(tin.faces, [&](const Face& f) {
    return orientation(plan(tin.vertices[f[0]]), plan(tin.vertices[f[1]]), plan(tin.vertices[f[2]])) <= 0;
  });
  return canonical(tin);
}

const std::vector<std::string>& nasty_pairs() {
  static const std::vector<std::string> names{"identical",   "jitter-1e-12",      "jitter-1e-9",     "jitter-1e-6",
                                              "jitter-1e-3", "jitter-all-1e-12",  "jitter-all-1e-9", "ulp",
                                              "ulp-all",     "grid-48-flipped",   "grid-48-96",      "grid-48-49",
                                              "rotated-17",  "grid-rotated-17",   "grids-rotated",   "simplified",
                                              "random",      "tiles-ulp",         "tiles-1e-9",      "tiles-rotated",
                                              "steps-1e-3",  "steps-1e-7-jitter", "holes",           "islands",
                                              "l-shapes",    "half-offset-grid"};
  return names;
}

Pair nasty_pair(const std::string& name, bool utm, int points) {
  Tin a = random_terrain(points, 1), b = shifted(a, 0, 0, 1);
  if (name == "jitter-1e-12") b = jittered(b, 1e-12, false);
  if (name == "jitter-1e-9") b = jittered(b, 1e-9, false);
  if (name == "jitter-1e-6") b = jittered(b, 1e-6, false);
  if (name == "jitter-1e-3") b = jittered(b, 1e-3, false);
  if (name == "jitter-all-1e-12") b = jittered(b, 1e-12, true);
  if (name == "jitter-all-1e-9") b = jittered(b, 1e-9, true);
  if (name == "grid-48-flipped") a = grid_terrain(48, true), b = grid_terrain(48, false);
  if (name == "grid-48-96") a = grid_terrain(48, true), b = grid_terrain(96, false);
  if (name == "grid-48-49") a = grid_terrain(48, true), b = grid_terrain(49, false);
  if (name == "half-offset-grid") a = grid_terrain(48, true), b = shifted(grid_terrain(48, true), side / 96, side / 96);
  if (name == "rotated-17") b = rotated(a, 17);
  if (name == "grid-rotated-17") a = grid_terrain(48, true), b = rotated(a, 17);
  if (name == "grids-rotated") a = rotated(grid_terrain(48, true), 17), b = rotated(grid_terrain(48, false), 17);
  if (name == "simplified") b = simplified(a);
  if (name == "random") b = random_terrain(points, 2);
  if (name.starts_with("tiles-")) {
    b = shifted(random_terrain(points, 2), side, 0);
    if (name == "tiles-rotated") {
      a = rotated(a, 17, {0, 0}), b = rotated(b, 17, {0, 0});
    } else {
      Random random(3);
      for (Tin* tin : {&a, &b}) nudge_shared_border(*tin, name == "tiles-ulp", random);
    }
  }
  if (name == "steps-1e-3") a = stepped(points, 1, 1e-3), b = random_terrain(points, 2);
  if (name == "steps-1e-7-jitter") a = stepped(points, 1, 1e-7), b = jittered(a, 1e-9, false);
  if (name == "holes") a = with_holes(a), b = with_holes(shifted(random_terrain(points, 2), 700, 500));
  if (name == "islands") a = islands(a), b = islands(random_terrain(points, 2));
  if (name == "l-shapes") a = l_shape(a), b = l_shape(rotated(random_terrain(points, 2), 180));
  if (utm) a = shifted(a, 500000, 4500000), b = shifted(b, 500000, 4500000);
  // Only now: an ulp is that of the final coordinates.
  if (name == "ulp" && !utm) b = ulp_copy(b, false);
  if (name == "ulp" && utm) b = shifted(ulp_copy(shifted(a, 0, 0, 1), true), 0, 0);
  if (name == "ulp-all") b = ulp_copy(b, true);
  return {name, without_bad_faces(a), without_bad_faces(b)};
}

Tin drawn(std::string_view picture, double unit, Point2 lower_left) {
  std::vector<std::string_view> rows;
  while (!picture.empty()) {
    const std::size_t end = std::min(picture.find('\n'), picture.size());
    if (end > 0) rows.push_back(picture.substr(0, end));
    picture.remove_prefix(std::min(end + 1, picture.size()));
  }
  Tin tin;
  std::vector<std::vector<Index>> at(rows.size());
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t i = 0; i < rows[r].size(); ++i) {
      const char c = rows[r][i];
      at[r].push_back(c == '.' ? none : static_cast<Index>(tin.vertices.size()));
      if (c == '.') continue;
      const double z = c <= '9' ? c - '0' : c - 'a' + 10;
      tin.vertices.push_back({lower_left.x + unit * static_cast<double>(i),
                              lower_left.y + unit * static_cast<double>(rows.size() - 1 - r), z});
    }
  for (std::size_t r = 0; r + 1 < rows.size(); ++r)
    for (std::size_t i = 0; i + 1 < at[r].size() && i + 1 < at[r + 1].size(); ++i) {
      const Index a = at[r + 1][i], b = at[r + 1][i + 1], c = at[r][i + 1], d = at[r][i];
      const int samples = (a != none) + (b != none) + (c != none) + (d != none);
      if (samples == 4) tin.faces.insert(tin.faces.end(), {Face{a, b, c}, Face{a, c, d}});
      if (samples != 3) continue;
      Face face{};
      int n = 0;
      for (const Index v : {a, b, c, d})
        if (v != none) face[n++] = v;
      tin.faces.push_back(face);
    }
  return canonical(tin);
}

}  // namespace terrane::support
