// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/tin.hpp"

namespace terrane {

/// Places by x, then y: an order that no numbering has a say in.
inline bool before(Point2 p, Point2 q) { return p.x < q.x || (p.x == q.x && p.y < q.y); }

}  // namespace terrane
