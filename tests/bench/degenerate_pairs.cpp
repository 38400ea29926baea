// SPDX-License-Identifier: GPL-3.0-or-later
// degenerate_pairs [POINTS [PLACES]]: overlays every pair that broke other overlays, at the origin and at UTM
// coordinates, and prints what the exact arrangement, the border and the heights at random places say of the result.
// Exit code 1 when one is wrong.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "core/error.hpp"
#include "core/overlay.hpp"
#include "core/rounding/rounding.hpp"
#include "core/validate.hpp"
#include "core/volume.hpp"
#include "support/checks.hpp"
#include "support/oracle.hpp"
#include "support/terrains.hpp"

namespace {

using namespace terrane;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

Tin with_heights(const Overlay& o, int input) {  // input < 0: in plan
  Tin tin;
  for (std::size_t f = 0; f < o.faces.size(); ++f) {
    if (input >= 0 && o.parents[f][input] == none) continue;
    Face face;
    for (int k = 0; k < 3; ++k) {
      const Point2 p = o.points[o.faces[f][k]];
      face[k] = static_cast<Index>(tin.vertices.size());
      tin.vertices.push_back({p.x, p.y, input < 0 ? 0 : o.height(input, static_cast<Index>(f), k)});
    }
    tin.faces.push_back(face);
  }
  return canonical(tin);
}

double border_length(const Tin& tin) {
  PlanarMesh mesh;
  for (const Point& p : tin.vertices) mesh.points.push_back(plan(p));
  mesh.faces.assign(tin.faces.begin(), tin.faces.end());
  connect(mesh);
  double length = 0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (int k = 0; k < 3; ++k)
      if (mesh.neighbours[f][k] == none) {
        const Point2 p = mesh.points[mesh.faces[f][(k + 1) % 3]], q = mesh.points[mesh.faces[f][(k + 2) % 3]];
        length += std::hypot(p.x - q.x, p.y - q.y);
      }
  return length;
}

/// The largest difference of heights at places where a millimetre of play cannot change the face.
double worst_height(const Overlay& o, int input, const Tin& wanted, int places, int& compared, int& astray) {
  const Tin tin = with_heights(o, input);
  const support::Sampler got(tin), want(wanted);
  double worst = 0;
  for (const Point2 p : support::random_places(bounds(wanted), places, 9)) {
    if (!want.clear_of_edges(p, 1e-6)) continue;
    const double expected = want(p), found = got(p);
    astray += std::isnan(expected) != std::isnan(found);
    if (std::isnan(expected) || std::isnan(found)) continue;
    worst = std::max(worst, std::fabs(expected - found));
    ++compared;
  }
  return worst;
}

/// The steepest face: what 2 delta + 2 tau in plan can make of a height, and so of the faces beside a step.
double steepest(const Tin& tin) {
  double slope = 0;
  for (const Face& f : tin.faces) {
    const Point a = tin.vertices[f[0]], b = tin.vertices[f[1]], c = tin.vertices[f[2]];
    const double x1 = b.x - a.x, y1 = b.y - a.y, x2 = c.x - a.x, y2 = c.y - a.y, d = x1 * y2 - x2 * y1;
    const double w1 = b.z - a.z, w2 = c.z - a.z;
    slope = std::max(slope, std::hypot((w1 * y2 - w2 * y1) / d, (x1 * w2 - x2 * w1) / d));
  }
  return slope;
}

bool judge(const std::string& name, bool utm, int points, int places) {
  const support::Pair pair = support::nasty_pair(name, utm, points);
  Context context;
  const double start = now();
  const Overlay exact = overlay(pair.a, pair.b, {.snap = 0}, context);
  const Overlay snapped = overlay(pair.a, pair.b, {}, context);
  const double seconds = now() - start;
  const support::OracleCounts truth = support::oracle_counts(pair.a, pair.b);
  const Tin flat = with_heights(snapped, -1);
  const Tin flat_exact = with_heights(exact, -1);
  const Inspection seen = inspect(flat), unsnapped = inspect(flat_exact);
  const double delta = exact.rounding.max_move;
  const double area_error = std::fabs(plan_area(flat_exact) - truth.area);
  const double allowed = delta * (border_length(pair.a) + border_length(pair.b)) + 1e-14 * truth.area;
  int compared = 0, astray = 0;
  const double height = std::max(worst_height(snapped, 0, pair.a, places / 2, compared, astray),
                                 worst_height(snapped, 1, pair.b, places / 2, compared, astray));
  const double play = 2 * (snapped.rounding.max_move + snapped.rounding.max_snap);
  const double height_allowed = 1e-9 + play * std::max(steepest(pair.a), steepest(pair.b));
  const auto bad = [](const Inspection& i) {
    return i.inverted + i.degenerate + i.t_junctions + i.non_manifold_edges + i.overlaps;
  };
  const bool right = bad(seen) + bad(unsnapped) == 0 &&
                     static_cast<std::size_t>(exact.rounding.regions) == truth.regions && area_error <= allowed &&
                     height <= height_allowed && astray == 0;
  std::printf("%-18s %-6s %7zu %3zu %8d %8zu %6d %6d %6d %6d  %8.1e %8.1e  %8.1e %8.1e  %6d %8.1e %8.1e %6.2f  %s\n",
              name.c_str(), utm ? "utm" : "origin", seen.faces, bad(seen) + bad(unsnapped), exact.rounding.regions,
              truth.regions, exact.rounding.collapsed, exact.rounding.merges, exact.rounding.flips,
              exact.rounding.kinetic, delta, exact.rounding.max_spill, area_error, allowed, compared, height,
              height_allowed, seconds, right ? "right" : "WRONG");
  std::fflush(stdout);
  return right;
}

}  // namespace

int main(int argc, char** argv) {
  const int points = argc > 1 ? std::atoi(argv[1]) : 2500, places = argc > 2 ? std::atoi(argv[2]) : 100000;
  std::printf("%-18s %-6s %7s %3s %8s %8s %6s %6s %6s %6s  %8s %8s  %8s %8s  %6s %8s %8s %6s\n", "pair", "at", "faces",
              "bad", "regions", "exact", "lost", "merges", "flips", "moved", "delta", "spill", "area off", "allowed",
              "places", "height", "allowed", "s");
  int wrong = 0;
  for (const std::string& name : support::nasty_pairs())
    for (const bool utm : {false, true}) try {
        wrong += !judge(name, utm, points, places);
      } catch (const Error& error) {
        std::printf("%-18s %-6s REFUSED %s\n", name.c_str(), utm ? "utm" : "origin", error.what());
        ++wrong;
      }
  std::printf("%d wrong\n", wrong);
  return wrong > 0;
}
