// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdint>

#include "core/error.hpp"
#include "fuzz/require.hpp"
#include "io/geodesy.hpp"

// libFuzzer on the text of a CRS: it is understood, and its id means the same again, or it is refused as the user's
// mistake.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace terrane;
  try {
    const Crs crs = Crs::parse({reinterpret_cast<const char*>(data), size});
    const Crs again = Crs::parse(crs.id());
    fuzz::require(again.id() == crs.id() && again.same_plan(crs), crs.id().c_str());
  } catch (const Error& error) {
    fuzz::require(error.kind == ErrorKind::usage, error.what());
  }
  return 0;
}
