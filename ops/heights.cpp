// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/heights.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "core/box.hpp"
#include "core/parallel.hpp"
#include "core/predicates.hpp"
#include "core/topology.hpp"

namespace terrane {
namespace {

int cell_of(double value, double low, double per_length, int count) {
  const double cell = (value - low) * per_length;
  return !(cell > 0) ? 0 : cell < count - 1 ? static_cast<int>(cell) : count - 1;
}

/// How many cells of that side along an extent: one where either is not finite.
int cells_along(double extent, double side) {
  const double count = extent / side;
  return !std::isfinite(count) || count < 1 ? 1 : static_cast<int>(std::min(count, 4096.0));
}

std::array<Point2, 3> corners_in_plan(const Tin& tin, const Face& face) {
  return {plan(tin.vertices[face[0]]), plan(tin.vertices[face[1]]), plan(tin.vertices[face[2]])};
}

/// The x-range of a triangle within a horizontal strip: long slivers must not fill the cells of their whole box.
std::pair<double, double> strip_range(const std::array<Point2, 3>& t, double ylow, double yhigh) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const auto take = [&](double x) { low = std::min(low, x), high = std::max(high, x); };
  for (int k = 0; k < 3; ++k) {
    const Point2 p = t[k], q = t[(k + 1) % 3];
    if (p.y >= ylow && p.y <= yhigh) take(p.x);
    for (double y : {ylow, yhigh})
      if ((p.y < y) != (q.y < y)) take(p.x + (q.x - p.x) * ((y - p.y) / (q.y - p.y)));
  }
  return {low, high};
}

}  // namespace

Box HeightField::box_of(Index face) const {
  const auto [a, b, c] = corners_in_plan(tin_, tin_.faces[face]);
  const auto [xmin, xmax] = std::minmax({a.x, b.x, c.x});
  const auto [ymin, ymax] = std::minmax({a.y, b.y, c.y});
  return {xmin, ymin, xmax, ymax};
}

HeightField::HeightField(const Tin& tin, int faces_per_cell)
    : tin_(tin), border_(3 * tin.faces.size()), box_(bounds(tin)) {
  auto border = sound_border(tin);
  if (!border) border = border_edges(tin, plan_topology(tin));
  for (const BorderHalfEdge& e : *border) {
    border_[e.half_edge] = true;
    border_edges_.push_back({plan(tin.vertices[e.from]), plan(tin.vertices[e.to])});
  }
  const double width = std::max(box_.xmax - box_.xmin, 0.0), height = std::max(box_.ymax - box_.ymin, 0.0);
  const double side =
      std::sqrt(std::max(width * height, 1e-300) / std::max<std::size_t>(tin.faces.size() / faces_per_cell, 1));
  columns_ = cells_along(width, side);
  rows_ = cells_along(height, side);
  cell_x_ = width > 0 ? width / columns_ : 1;
  cell_y_ = height > 0 ? height / rows_ : 1;
  per_x_ = 1 / cell_x_, per_y_ = 1 / cell_y_;

  first_.assign(static_cast<std::size_t>(rows_) * columns_, none);
  const auto run = std::max<Index>(1, faces_per_cell / 4);
  for (auto last = static_cast<Index>(tin.faces.size()); last > 0; last -= std::min(run, last)) {
    Run faces = {no_box, std::max<Index>(0, last - run), last};
    for (Index f = faces.first; f < last; ++f) faces.box = around(faces.box, box_of(f));
    list(faces);
  }
}

/// Puts a run before the others in the lists of the cells it lies in, or its faces one by one where they lie apart.
void HeightField::list(const Run& run) {
  const double columns = (run.box.xmax - run.box.xmin) * per_x_, rows = (run.box.ymax - run.box.ymin) * per_y_;
  if (run.last - run.first == 1 || !(columns < 2 && rows < 2)) {
    for (Index f = run.last; f-- > run.first;) list_apart(f);
    return;
  }
  runs_.push_back(run);
  const int top = cell_of(run.box.ymax, box_.ymin, per_y_, rows_);
  for (int r = cell_of(run.box.ymin, box_.ymin, per_y_, rows_); r <= top; ++r)
    list_in_row(r, run.box.xmin, run.box.xmax);
}

void HeightField::list_apart(Index face) {
  if (is_wall(tin_, tin_.faces[face])) return;
  const Box box = box_of(face);
  runs_.push_back({box, face, face + 1});
  const int bottom = cell_of(box.ymin, box_.ymin, per_y_, rows_), top = cell_of(box.ymax, box_.ymin, per_y_, rows_);
  if (bottom == top) return list_in_row(bottom, box.xmin, box.xmax);  // no strip cuts it
  const std::array<Point2, 3> t = corners_in_plan(tin_, tin_.faces[face]);
  for (int r = bottom; r <= top; ++r) {
    const double margin = 1e-9 * cell_y_, base = box_.ymin + r * cell_y_;
    const auto [xlow, xhigh] = strip_range(t, base - margin, base + cell_y_ + margin);
    if (xlow <= xhigh) list_in_row(r, xlow, xhigh);
  }
}

