// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/context.hpp"
#include "core/overlay.hpp"
#include "core/plan/exact_place.hpp"
#include "core/tin.hpp"

// From exact positions to doubles that are a valid mesh. Input vertices never move; a constructed vertex lands on its
// rounded place; faces that rounding turned over are mended by local merges and flips, by kinetic moves where that is
// not enough.
namespace terrane {

/// A triangulated piece of the plane under repair.
struct PlanarMesh {
  Array<Point2> points;    // rounded places, as they will be returned
  Array<Face> faces;       // positive at the exact places; a dead face has faces[f][0] == none
  Array<Face> neighbours;  // neighbours[f][k]: the face across the edge opposite corner k, or none
  Array<Index> labels;     // what a face belongs to, none: the exterior; a flip hands the neighbour's label to both
};

/// How far the farthest place of a face, given by its corners, or of a vertex alone lies from what a label stands for
/// (none: the exterior).
using Spill = std::function<double(Index label, std::span<const Point2> corners)>;
/// Where labels stand for something convex: then no place of a face is farther from it than a corner.
Spill farthest_corner(std::function<double(Index label, Point2)> distance);

/// Fills `neighbours` from `faces`. Each directed edge may occur once.
void connect(PlanarMesh& mesh);

/// Makes every face of the mesh strictly positive on its doubles. `place(v)` says where vertex v lies exactly
/// (kind input: exactly at points[v]). Vertices may be merged and edges flipped: merged_into[v] tells where v went (v
/// itself when it stayed), relabelled lists the live faces whose corners or label changed. An open border stays where
/// it is: where a vertex may have to pass it, what lies beyond must be faces too (core/rounding/exterior). Linear in
/// the faces; about 5 us per vertex of a bad cluster that needs kinetic moves.
struct Rounded {
  RoundingReport report;
  std::vector<Index> merged_into;
  std::vector<Index> relabelled;
};
/// Promises: every live face is strictly positive by exact predicates on the returned doubles; input vertices are where
/// they were; the order of the steps depends on the numbers of vertices and faces only. Flips are accepted while
/// `spill`, when given, stays within 3 * the largest move, else the slower way is taken; the largest is
/// report.max_spill. `at_home(label, p)`, when given, is the label, or, where it stands for the outside of an input
/// that p lies inside, the one that stands for where p lies: with it no large face becomes part of the outside. Throws
/// Error{input, "rounding"} naming the place when some face cannot be made positive.
Rounded round_and_verify(PlanarMesh& mesh, const std::function<ExactPlace(Index)>& place, Context& context,
                         const Spill& spill = {}, const std::function<Index(Index label, Point2)>& at_home = {});

}  // namespace terrane
