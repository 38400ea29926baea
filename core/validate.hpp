// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/context.hpp"
#include "core/tin.hpp"

// What a TIN must be before anything is computed on it, and what the certificate says of a result.
namespace terrane {

/// Beyond this products of coordinates overflow.
inline constexpr double largest_coordinate = 1e100;

/// One thing wrong with a TIN. Codes: not-finite, too-large, index-out-of-range, overlapping-faces, two-heights,
/// non-manifold-edge, t-junction, duplicate-vertex, duplicate-face, unused-vertex, zero-area-face, clockwise-face.
struct Defect {
  std::string code;
  std::string element;  // "face 9", "vertices 3 and 17"
  std::string message;
};

/// Every defect of the TIN, at most `limit` per code, in order of the elements; never throws. An empty list means: valid.
/// Exact: overlap is judged by the winding number of the border, adjacency and exact orientation, not by sampling.
/// O(n log n).
std::vector<Defect> find_defects(const Tin& tin, std::size_t limit = 20, const Context& context = {});

/// How many of each harmless defect were mended.
struct Mending {
  std::size_t duplicate_vertices = 0, duplicate_faces = 0, unused_vertices = 0, zero_area_faces = 0, clockwise_faces = 0,
              t_junctions = 0;
};

/// The TIN in canonical order, ready to be computed on. Mended and counted in context.warnings (code "mended", naming the
/// input): duplicate points of equal height, duplicate faces, unused vertices, zero-area faces that are not walls, mixed
/// orientation, border vertices in the middle of another face's edge (that face is split).
/// Throws Error{input} listing up to 20 of: NaN or infinity, index out of range, overlapping faces, two heights at one
/// point of faces that hang together there, without a wall or an open jump (along an edge both ends of which have two),
/// edges with three faces.
Tin checked(Tin tin, const std::string& name, Context& context, Mending* mending = nullptr);

/// Counts on a TIN as it is, for the certificate and `info`. Never throws. Walls are counted apart and belong to no other count.
struct Inspection {
  std::size_t vertices = 0, faces = 0, walls = 0;
  std::size_t inverted = 0, degenerate = 0;        // faces of negative and of zero area in plan that are not walls, exactly
  std::size_t t_junctions = 0;                     // vertices inside an edge of a face they do not belong to
  std::size_t non_manifold_edges = 0;              // plan edges with more than two faces, or two on one side
  std::size_t overlaps = 0;                        // 0 when the border winds around every place at most once
  std::size_t components = 0, holes = 0;           // of the domain in plan, joined over shared edges; holes of all components
};
Inspection inspect(const Tin& tin, const Context& context = {});

}  // namespace terrane
