// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "io/format.hpp"

namespace terrane {

/// Reads Terrane JSON in one pass without a document tree. Members may come in any order; unknown ones are passed over.
Dataset read_terrane_json(Source source, const ReadOptions& options, Context& context);

}  // namespace terrane
