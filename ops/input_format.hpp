// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "ops/operation.hpp"
#include "ops/parameters.hpp"

namespace terrane {

/// What a part is called in messages and certificates: its file name, else its input's name.
std::string label(const InputPart& part);

/// The level a part stands for, when its input takes one and the part holds nothing but a number.
std::optional<Length> level_of(const InputPart& part, const InputSlot& slot);

/// Whether a part is the word that may stand in for a surface.
bool is_word(const InputPart& part, const InputSlot& slot);

/// The format of a part: its media type unless that is generic, then the file name, then the first bytes.
/// Throws Error{unsupported} listing what can be read.
const Format& input_format(const InputPart& part);

}  // namespace terrane
