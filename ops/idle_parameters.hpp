// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "core/error.hpp"
#include "ops/parameters.hpp"

namespace terrane {

/// Refuses those of the named parameters that were set, because as the others stand nothing comes of them: "parameter
/// 'base' is for interval". P: the struct they are members of.
template <class P>
void refuse_idle(const nlohmann::json& values, std::initializer_list<std::string_view> names,
                 const std::string& what_for) {
  for (const Parameter& p : described<P>())
    if (std::find(names.begin(), names.end(), p.name) != names.end() &&
        values.value(p.name, p.default_value) != p.default_value)
      throw Error(ErrorKind::usage, "surplus-parameter",
                  "parameter '" + p.name + "' is for " + what_for + "; leave it out, or say that too");
}

}  // namespace terrane
