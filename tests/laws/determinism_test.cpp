// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string>
#include <type_traits>

#include "core/arithmetic.hpp"
#include "core/lean_walls.hpp"
#include "core/merge.hpp"
#include "core/overlay.hpp"
#include "core/snap_borders.hpp"
#include "core/surface.hpp"
#include "core/validate.hpp"
#include "core/volume.hpp"
#include "support/terrains.hpp"

// The same bytes for any number of threads, any order of faces, vertices and corners, and any order of tiles where the
// policy does not ask for one.
namespace terrane {
namespace {

/// Values as the bytes that would be written; equal bytes is more than equal numbers (-0 is not 0).
class Bytes {
 public:
  template <class T>
  requires std::is_arithmetic_v<T> Bytes& operator<<(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  Bytes& operator<<(const Point2& p) { return *this << p.x << p.y; }
  Bytes& operator<<(const Point& p) { return *this << p.x << p.y << p.z; }
  template <class Range>
  requires requires(const Range& range) { range.size(); }
  Bytes& operator<<(const Range& range) {
    *this << range.size();
    for (const auto& value : range) *this << value;
    return *this;
  }
  Bytes& operator<<(const RoundingReport& r) {
    return *this << r.max_move << r.max_snap << r.max_spill << r.snapped << r.merges << r.flips << r.kinetic
                 << r.regions << r.collapsed;
  }
  Bytes& operator<<(const Overlay& o) {
    *this << o.points << o.faces << o.parents << o.per_corner[0] << o.per_corner[1] << o.rounding;
    for (const int input : {0, 1})  // heights mean nothing where there is no parent
      for (Index f = 0; f < static_cast<Index>(o.faces.size()); ++f)
        for (int k = 0; k < 3; ++k)
          if (o.parents[f][input] != none) *this << o.height(input, f, k);
    return *this;
  }
  Bytes& operator<<(const Tin& tin) { return *this << tin.vertices << tin.faces; }
  Bytes& operator<<(const Assembled& a) { return *this << a.tin << a.rounding << a.wall_area << a.max_closed_jump; }
  Bytes& operator<<(const Inspection& i) {
    return *this << i.vertices << i.faces << i.walls << i.inverted << i.degenerate << i.t_junctions
                 << i.non_manifold_edges << i.overlaps << i.components << i.holes;
  }
  Bytes& operator<<(const VolumeSide& s) { return *this << s.volume << s.area_2d << s.area_3d << s.max_dz; }
  Bytes& operator<<(const Volume& v) {
    return *this << v.fill << v.cut << v.same_area_2d << v.same_area_3d << v.net << v.overlap_area_2d
                 << v.surface_only_area_2d << v.reference_only_area_2d << v.identity_residual;
  }
  /// Where the first difference is, so that a failure does not print megabytes; npos when there is none.
  std::size_t differs_from(const Bytes& other) const {
    const auto at = std::mismatch(bytes_.begin(), bytes_.end(), other.bytes_.begin(), other.bytes_.end());
    return at.first == bytes_.end() && at.second == other.bytes_.end() ? same : at.first - bytes_.begin();
  }
  static constexpr std::size_t same = std::string::npos;

 private:
  std::string bytes_;
};

/// Everything that is computed on two surfaces: given in any order, by any number of threads.
Bytes everything(const Tin& given_a, const Tin& given_b, int threads) {
  Context context;
  context.threads = threads;
  const Tin a = checked(given_a, "a", context), b = checked(given_b, "b", context);
  Bytes bytes;
  bytes << a << b;
  for (const Refinement refinement : {Refinement::full, Refinement::paste})
    bytes << overlay(a, b, {.refinement = refinement}, context);
  const Overlay unsnapped = overlay(a, b, {.snap = 0}, context);
  bytes << unsnapped << split_where_surfaces_cross(unsnapped, context);
  bytes << combine(a, b, 1, Outside::keep, {}, context) << combine(a, b, -1, Outside::drop, {}, context);
  bytes << volume(a, b, 0.5, {}, context);
  return bytes;
}

void expect_same_everywhere(const Tin& a, const Tin& b, const std::vector<int>& thread_counts) {
  const Bytes expected = everything(a, b, 1);
  for (const int threads : thread_counts)
    EXPECT_EQ(everything(a, b, threads).differs_from(expected), Bytes::same) << threads << " threads";
  for (const std::uint64_t seed : {1, 2})
    EXPECT_EQ(everything(support::shuffled(a, seed), support::shuffled(b, 100 + seed), thread_counts.back())
                  .differs_from(expected),
              Bytes::same)
        << "shuffled by " << seed;
}

struct Case {
  std::string name;
  bool utm;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name << (c.utm ? " at UTM" : ""); }

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const std::string& name : support::nasty_pairs())
    for (const bool utm : {false, true}) all.push_back({name, utm});
  return all;
}

class SameBytes : public ::testing::TestWithParam<Case> {};

TEST_P(SameBytes, ForAnyThreadsAndAnyOrder) {
  const support::Pair pair = support::nasty_pair(GetParam().name, GetParam().utm, 300);
  expect_same_everywhere(pair.a, pair.b, {2, 4});
}

INSTANTIATE_TEST_SUITE_P(Determinism, SameBytes, ::testing::ValuesIn(cases()), [](const auto& info) {
  std::string name = info.param.name + (info.param.utm ? "_utm" : "");
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

// Large enough that work is shared out in many ranges, with degeneracies on their borders.
class SameBytesWhenLarge : public ::testing::TestWithParam<const char*> {};

TEST_P(SameBytesWhenLarge, ForAnyThreadsAndAnyOrder) {
  const support::Pair pair = support::nasty_pair(GetParam(), true, 20000);
  Bytes expected;
  for (const int run : {0, 1, 2, 3, 4}) {
    Context context;
    context.threads = std::array{1, 2, 3, 4, 4}[run];
    const bool shuffle = run == 4;
    const Tin given = shuffle ? support::shuffled(pair.a, 1) : pair.a, a = checked(given, "a", context);
    const Tin b = checked(shuffle ? support::shuffled(pair.b, 2) : pair.b, "b", context);
    Bytes bytes;
    bytes << overlay(a, b, {}, context) << inspect(given, context);
    const Tin difference = combine(a, b, -1, Outside::drop, {}, context).tin;
    bytes << difference << inspect(difference, context) << plan_area(difference, context);
    if (run == 0)
      expected = bytes;
    else
      EXPECT_EQ(bytes.differs_from(expected), Bytes::same) << context.threads << " threads, shuffled: " << shuffle;
  }
}

INSTANTIATE_TEST_SUITE_P(Determinism, SameBytesWhenLarge,
                         ::testing::Values("random", "identical", "jitter-1e-3", "simplified", "holes", "islands",
                                           "tiles-ulp", "steps-1e-3"),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

/// Overlapping windows, one that only touches, one inside another, two that are the same.
std::vector<Tin> tiles(int points) {
  std::vector<Tin> tiles;
  for (int i = 0; i < 4; ++i)
    tiles.push_back(support::shifted(support::random_terrain(points, 10 + i), (i % 2) * 8000.0, (i / 2) * 8500.0));
  tiles.push_back(support::shifted(support::random_terrain(points, 20), 18000, 0));
  tiles.push_back(support::with_holes(tiles[3]));
  tiles.push_back(tiles[0]);
  return tiles;
}

Bytes merged(const std::vector<Tin>& tiles, Overlap policy, int threads) {
  Context context;
  context.threads = threads;
  std::vector<Tin> ready;
  for (const Tin& tile : tiles) ready.push_back(checked(tile, "tile", context));
  Bytes bytes;
  bytes << merge(ready, {policy, {}}, context).surface;
  return bytes;
}

class MergesAlike : public ::testing::TestWithParam<Overlap> {};

TEST_P(MergesAlike, ForAnyThreadsAndAnyOrderWithinTiles) {
  const std::vector<Tin> given = tiles(200);
  const Bytes expected = merged(given, GetParam(), 1);
  for (const int threads : {2, 4}) EXPECT_EQ(merged(given, GetParam(), threads).differs_from(expected), Bytes::same);
  std::vector<Tin> shuffled;
  for (const Tin& tile : given) shuffled.push_back(support::shuffled(tile, 3 + shuffled.size()));
  EXPECT_EQ(merged(shuffled, GetParam(), 4).differs_from(expected), Bytes::same);
}

class SymmetricPolicy : public ::testing::TestWithParam<Overlap> {};

TEST_P(SymmetricPolicy, MergesAlikeForAnyOrderOfTiles) {
  const std::vector<Tin> given = tiles(200);
  const Bytes expected = merged(given, GetParam(), 1);
  for (const std::vector<int>& order :
       {std::vector{6, 5, 4, 3, 2, 1, 0}, {2, 0, 6, 3, 1, 5, 4}, {5, 3, 4, 0, 6, 2, 1}, {1, 6, 0, 4, 2, 3, 5}}) {
    std::vector<Tin> permuted;
    for (const int t : order) permuted.push_back(support::shuffled(given[t], 5 + t));
    EXPECT_EQ(merged(permuted, GetParam(), 2).differs_from(expected), Bytes::same);
  }
}

std::string policy_name(const ::testing::TestParamInfo<Overlap>& info) {
  return std::array{"first", "last", "min", "max", "mean", "median", "sum"}[static_cast<std::size_t>(info.param)];
}

INSTANTIATE_TEST_SUITE_P(Determinism, MergesAlike,
                         ::testing::Values(Overlap::first, Overlap::last, Overlap::min, Overlap::max, Overlap::mean,
                                           Overlap::median, Overlap::sum),
                         policy_name);
INSTANTIATE_TEST_SUITE_P(Determinism, SymmetricPolicy,
                         ::testing::Values(Overlap::min, Overlap::max, Overlap::mean, Overlap::median, Overlap::sum),
                         policy_name);

/// Tiles that nearly meet, snapped and what is left of slits bridged, then leaned.
Bytes closed(const std::vector<Tin>& tiles, Overlap policy, int threads) {
  Context context;
  context.threads = threads;
  MergeOptions options{policy, {}};
  options.gap = 250;
  const SnappedTiles snapped = snap_borders(tiles, 90, {}, context);
  const Merged whole = merge(snapped.tiles, options, context);
  Bytes bytes;
  bytes << whole.surface << snapped.report.moved << snapped.report.inserted << whole.bridged.faces << whole.bridged.area
        << lean_walls(whole.surface.tin, 0.01, {}, context).tin;
  return bytes;
}

TEST_P(SymmetricPolicy, SnapsAndBridgesAlikeForAnyOrderOfTiles) {
  std::vector<Tin> given;
  for (int i = 0; i < 5; ++i)
    given.push_back(canonical(
        support::jittered(support::shifted(support::random_terrain(150, 30 + i), (i % 3) * 10150.0, (i / 3) * 10120.0),
                          60, true, 9 + i)));
  const Bytes expected = closed(given, GetParam(), 1);
  for (const std::vector<int>& order : {std::vector{4, 3, 2, 1, 0}, {2, 0, 3, 1, 4}, {1, 4, 0, 2, 3}}) {
    std::vector<Tin> permuted;
    for (const int t : order) permuted.push_back(given[t]);
    EXPECT_EQ(closed(permuted, GetParam(), 2).differs_from(expected), Bytes::same);
  }
}

}  // namespace
}  // namespace terrane
