// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/error.hpp"
#include "tests/support/lattice_checks.hpp"

// Large rasters are triangulated in blocks, by as many threads as there are.
using namespace terrane;
using namespace terrane::testing;

namespace {

/// Rough enough for its vertices to stand a few samples apart, so that it is cut into blocks.
Raster hills(int width, int height, double void_share) {
  std::mt19937 random(11);
  Raster dem = random_raster(random, width, height, void_share, 3);
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      dem.samples[static_cast<std::size_t>(j) * width + i] += std::round(40 * std::sin(i * 0.05) * std::cos(j * 0.07));
    }
  }
  return dem;
}

Triangulated with_threads(const Raster& dem, double bound, int threads) {
  Context context;
  context.threads = threads;
  return triangulate(dem, {bound, 0}, context);
}

}  // namespace

TEST(TriangulateBlocks, HoldEveryPostConditionAcrossTheirSeams) {
  for (const double voids : {0.0, 0.01}) {
    for (const auto [width, height] : {std::array{1300, 20}, std::array{20, 1600}, std::array{400, 780}}) {
      const Raster dem = hills(width, height, voids);
      const Triangulated t = with_threads(dem, 1, 2);
      expect_correct(dem, t, 1);
      expect_delaunay(dem, t.tin);
      ASSERT_FALSE(HasFailure()) << width << " x " << height << ", voids " << voids;
    }
  }
}

TEST(TriangulateBlocks, TheSameBytesForAnyNumberOfThreads) {
  for (const double voids : {0.0, 0.01}) {
    const Raster dem = hills(1100, 300, voids);
    const Triangulated one = with_threads(dem, 1, 1);
    for (const int threads : {1, 2, 3, 7}) {
      const Triangulated t = with_threads(dem, 1, threads);
      EXPECT_EQ(t.tin, one.tin);
      EXPECT_EQ(t.error, one.error);
    }
  }
}

TEST(TriangulateBlocks, StopWhenCancelledAndReportProgress) {
  const Raster dem = hills(1100, 600, 0);
  for (const int threads : {1, 2}) {
    Context context;
    context.threads = threads;
    double last = 0;
    context.on_progress = [&](std::string_view, double fraction) {
      EXPECT_GE(fraction, 0);
      EXPECT_LE(fraction, 1);
      last = fraction;
      if (fraction > 0.3) context.cancelled = true;
    };
    EXPECT_THROW(triangulate(dem, {0.5, 0}, context), Error);
    EXPECT_LT(last, 0.8);
  }
}
