// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "io/format.hpp"
#include "ops/operation.hpp"
#include "ops/outcome.hpp"

namespace terrane {

/// Where the faces of a result come from, found without a look at how it was made: the centroid of each is located in
/// every input as it was given (Surface::given), and the operation's rule is asked whose height holds there. Walls have
/// no place of their own and come from no face. A face thinner than rounding may be said to lie on a neighbour of the
/// one it lies on, and of a tile hidden beneath a pasted one the face at the centroid is named; so may, by half a step, those that an output grid or snapping has moved. 20 bytes a face of the
/// inputs; nothing is kept per face of the result. Keeps references to the result and to the surfaces' `given`.
Provenance provenance_of(const Plan& plan, const Tin& result, const std::vector<Surface>& surfaces,
                         const Outcome& outcome, Context& context);

}  // namespace terrane
