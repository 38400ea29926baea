// SPDX-License-Identifier: GPL-3.0-or-later
#include "soak/cases.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "support/plan_mesh.hpp"
#include "support/small_mesh.hpp"

namespace terrane::soak {
namespace {

using support::below;
using support::Random;
using support::uniform;

template <class T, std::size_t n>
T one_of(Random& random, const std::array<T, n>& choices) {
  return choices[below(random, n)];
}

/// Where the unit square lies.
struct Frame {
  double scale = 1;
  Point2 origin;
  Point2 operator()(double u, double v) const { return {origin.x + scale * u, origin.y + scale * v}; }
};

Frame random_frame(Random& random) {
  const double scale = one_of(random, std::array{1.0, 8.0, 1000.0, 10000.0});
  const Point2 origin = one_of(random, std::array{Point2{0, 0}, Point2{0, 0}, Point2{-0.5 * scale, -0.25 * scale},
                                                  Point2{500000, 4500000}, Point2{333333.3, 5000000.7}});
  return {scale, origin};
}

/// Heights of every temper: level, whole numbers that tie, a plane, hills, noise.
class Heights {
 public:
  explicit Heights(Random& random) : temper_(below(random, 5)), phase_(uniform(random, 0, 6)), seed_(random()) {}
  double operator()(double u, double v) {
    switch (temper_) {
      case 0:
        return 7;
      case 1:
        return static_cast<double>(static_cast<int>(seed_() % 7)) - 3;
      case 2:
        return 100 * u - 40 * v + phase_;
      case 3:
        return 200 * std::sin(5 * u + phase_) * std::cos(4 * v - phase_);
      default:
        return uniform(seed_, -100, 1000);
    }
  }

 private:
  int temper_;
  double phase_;
  Random seed_;
};

/// Mostly few points: a degeneracy needs no more, and a million of them must be judged.
int random_size(Random& random) {
  const int dice = below(random, 100);
  return dice < 60 ? 3 + below(random, 8) : dice < 95 ? 8 + below(random, 18) : 25 + below(random, 40);
}

using Points = std::vector<Point>;

void put(Points& points, const Frame& frame, Heights& z, double u, double v) {
  const Point2 p = frame(u, v);
  points.push_back({p.x, p.y, z(u, v)});
}

Points scattered(int n, const Frame& frame, Heights& z, Random& random, bool corners) {
  Points points;
  if (corners)
    for (const int i : {0, 1, 2, 3}) put(points, frame, z, i % 2, i / 2);
  while (static_cast<int>(points.size()) < n) {
    const double u = uniform(random, 0, 1);
    put(points, frame, z, u, uniform(random, 0, 1));
  }
  return points;
}

Points lattice(int n, int size, const Frame& frame, Heights& z, Random& random) {
  Points points;
  while (static_cast<int>(points.size()) < n) {
    const int i = below(random, size + 1);
    put(points, frame, z, static_cast<double>(i) / size, static_cast<double>(below(random, size + 1)) / size);
  }
  return points;
}

/// Points on a few lines through the square, exactly or but for rounding.
Points bundle(int n, const Frame& frame, Heights& z, Random& random) {
  Points points;
  const int lines = 2 + below(random, 3);
  std::vector<std::array<double, 4>> ends;
  for (int i = 0; i < lines; ++i) {
    std::array<double, 4> e;
    for (double& c : e) c = below(random, 2) == 0 ? uniform(random, 0, 1) : below(random, 9) / 8.0;
    ends.push_back(e);
  }
  for (int i = 0; i < n; ++i) {
    const auto& e = ends[i % lines];
    const double t = below(random, 17) / 16.0;
    put(points, frame, z, e[0] + t * (e[2] - e[0]), e[1] + t * (e[3] - e[1]));
  }
  return points;
}

/// A band so narrow that every face in it is a sliver.
Points sliver(int n, const Frame& frame, Heights& z, Random& random) {
  Points points;
  const double width = std::pow(10, uniform(random, -13, -2)), slope = uniform(random, -0.4, 0.4);
  for (int i = 0; i < n; ++i) {
    const double u = uniform(random, 0, 1);
    put(points, frame, z, u, 0.5 + slope * (u - 0.5) + (i < 2 ? i - 0.5 : uniform(random, -0.5, 0.5)) * width);
  }
  return points;
}

Points fan(int n, const Frame& frame, Heights& z, Random& random) {
  Points points;
  put(points, frame, z, 0.5, 0.5);
  const double turn = uniform(random, 0, 1), whole = below(random, 2) == 0 ? 1 : 0.01;
  for (int i = 0; i + 1 < n; ++i) {
    const double angle = 2 * std::numbers::pi * (turn + whole * i / (n - 1));
    put(points, frame, z, 0.5 + 0.5 * std::cos(angle), 0.5 + 0.5 * std::sin(angle));
  }
  return points;
}

Tin grid(int n, const Frame& frame, Heights& z, Random& random) {
  Tin tin;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) put(tin.vertices, frame, z, static_cast<double>(i) / n, static_cast<double>(j) / n);
  const int pattern = below(random, 3);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const Index a = j * (n + 1) + i, b = a + 1, d = a + n + 1, c = d + 1;
      if (pattern == 2 ? (i + j) % 2 == 0 : pattern == 1)
        tin.faces.insert(tin.faces.end(), {Face{a, b, c}, Face{a, c, d}});
      else
        tin.faces.insert(tin.faces.end(), {Face{a, b, d}, Face{b, c, d}});
    }
  return tin;
}

