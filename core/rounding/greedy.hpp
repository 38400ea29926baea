// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "core/rounding/mesh_editor.hpp"

namespace terrane {

/// The first, fast step of mending: per cluster of bad faces merges vertices with equal doubles and flips the edge
/// opposite the middle vertex; taken back as a whole when the cluster does not come out valid with every face within
/// `bound` of what its label stands for. Returns the faces of the clusters it could not mend.
std::vector<Index> mend_greedily(MeshEditor& editor, const std::vector<Index>& bad,
                                 const std::function<ExactPlace(Index)>& place, const Spill& spill, double bound);

}  // namespace terrane
