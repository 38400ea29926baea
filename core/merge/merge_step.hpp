// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/context.hpp"
#include "core/merge.hpp"
#include "core/merge/blend.hpp"
#include "core/merge/needless.hpp"
#include "core/merge/ramp.hpp"
#include "core/mosaic.hpp"
#include "core/overlay.hpp"

// What one more tile makes of the surface that has accumulated so far: the heights of each overlap policy.
namespace terrane {

/// Whether the order of the tiles given must not matter.
bool any_order(Overlap overlap);

/// What a merge counts on its way.
struct MergeReports {
  RoundingReport rounding;
  BlendReport blend;
};

/// A tile, of a rank above those that have accumulated, on top of, under, or mixed with what is near it. O(n log n) of
/// both and the pieces they cut each other into.
Piece with_tile(const Piece& near, const Piece& tile, int rank, const MergeOptions& options, ContributorSets& sets,
                Cells& cells, MergeReports& reports, Context& context);

/// Whether the height of a face at a place is an input's own.
bool is_firm(const Piece& from, Index parent, Point2 at);

/// With its jumps sloped; the sets of faces say which slope.
Piece sloped(Piece piece, const RampGround& ground, Meeting meeting, ContributorSets& sets, Cells& cells,
             Context& context);

}  // namespace terrane
