// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/context.hpp"
#include "core/raster.hpp"
#include "core/tin.hpp"

namespace terrane {

/// The heights of a TIN at the samples of `lattice` (whose own samples are not read): the highest of the faces whose
/// closed plan holds the sample's place, so the upper one at a wall; NaN where there is none. Which faces hold it is
/// decided exactly on the doubles of `lattice.place`; a sample at a vertex takes the vertex's height as it is, any
/// other differs from the plane of its face by no more than 2e-13 of the face's largest |z|; none is -0. Faces without
/// area in plan count by the surface beside them alone. The same bytes for any order of faces and any number of
/// threads. O(faces + samples); 8 bytes a sample, 16 a vertex and some 5 a face besides. Refuses what
/// `check_lattice` refuses of a lattice.
Raster rasterize(const Tin& tin, Raster lattice, Context& context);

}  // namespace terrane
