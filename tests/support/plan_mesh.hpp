// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/tin.hpp"
#include "support/exact.hpp"

// Meshes in plan, judged exactly and without any code of the core.
namespace terrane::support {

/// What is wrong with a mesh: indices out of range, places twice, unused places, faces that are not strictly positive,
/// edges with two faces on one side, T-junctions, faces that overlap. Empty when it is right. Compares all faces whose
/// boxes meet: for small meshes.
std::string wrong_in_plan(std::span<const Point2> points, std::span<const Face> faces);

/// A TIN in plan: vertices at one place joined, walls left out.
struct PlanMesh {
  std::vector<Point2> points;
  std::vector<Face> faces;
  std::vector<Index> face_in_tin;
};
PlanMesh plan_mesh(const Tin& tin);

/// Directed edges without a partner.
std::vector<std::pair<Index, Index>> border_of(std::span<const Face> faces);

inline Triangle triangle(std::span<const Point2> points, const Face& f) {
  return {points[f[0]], points[f[1]], points[f[2]]};
}

inline Triangle triangle(const Tin& tin, Index f) {
  return {plan(tin.vertices[tin.faces[f][0]]), plan(tin.vertices[tin.faces[f][1]]),
          plan(tin.vertices[tin.faces[f][2]])};
}

Box box_of(const Triangle& t);

/// The smallest distance of a corner from the line of the others.
double thickness(const Triangle& t);

inline bool boxes_meet(const Box& s, const Box& t) {
  return s.xmin <= t.xmax && t.xmin <= s.xmax && s.ymin <= t.ymax && t.ymin <= s.ymax;
}

}  // namespace terrane::support
