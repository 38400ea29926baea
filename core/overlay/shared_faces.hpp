// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/overlay.hpp"
#include "core/tin.hpp"

// Two surveys of one terrain, or a design and its revision, mostly have the same faces. Those need no refinement: they
// are set aside, what is left of each TIN is overlaid, and both are put together again. The border between the two is
// made of edges that both TINs have, and nothing crosses an edge of its own TIN, so no vertex is missing on it.
namespace terrane {

struct Divided {
  std::vector<std::array<Index, 2>> shared;  // faces of A and of B that are the same in plan, in order
  std::array<Tin, 2> rest;                   // the other faces, in order
  std::array<std::vector<Index>, 2> face;    // of a face of a rest: its number in the TIN
  std::array<std::vector<Index>, 2> vertex;  // of a vertex of the TIN: its number in the rest, or none
  std::vector<Index> partner;                // of a vertex of A: that of B at the same place, or none
};

/// Sets aside what A and B, in canonical order, share. Nothing where that would not pay or not do: they share little,
/// one of them has nothing else, their extents differ, or one has two heights at a place. O(n); where they share
/// little, a look at every vertex for the extents and at a few for the rest.
std::optional<Divided> divide(const Tin& a, const Tin& b);

/// The overlay of A and B from that of the rests, which must not have moved or merged any vertex (empty when nothing is
/// left). Nothing when its vertices are not in the order of the rests, as when A or B was in no canonical order.
std::optional<Overlay> put_together(const Divided& divided, const Tin& a, const Tin& b, Overlay of_rests);

}  // namespace terrane
