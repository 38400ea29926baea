// SPDX-License-Identifier: GPL-3.0-or-later
#include "fuzz/plan_check.hpp"

// libFuzzer on execute requests in JSON, up to the plan.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace terrane;
  fuzz::check_plan(data, size, [](const Operation& operation, std::string_view body) {
    return ask_from_json(operation, body).request;
  });
  return 0;
}