/// Lists the run that was added last.
void HeightField::list_in_row(int row, double xlow, double xhigh) {
  const auto run = static_cast<Index>(runs_.size() - 1);
  const int last = cell_of(xhigh + 1e-9 * cell_x_, box_.xmin, per_x_, columns_);
  for (int c = cell_of(xlow - 1e-9 * cell_x_, box_.xmin, per_x_, columns_); c <= last; ++c) {
    Index& first = first_[static_cast<std::size_t>(row) * columns_ + c];
    listed_.push_back({run, std::exchange(first, static_cast<Index>(listed_.size()))});
  }
}

template <class Visit>
void HeightField::visit_cells(Box box, Box near, Visit visit) const {
  if (box.xmax < box_.xmin || box.xmin > box_.xmax || box.ymax < box_.ymin || box.ymin > box_.ymax) return;
  for (int r = cell_of(box.ymin, box_.ymin, per_y_, rows_); r <= cell_of(box.ymax, box_.ymin, per_y_, rows_); ++r)
    for (int c = cell_of(box.xmin, box_.xmin, per_x_, columns_); c <= cell_of(box.xmax, box_.xmin, per_x_, columns_);
         ++c) {
      for (Index i = first_[static_cast<std::size_t>(r) * columns_ + c]; i != none; i = listed_[i].next) {
        const Run& run = runs_[listed_[i].run];
        if (!touches(run.box, near)) continue;
        for (Index f = run.first; f < run.last; ++f)
          if (!is_wall(tin_, tin_.faces[f])) visit(f);
      }
    }
}

/// The point of a face nearest to a place, its height, and whether the border is within the radius.
HeightField::Hit HeightField::hit(Index face, Point2 place, double radius) const {
  std::array<Point, 3> p;
  for (int k = 0; k < 3; ++k) p[k] = tin_.vertices[tin_.faces[face][k]];
  Hit best{std::numeric_limits<double>::infinity(), 0, false};
  bool inside = true;
  for (int k = 0; k < 3; ++k) {
    const Point &a = p[k], &b = p[(k + 1) % 3];
    if (orientation(plan(a), plan(b), place) < 0) inside = false;
    const double ux = b.x - a.x, uy = b.y - a.y, wx = place.x - a.x, wy = place.y - a.y;
    const double t = std::clamp((wx * ux + wy * uy) / (ux * ux + uy * uy), 0.0, 1.0);
    const double dx = wx - t * ux, dy = wy - t * uy, distance2 = dx * dx + dy * dy;
    if (distance2 <= radius * radius && border_[3 * static_cast<std::size_t>(face) + k]) best.border = true;
    if (distance2 < best.distance2) best.distance2 = distance2, best.z = a.z + t * (b.z - a.z);
  }
  if (!inside) return best;
  // Accurate weights, so that a place at a corner has the corner's height: never the plane of a sliver.
  const double whole = area2_accurate(plan(p[0]), plan(p[1]), plan(p[2]));
  double z = 0, sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double w = std::clamp(area2_accurate(plan(p[(k + 1) % 3]), plan(p[(k + 2) % 3]), place) / whole, 0.0, 1.0);
    z += w * (p[k].z - p[0].z), sum += w;
  }
  best.distance2 = 0;
  best.z = p[0].z + (sum > 0 ? z / sum : 0);
  return best;
}

HeightField::Reading HeightField::at(Point2 place, double radius) const {
  Reading reading;
  // A cell has many faces, and most are so far away that no rounding brings them within the radius.
  const double reach = 4 * radius + 1e-9 * (cell_x_ + cell_y_);
  const Box near = {place.x - reach, place.y - reach, place.x + reach, place.y + reach};
  visit_cells({place.x - radius, place.y - radius, place.x + radius, place.y + radius}, near, [&](Index face) {
    if (!touches(box_of(face), near)) return;
    const Hit h = hit(face, place, radius);
    if (h.distance2 > radius * radius) return;
    reading.border = reading.border || h.border;
    reading.height.low = reading.found ? std::min(reading.height.low, h.z) : h.z;
    reading.height.high = reading.found ? std::max(reading.height.high, h.z) : h.z;
    reading.found = true;
  });
  return reading;
}

std::optional<double> HeightField::nearest(Point2 place) const {
  constexpr double far = std::numeric_limits<double>::infinity();
  for (double reach = 0; reach < 16; reach = reach == 0 ? 1 : 2 * reach) {
    Hit best{std::numeric_limits<double>::infinity(), 0, false};
    const double rx = reach * cell_x_, ry = reach * cell_y_;
    visit_cells({place.x - rx, place.y - ry, place.x + rx, place.y + ry}, {-far, -far, far, far}, [&](Index face) {
      const Hit h = hit(face, place, 0);
      if (h.distance2 < best.distance2) best = h;
    });
    const double sure = std::min(rx, ry);
    if (best.distance2 == 0 || best.distance2 <= sure * sure) return best.z;
  }
  return {};
}

HeightFields height_fields(const std::vector<const Tin*>& tins, Context& context) {
  HeightFields fields(tins.size());
  parallel_tasks(context, tins.size(), [&](std::size_t i) { fields[i] = std::make_shared<HeightField>(*tins[i], 64); });
  return fields;
}

}  // namespace terrane
