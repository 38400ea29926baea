// SPDX-License-Identifier: GPL-3.0-or-later
// What the fuzzer of the overlay has found, and nobody has written a test of its own for.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "fuzz/meshes.hpp"
#include "support/overlay_judge.hpp"

namespace terrane {
namespace {

TEST(fuzz_seeds, every_promise_holds_on_what_broke_one_before) {
  const auto folder = std::filesystem::path(TERRANE_SOURCE_DIR) / "tests/fuzz/seeds/overlay";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(file), {});
    const fuzz::Pair pair = fuzz::pair({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    Context context;
    const Overlay overlaid = overlay(pair.a, pair.b, pair.options, context);
    EXPECT_EQ(support::broken_promises(pair.a, pair.b, pair.options, overlaid), "") << entry.path().filename();
  }
}

}  // namespace
}  // namespace terrane
