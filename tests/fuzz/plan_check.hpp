// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string_view>

#include "core/error.hpp"
#include "fuzz/require.hpp"
#include "ops/operation.hpp"
#include "server/requests/execute_request.hpp"

namespace terrane::fuzz {

/// Calls `ask` for the operation that the first byte chooses and plans what it returns: either is done, or the request
/// is refused as the user's mistake.
template <class Ask>
void check_plan(const std::uint8_t* data, std::size_t size, Ask ask) {
  if (size == 0) return;
  const Operation& operation = catalogue()[data[0] % catalogue().size()];
  try {
    Request request = ask(operation, std::string_view(reinterpret_cast<const char*>(data) + 1, size - 1));
    request.operation = operation.id;
    plan(std::move(request));
  } catch (const Error& error) {
    require(error.kind == ErrorKind::usage || error.kind == ErrorKind::unsupported || error.kind == ErrorKind::limit ||
                error.kind == ErrorKind::not_acceptable,
            error.what());
  }
}

}  // namespace terrane::fuzz
