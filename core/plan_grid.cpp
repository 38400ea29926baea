// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/plan_grid.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/box.hpp"
#include "core/error.hpp"
#include "core/overlay/completed.hpp"
#include "core/predicates.hpp"
#include "core/surface/grid_heights.hpp"
#include "core/rounding/rounding.hpp"
#include "core/shortest.hpp"
#include "core/sum.hpp"
#include "core/surface/walls.hpp"
#include "core/triangle_height.hpp"

namespace terrane {
namespace {

double area_in_plan(const Array<Point2>& points, const Array<Face>& faces) {
  Sum area;
  for (const Face& f : faces) area.add(0.5 * area2_accurate(points[f[0]], points[f[1]], points[f[2]]));
  return area.value();
}

}  // namespace

PlanGrid::PlanGrid(double step) : step_(step), numerator_(step), denominator_(1) {
  double power = 1;
  for (int digits = 0; digits <= 22; ++digits, power *= 10) {
    const double whole = std::nearbyint(step * power);
    if (whole < 1 || whole > 1e15 || whole / power != step) continue;
    numerator_ = whole, denominator_ = power;
    return;
  }
}

double PlanGrid::nearest(double x) const {
  const double count = std::nearbyint(x * denominator_ / numerator_);
  if (!(std::fabs(count * numerator_) < 0x1p53)) return x;
  return count * numerator_ / denominator_ + 0.0;  // no negative zero
}

OnGrid put_on_grid(const Tin& tin, const PlanGrid& grid, Context& context) {
  OnGrid result;
  if (tin.faces.empty()) {
    result.tin = tin;
    return result;
  }
  const auto refuse = [&](const std::string& why) {
    throw Error(ErrorKind::input, "grid", "on a grid of " + shortest(grid.step()) + " " + why + "; use a finer grid");
  };
  const Box box = bounds(tin);
  if (grid.step() > (box.xmax - box.xmin) + (box.ymax - box.ymin)) refuse("no face is left of the surface");
  context.progress("grid", 0);
  const CompletedMesh completed = complete(tin, frame_around(bounds(tin)));
  const Index moving = completed.real_places();
  PlanarMesh mesh;
  mesh.points = completed.places;
  for (Index v = 0; v < moving; ++v) mesh.points[v] = grid.nearest(completed.at(v));
  Array<Face> before;
  for (Index f = 0; f < completed.faces(); ++f) {
    mesh.faces.push_back({completed.corner(4 * f), completed.corner(4 * f + 1), completed.corner(4 * f + 2)});
    mesh.labels.push_back(completed.real(f) ? f : none);
    if (completed.real(f)) before.push_back(mesh.faces.back());
  }
  connect(mesh);
  const auto place = [&](Index v) {
    ExactPlace at;
    if (v < moving) at.kind = ExactPlace::lattice, at.p = completed.at(v);
    return at;
  };
  const auto distance = [&](Index label, Point2 p) {
    if (label == none) return 0.0;
    const Index* c = completed.links[label].corner;
    return distance_to_triangle({completed.at(c[0]), completed.at(c[1]), completed.at(c[2])}, p);
  };
  Rounded rounded;
  try {
    rounded = round_and_verify(mesh, place, context, farthest_corner(distance));
  } catch (const Error& error) {
    if (error.kind != ErrorKind::input) throw;
    refuse(std::string("the surface cannot be kept valid: ") + error.what());
  }
  context.progress("grid", 0.7);

  CornerSurface surface = with_heights_of(tin, completed, std::move(mesh), rounded.merged_into);
  if (surface.faces.empty()) refuse("no face is left of the surface");
  result.area_lost = area_in_plan(completed.places, before) - area_in_plan(surface.points, surface.faces);
  mesh = {surface.points, surface.faces, {}, {}};
  connect(mesh);
  const bool walls = std::any_of(tin.faces.begin(), tin.faces.end(), [&](const Face& f) { return is_wall(tin, f); });
  reconcile_heights(surface, mesh.neighbours, walls);
  result.tin = canonical(raise(surface, mesh.neighbours, walls).tin, context);
  result.rounding = rounded.report;
  context.progress("grid", 1);
  return result;
}

}  // namespace terrane