bool valid(const Tin& tin) {
  const support::PlanMesh mesh = support::plan_mesh(canonical(tin));
  return !mesh.faces.empty() && support::wrong_in_plan(mesh.points, mesh.faces).empty();
}

/// The mesh of points: Delaunay, a sweep's, or one with some diagonals turned.
Tin meshed(const Points& points, Random& random) {
  Tin tin = support::swept(points);
  const int kind = below(random, 4);
  if (kind < 2) tin = support::made_delaunay(std::move(tin));
  if (kind == 1) tin = support::flipped(std::move(tin), 3, random);
  return tin;
}

/// Leaves faces out: a hole, islands, half of it, or nothing.
Tin cut_out(Tin tin, Random& random) {
  const Tin whole = tin;
  const int kind = below(random, 8);
  const auto centre = [&](const Face& f, double Point::*c) {
    return (whole.vertices[f[0]].*c + whole.vertices[f[1]].*c + whole.vertices[f[2]].*c) / 3;
  };
  const Box box = bounds(whole);
  if (kind == 0) {
    const double x = uniform(random, box.xmin, box.xmax), y = uniform(random, box.ymin, box.ymax);
    const double radius = 0.3 * (box.xmax - box.xmin);
    std::erase_if(tin.faces, [&](const Face& f) {
      return std::hypot(centre(f, &Point::x) - x, centre(f, &Point::y) - y) < radius;
    });
  }
  if (kind == 1) std::erase_if(tin.faces, [&](const Face&) { return below(random, 4) == 0; });
  if (kind == 2)
    std::erase_if(tin.faces, [&](const Face& f) { return centre(f, &Point::x) > (box.xmin + box.xmax) / 2; });
  return tin.faces.empty() ? whole : tin;
}

Tin random_mesh(const Frame& frame, Random& random, std::string& kind) {
  Heights z(random);
  const int n = random_size(random);
  switch (below(random, 8)) {
    case 0:
      kind = "lattice";
      return meshed(lattice(n, 2 + below(random, 7), frame, z, random), random);
    case 1:
      kind = "bundle";
      return meshed(bundle(n, frame, z, random), random);
    case 2:
      kind = "sliver";
      return meshed(sliver(n, frame, z, random), random);
    case 3:
      kind = "fan";
      return meshed(fan(n, frame, z, random), random);
    case 4:
      kind = "grid";
      return grid(1 + below(random, 6), frame, z, random);
    default:
      kind = "random";
      return meshed(scattered(n, frame, z, random, below(random, 2) == 0), random);
  }
}

Tin valid_mesh(const Frame& frame, Random& random, std::string& kind) {
  for (;;) {
    const Tin tin = cut_out(random_mesh(frame, random, kind), random);
    if (valid(tin)) return tin;  // not when all points are on a line
  }
}

double moved_by_ulps(double v, int ulps) {
  for (; ulps > 0; --ulps) v = std::nextafter(v, INFINITY);
  for (; ulps < 0; ++ulps) v = std::nextafter(v, -INFINITY);
  return v;
}

template <class Move>
Tin moved(Tin tin, Move move) {
  for (Point& p : tin.vertices) move(p);
  return tin;
}

