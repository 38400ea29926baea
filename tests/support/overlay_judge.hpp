// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "core/overlay.hpp"
#include "core/tin.hpp"

namespace terrane::support {

/// Which promises of core/overlay.hpp an overlay breaks, judged exactly on the returned doubles and without code of the
/// core: the mesh is valid in plan; vertices and edges of the inputs are there; every crossing lies within max_move of
/// its exact place; every face within max_spill, and 3 max_move, of its parents; the area of every pair of parents, of every lone
/// parent and of the whole is that of the exact overlay; the border is that of the union; heights are those of the
/// inputs; the report is true. Empty when all are kept. For small inputs: compares all pairs of faces.
std::string broken_promises(const Tin& a, const Tin& b, const OverlayOptions& options, const Overlay& overlay);

/// B as the overlay saw it: its vertices that are missing from the result on the vertex of A that they were snapped to.
Tin as_snapped(const Tin& a, const Tin& b, const Overlay& overlay);

}  // namespace terrane::support
