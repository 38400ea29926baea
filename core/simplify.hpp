// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>

#include "core/context.hpp"
#include "core/tin.hpp"

// Fewer faces for nearly the same surface.
namespace terrane {

struct SimplifyOptions {
  /// The result is nowhere further from the surface than this, vertically: at its vertices, and where its edges cross
  /// those of the result. 0: only what is exactly flat goes.
  double max_error = INFINITY;
  /// Stops when no more faces than this are left, walls counted. 0: when max_error lets nothing more go.
  std::size_t max_triangles = 0;
  /// The border stays vertex for vertex, so that neighbours still meet. Otherwise vertices go where it runs exactly
  /// straight on in plan: the domain stays what it is in any case.
  bool keep_boundary = true;
};

struct Simplified {
  Tin tin;              // canonical; its vertices are vertices of the surface
  double error = 0;     // how far it is from the surface, measured on the result; good to a few ulp of the heights
  double verified = 0;  // the same on the overlay of both (largest_difference), whose crossings are rounded; not a
                        // number where rounding them fails
};

/// Takes out vertices one at a time, those that matter least first, and fills the holes with triangles of the vertices
/// around. Every step is measured against the surface as it came (core/simplify/deviation), never against the step
/// before. The border, jumps, and walls with their feet stay; so do vertices with another one at their place.
/// Precondition: a valid TIN, as checked() returns it. The same bytes for any number of threads and, in canonical
/// order, for any order the faces came in. O(n log n) in practice: some 10 us per vertex.
/// See Schroeder, Zarge & Lorensen (1992) for the scheme; choosing among all triangulations of a hole by dynamic
/// programming is due to Klincsek (1980).
Simplified simplify(const Tin& tin, const SimplifyOptions& options, Context& context);

/// The same, verified on the overlay of the surface and the result. Should that find the bound exceeded by more than
/// rounding the whole is done again with as much less; Error{internal} when that does not help.
Simplified simplify_and_verify(const Tin& tin, SimplifyOptions options, Context& context);

/// What heights of a TIN are good to once it has been through an overlay: within it faces are one plane.
double coplanar_tolerance(const Tin& tin);

}  // namespace terrane
