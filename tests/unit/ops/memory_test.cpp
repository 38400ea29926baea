// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/memory.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>

#include "ops/errors.hpp"

using namespace terrane;

namespace {

constexpr std::uint64_t mega = 1 << 20;

/// From here on this process may have so much more address space than it has.
class Room {
 public:
  explicit Room(std::uint64_t bytes) {
    getrlimit(RLIMIT_AS, &before_);
    limit = address_space().now + bytes;
    const rlimit wanted{limit, before_.rlim_max};
    setrlimit(RLIMIT_AS, &wanted);
  }
  ~Room() { setrlimit(RLIMIT_AS, &before_); }
  std::uint64_t limit = 0;

 private:
  rlimit before_;
};

/// Two faces for each of n x n cells, `turned` so that no vertex of one lies on another.
std::string hills(int n, double turned) {
  Tin tin;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = 1000.0 * i / n - 500, y = 1000.0 * j / n - 500, c = std::cos(turned), s = std::sin(turned);
      tin.vertices.push_back({c * x - s * y, s * x + c * y, 10 * std::sin(x / 7 + turned) * std::cos(y / 9)});
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const Index v = j * (n + 1) + i;
      tin.faces.push_back({v, v + 1, v + n + 2});
      tin.faces.push_back({v, v + n + 2, v + n + 1});
    }
  Context context;
  return written(*format_named("ply"), tin, {}, {}, context);
}

class Memory : public testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers take all of the address space";
#endif
  }

  static Plan subtraction() {
    Request request{.operation = "subtract"};
    request.inputs = {{"minuend", "a.ply", "", hills(250, 0)}, {"subtrahend", "b.ply", "", hills(250, 0.3)}};
    return plan(request);
  }
  static constexpr std::uint64_t faces = 2 * 2 * 250 * 250;
  const MemoryUse each = memory_figures("subtract").face;

  /// What is said when the subtraction has so much room; empty when it succeeds.
  static std::string said_with(std::uint64_t bytes) {
    const Plan planned = subtraction();
    Context context;
    const Room room(bytes);
    try {
      execute(planned, context, {[](std::string_view) {}, true});
    } catch (const Error& error) {
      EXPECT_EQ(error.kind, ErrorKind::limit);
      EXPECT_EQ(error.code, "out-of-memory");
      EXPECT_EQ(http_status(error.kind), 413);
      EXPECT_NE(std::string(error.what()).find(std::to_string((room.limit + mega - 1) / mega) + " MB"), std::string::npos)
          << error.what();
      return error.what();
    }
    return "";
  }
};

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_F(Memory, WhatFitsByTheLargerFigureIsDone) { EXPECT_EQ(said_with(faces * each.most + 16 * mega), ""); }

TEST_F(Memory, WhatRunsOutIsToldWhatItHadAndWhatItNeeds) {
  const std::string said = said_with(faces * each.least + 8 * mega);
  EXPECT_TRUE(has(said, "had taken up to")) << said;
  EXPECT_TRUE(has(said, "with " + std::to_string(faces) + " faces")) << said;
  EXPECT_TRUE(has(said, "takes " + std::to_string(each.least) + " to " + std::to_string(each.most))) << said;
}

TEST_F(Memory, WhatCannotFitIsRefusedBeforeItIsDone) {
  const std::uint64_t used = address_space().now;
  const Room room(100 * mega);
  EXPECT_NO_THROW(require_memory(used, 100'000, "faces", {500, 9000}));
  try {
    require_memory(used, 1'000'000, "faces", {500, 9000});
    FAIL() << "that cannot fit";
  } catch (const Error& error) {
    EXPECT_EQ(error.code, "out-of-memory");
    for (const std::uint64_t bytes : {used, used + 500'000'000, room.limit})
      EXPECT_TRUE(has(error.what(), std::to_string((bytes + mega - 1) / mega) + " MB")) << error.what();
    EXPECT_TRUE(has(error.what(), "1000000 faces take 500 to 9000 bytes each")) << error.what();
  }
}

TEST_F(Memory, ARasterIsRefusedByItsCells) {
  Request request{.operation = "rasterize", .parameters = {{"width", "8000"}, {"height", "8000"}}};
  request.inputs = {{"surface", "a.ply", "", hills(5, 0)}};
  const Plan planned = plan(request);
  Context context;
  const Room room(64'000'000 * std::uint64_t{memory_figures("rasterize").cell.least} / 2);
  try {
    execute(planned, context);
    FAIL() << "that cannot fit";
  } catch (const Error& error) {
    EXPECT_TRUE(has(error.what(), "needs at least")) << error.what();
    EXPECT_TRUE(has(error.what(), "64000000 cells")) << error.what();
  }
}

TEST_F(Memory, WithoutALimitNothingIsRefused) {
  EXPECT_NO_THROW(require_memory(0, std::uint64_t{1} << 40, "faces", {1000, 9000}));
}

TEST(MemoryFigures, EveryOperationWithGeometryHasThem) {
  for (const Operation& operation : catalogue()) {
    const MemoryUse each = memory_figures(operation.id).face;
    EXPECT_EQ(each.most > each.least && each.least > 0, static_cast<bool>(operation.run)) << operation.id;
    const nlohmann::json description = process_description(operation);
    ASSERT_EQ(description.contains("additionalParameters"), static_cast<bool>(operation.run)) << operation.id;
    if (!operation.run) continue;
    const nlohmann::json& published = description["additionalParameters"]["parameters"][0];
    EXPECT_EQ(published["name"], "bytes-per-face");
    EXPECT_EQ(published["value"], nlohmann::json({{{"least", each.least}, {"most", each.most}}}));
  }
}
