// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "core/context.hpp"
#include "core/tin.hpp"

namespace terrane {

struct Repaired {
  Tin tin;
  nlohmann::json changes;  // counts by kind
};

/// A valid TIN of one that is not. Harmless defects are mended as for every operation. Faces with corners that are
/// missing
/// or not finite go. Where faces overlap or a place has two heights, faces are laid into sheets that are each free of
/// it,
/// in their order, and the sheets are merged, the earlier one on top. Throws Error{input} when nothing sound is left
/// of a
/// TIN that had faces.
Repaired repair(Tin tin, const std::string& name, Context& context);

}  // namespace terrane
