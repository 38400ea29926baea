// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/snapping.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/predicates.hpp"

namespace terrane {
namespace {

double four_ulp(const CompletedMesh& a, const CompletedMesh& b) {
  double largest = 0;
  for (const CompletedMesh* mesh : {&a, &b})
    for (Index i = 0; i < mesh->real_places(); ++i)
      largest = std::max({largest, std::fabs(mesh->at(i).x), std::fabs(mesh->at(i).y)});
  return 4 * (std::nextafter(largest, INFINITY) - largest);
}

/// The place of A within `tolerance` that is nearest to q, among the corners of the faces at its location.
Index near_place(const CompletedMesh& a, Location where, Point2 q, double tolerance) {
  Index best = none;
  double nearest = tolerance;
  const auto look = [&](Index face) {
    for (int k = 0; k < 3; ++k) {
      const Index i = a.corner(4 * face + k);
      if (i >= a.real_places()) continue;
      const double dx = a.at(i).x - q.x, dy = a.at(i).y - q.y;
      if (std::fabs(dx) > tolerance || std::fabs(dy) > tolerance) continue;  // nearly always
      const double d = std::hypot(dx, dy);
      if (d < nearest || (d == nearest && (best == none || i < best))) nearest = d, best = i;
    }
  };
  look(face_at(a, where));
  if (where.kind == Location::edge && a.twin(where.index) != none) look(a.twin(where.index) >> 2);
  return best;
}

bool positive(const CompletedMesh& mesh, const Array<Point2>& at, Index f) {
  return orientation(at[mesh.corner(4 * f)], at[mesh.corner(4 * f + 1)], at[mesh.corner(4 * f + 2)]) > 0;
}

}  // namespace

Snapped snap_places(const Tin& b, const Box& frame, CompletedMesh completed, const CompletedMesh& a, double tolerance,
                    Context& context) {
  Snapped result;
  result.location.assign(completed.places.size(), {});
  locate_places(completed, a, result.location, context);
  result.mesh = std::move(completed);
  const CompletedMesh& mesh = result.mesh;
  const Index n = static_cast<Index>(mesh.places.size());
  if (tolerance < 0) tolerance = four_ulp(a, mesh);
  if (tolerance == 0) return result;

  // Whose place of A is it? Coincident vertices own theirs; of the others the nearest gets it.
  std::vector<Index> partner(n, none), owner(a.places.size(), none);
  for (Index j = 0; j < n; ++j)
    if (result.location[j].kind == Location::place) owner[result.location[j].index] = j;
  const auto distance = [&](Index i, Index j) {
    return std::hypot(a.at(i).x - mesh.at(j).x, a.at(i).y - mesh.at(j).y);
  };
  bool any = false;
  for (Index j = 0; j < mesh.real_places(); ++j) {
    if (result.location[j].kind == Location::place) continue;
    const Index i = near_place(a, result.location[j], mesh.at(j), tolerance);
    if (i == none) continue;
    const Index rival = owner[i];
    if (rival != none && distance(i, rival) <= distance(i, j)) continue;
    if (rival != none) partner[rival] = none;
    owner[i] = j;
    partner[j] = i;
    any = true;
  }
  if (!any) return result;

  Array<Point2> at = mesh.places;
  for (Index j = 0; j < n; ++j)
    if (partner[j] != none) at[j] = a.at(partner[j]);
  for (bool changed = true; changed;) {  // a face that would not stay positive keeps its corners where they were
    changed = false;
    for (Index f = 0; f < mesh.real_faces; ++f) {
      if (positive(mesh, at, f)) continue;
      for (int k = 0; k < 3; ++k) {
        const Index j = mesh.corner(4 * f + k);
        if (partner[j] == none) continue;
        partner[j] = none;
        at[j] = mesh.at(j);
        changed = true;
      }
    }
  }
  std::vector<Point2> moved(b.vertices.size());
  for (std::size_t v = 0; v < moved.size(); ++v) moved[v] = plan(b.vertices[v]);
  for (Index f = 0; f < mesh.real_faces; ++f)
    for (int k = 0; k < 3; ++k) moved[b.faces[mesh.tin_face(f)][k]] = at[mesh.corner(4 * f + k)];
  try {
    CompletedMesh snapped = complete(b, frame, &moved);
    if (snapped.places.size() != mesh.places.size()) return result;  // two became one: leave B alone
    for (Index j = 0; j < n; ++j)
      if (partner[j] != none) {
        ++result.count;
        result.max_move = std::max(result.max_move, distance(partner[j], j));
        result.location[j] = {Location::place, partner[j]};
      }
    result.mesh = std::move(snapped);
  } catch (const Error&) {
    // The snapped border would cross itself: B stays as it came.
  }
  return result;
}

}  // namespace terrane
