// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <string>

#include "core/context.hpp"
#include "core/tin.hpp"
#include "core/zones.hpp"

// The algebra of true and false on surfaces of two levels.
//
// The areas of truth are polygons with holes, but they are never taken apart into rings. Both domains, each with its
// zones of true and false, are overlaid; a table of truth says what every face of the overlay is; faces of equal truth
// are dissolved and triangulated anew. That is the boolean operation on the polygons, exact in its topology, and it has
// three advantages over operating on rings: unknown, false and true are three answers, not two; touching corners,
// nested rings and shared borders need no conventions; and crossings become doubles under the overlay's promises
// (core/rounding/rounding), so that no face is inverted and no border passes through a vertex of another. Booleans on
// rings with exact coordinates would leave that rounding to be done, and to be verified, afterwards.
namespace terrane {

enum Truth : Index { is_false = 0, is_true = 1 };

/// How far a face rises per distance in plan, both in one unit of length. None: as coordinates have it.
using Slope = std::function<double(const Point&, const Point&, const Point&)>;

struct BinaryRule {
  double mean = 127.5;  // what the level of a surface of one level alone is compared with: true from there up
  Slope slope;          // what 89.9 degrees are measured by
  std::string name;     // of the input, for messages
};

struct Binary {
  ZonedMesh mesh;               // zones are Truth; dissolved
  double lower = 0, upper = 0;  // the levels; equal where there is one alone
  bool one_level = false;
  RoundingReport rounding;
};

/// Reads a binary surface: level faces at one or two heights (equal up to 1e-9 * max(1, |z|)), besides walls and faces
/// steeper than 89.9 degrees, which may have any height. The upper level is true. Steep faces vanish into the areas on
/// their two sides: they are divided half-way between the levels, so that the domain keeps its extent and NOT of the
/// surface divides them at the same places. Throws Error{input, "not-binary"} naming a face where it is none.
/// Precondition: valid and canonical (core/validate). O(n log n).
Binary read_binary(const Tin& tin, const BinaryRule& rule, Context& context);

/// What a pair of truths becomes: [2 * a + b]. Commutative: b's and a's places in it are alike.
using TruthTable = std::array<Truth, 4>;

enum class Extent {
  overlap,  // unknown where either has no surface: left out
  box       // false there, and out to the box around both
};

struct Combined {
  ZonedMesh mesh;  // zones are Truth; dissolved
  RoundingReport rounding;
};

/// Combines two binary surfaces. The same bytes for (a, b) and (b, a). Empty where extent=overlap finds no overlap.
/// O(n log n) in input + output, as core/overlay.
Combined combine(const ZonedMesh& a, const ZonedMesh& b, const TruthTable& table, Extent extent, Context& context);

}  // namespace terrane