/// What becomes of a mesh: the second of a pair is often nearly the first.
Tin relative(const Tin& a, const Frame& frame, Random& random, std::string& kind) {
  const double lift = one_of(random, std::array{0.0, 1.0, -2.5});
  const Tin lifted = moved(a, [&](Point& p) { p.z += lift; });
  const auto jitter = [&](double amount, int among) {
    return moved(lifted, [&](Point& p) {
      if (below(random, among) != 0) return;
      p.x += uniform(random, -amount, amount), p.y += uniform(random, -amount, amount);
    });
  };
  switch (below(random, 10)) {
    case 0:
      kind += "-identical";
      return lifted;
    case 1:
      kind += "-jittered";
      return jitter(std::pow(10, -3 - below(random, 10)) * frame.scale, 1);
    case 2:
      kind += "-edited";
      return jitter(0.05 * frame.scale, 4);
    case 3: {
      const bool zeros_too = below(random, 16) == 0;  // the neighbours of 0 are 300 orders of magnitude smaller
      kind += zeros_too ? "-denormal" : "-ulps";
      return moved(lifted, [&](Point& p) {
        for (double* c : {&p.x, &p.y})
          if (const int ulps = below(random, 5) - 2; *c != 0 || zeros_too) *c = moved_by_ulps(*c, ulps);
      });
    }
    case 4:
      kind += "-flipped";
      return support::flipped(lifted, 5, random);
    case 5: {
      kind += "-simplified";
      Points kept;
      for (const Point& p : lifted.vertices)
        if (below(random, 3) != 0) kept.push_back(p);
      return meshed(kept, random);
    }
    case 6: {
      kind += "-shifted";
      const double dx = frame.scale * below(random, 9) / 8, dy = frame.scale * below(random, 9) / 16;
      return moved(lifted, [&](Point& p) { p.x += dx, p.y += dy; });
    }
    case 7: {
      kind += "-rotated";
      const double angle = one_of(random, std::array{std::numbers::pi / 4, 0.3, 1e-9, 1e-3, std::numbers::pi});
      const double c = std::cos(angle), s = std::sin(angle);
      const Point2 o = frame(0.5, 0.5);
      return moved(lifted, [&](Point& p) {
        p = {o.x + c * (p.x - o.x) - s * (p.y - o.y), o.y + s * (p.x - o.x) + c * (p.y - o.y), p.z};
      });
    }
    case 8: {
      kind += "-beside";  // meeting along a border, an ulp or nothing between them
      const Box box = bounds(lifted);
      const double width = moved_by_ulps(box.xmax - box.xmin, below(random, 3) - 1);
      return moved(lifted, [&](Point& p) { p.x += width; });
    }
    default:
      kind += "-cut";
      return cut_out(lifted, random);
  }
}

Frame nested(const Frame& frame, Random& random) {
  const double size = one_of(random, std::array{1.0, 0.5, 0.25, 0.7});
  const Point2 origin = frame(below(random, 5) / 8.0, below(random, 5) / 8.0);
  return {frame.scale * size, origin};
}

}  // namespace

Case make_case(std::uint64_t seed) {
  Random random(seed * 0x9e3779b97f4a7c15 + 1);
  Case made;
  const Frame frame = random_frame(random);
  made.merge = below(random, 8) == 0;
  made.threads = one_of(random, std::array{1, 1, 2, 4});
  made.inputs.push_back(canonical(valid_mesh(frame, random, made.kind)));
  const int count = made.merge ? 2 + below(random, 7) : 2;
  while (static_cast<int>(made.inputs.size()) < count) {
    std::string kind;
    Tin next;
    if (below(random, 2) == 0) {
      kind = made.inputs.size() > 1 ? "" : made.kind;
      next = relative(made.inputs[below(random, static_cast<int>(made.inputs.size()))], frame, random, kind);
    } else {
      next = valid_mesh(below(random, 2) == 0 ? frame : nested(frame, random), random, kind);
      kind = made.kind + "+" + kind;
    }
    if (!valid(next)) continue;
    if (made.inputs.size() == 1) made.kind = kind;
    made.inputs.push_back(canonical(next));
  }
  if (made.merge) {
    made.kind = "merge-" + made.kind;
    made.merging.overlap = static_cast<Overlap>(below(random, 6));
    made.merging.assembly.seam = below(random, 4) == 0 ? Seam::split : Seam::wall;
    return made;
  }
  if (below(random, 2) == 0) made.options.snap = 0;
  if (below(random, 6) == 0) made.options.refinement = Refinement::paste;
  if (below(random, 3) == 0) std::swap(made.inputs[0], made.inputs[1]);
  return made;
}

}  // namespace terrane::soak
