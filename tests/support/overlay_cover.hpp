// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "core/overlay.hpp"
#include "core/tin.hpp"

namespace terrane::support {

/// What an overlay of A and B does not cover, or covers with the wrong parents; B as the overlay saw it. Areas of pairs
/// of parents, of lone parents and of the whole; the edges of the inputs; the border. Empty when all are right.
std::string wrong_cover(const Tin& a, const Tin& b, Refinement refinement, const Overlay& overlay);

}  // namespace terrane::support
