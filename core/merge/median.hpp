// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "core/context.hpp"
#include "core/mosaic.hpp"
#include "core/tin.hpp"

namespace terrane {

/// The median of n tiles (each checked) wherever they are: of an even number of heights the mean of the middle two.
/// `order`: the tiles that are merged, in the order of their ranks in `sets`.
///
/// Unlike min, max, mean and sum a median cannot be had from the median before and one more tile. So the tiles are
/// first overlaid in plan alone, every face remembering which face of which tile it lies on; then each face gets all
/// heights of its tiles, and is cut along the lines where the middle of them changes hands, as often as it takes. Exact
/// but for the rounding of the cuts. Lines between heights that are not in the middle cut nothing.
///
/// Each face's contributors are all tiles that lie there. O(n log n) in input and output, times the rounds of cutting:
/// as many as lines cross one face, few in practice. `lowest`, when given: of every face the first tile that lies
/// there, and the face of it without its walls. Throws Error{input, "rounding"} as overlay() does.
Piece median_surface(const std::vector<Tin>& tiles, const std::vector<int>& order, ContributorSets& sets,
                     RoundingReport& report, Context& context, std::vector<std::array<Index, 2>>* lowest = nullptr);

}  // namespace terrane
