// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "core/error.hpp"
#include "io/geodesy.hpp"

// libFuzzer on the text of a CRS: it is understood, and its id means the same again, or it is refused as the user's
// mistake.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace terrane;
  try {
    const Crs crs = Crs::parse({reinterpret_cast<const char*>(data), size});
    const Crs again = Crs::parse(crs.id());
    if (again.id() != crs.id() || !again.same_plan(crs)) {
      std::fprintf(stderr, "broken: %s\nbecame %s\n", crs.id().c_str(), again.id().c_str());
      std::abort();
    }
  } catch (const Error& error) {
    if (error.kind != ErrorKind::usage) {
      std::fprintf(stderr, "broken: %s\n", error.what());
      std::abort();
    }
  }
  return 0;
}
