// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/overlay.hpp"
#include "core/predicates.hpp"
#include "core/sum.hpp"
#include "core/validate.hpp"
#include "support/checks.hpp"
#include "support/oracle.hpp"
#include "support/terrains.hpp"

// The overlay against CGAL's exact one, on every pair that broke other overlays.
namespace terrane {
namespace {

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

double covered(const Overlay& overlay, bool overlap_only) {
  Sum area;
  for (std::size_t f = 0; f < overlay.faces.size(); ++f) {
    if (overlap_only && (overlay.parents[f][0] == none || overlay.parents[f][1] == none)) continue;
    const Face& t = overlay.faces[f];
    area.add(0.5 * area2_accurate(overlay.points[t[0]], overlay.points[t[1]], overlay.points[t[2]]));
  }
  return area.value();
}

/// The faces as a flat surface, to be judged as one.
Tin flat(const Overlay& overlay) {
  Tin tin;
  for (const Point2& p : overlay.points) tin.vertices.push_back({p.x, p.y, 0});
  tin.faces.assign(overlay.faces.begin(), overlay.faces.end());
  return canonical(tin);
}

/// The faces that lie on an input, at its heights.
Tin lifted(const Overlay& overlay, int input) {
  Tin tin;
  for (Index f = 0; f < static_cast<Index>(overlay.faces.size()); ++f) {
    if (overlay.parents[f][input] == none) continue;
    tin.faces.push_back({});
    for (int k = 0; k < 3; ++k) {
      const Point2 p = overlay.points[overlay.faces[f][k]];
      tin.faces.back()[k] = static_cast<Index>(tin.vertices.size());
      tin.vertices.push_back({p.x, p.y, overlay.height(input, f, k)});
    }
  }
  return canonical(tin);
}

double perimeter(const Tin& tin) {
  double length = 0;
  for (const Face& f : tin.faces)
    for (int k = 0; k < 3; ++k) {
      const Point &p = tin.vertices[f[k]], &q = tin.vertices[f[(k + 1) % 3]];
      length += std::hypot(p.x - q.x, p.y - q.y);
    }
  return length;
}

class NastyPair : public ::testing::TestWithParam<Case> {
 protected:
  static constexpr int points = 300;
};

TEST_P(NastyPair, IsAPairOfValidTerrains) {
  const support::Pair pair = support::nasty_pair(GetParam().name, GetParam().utm, points);
  EXPECT_TRUE(find_defects(pair.a).empty());
  EXPECT_TRUE(find_defects(pair.b).empty());
}

TEST_P(NastyPair, HasTheRegionsOfTheExactArrangement) {
  const support::Pair pair = support::nasty_pair(GetParam().name, GetParam().utm, points);
  Context context;
  OverlayOptions options;
  options.snap = 0;  // or the two would not overlay the same input
  const Overlay overlaid = overlay(pair.a, pair.b, options, context);
  const support::OracleCounts truth = support::oracle_counts(pair.a, pair.b);
  EXPECT_EQ(static_cast<std::size_t>(overlaid.rounding.regions), truth.regions);
  const double delta = overlaid.rounding.max_move;
  const double slack = delta * (perimeter(pair.a) + perimeter(pair.b)) + 1e-14 * truth.area;
  EXPECT_NEAR(covered(overlaid, false), truth.area, slack);
  EXPECT_NEAR(covered(overlaid, true), truth.overlap_area, slack);
}

TEST_P(NastyPair, IsAValidMeshWithTheHeightsOfBoth) {
  const support::Pair pair = support::nasty_pair(GetParam().name, GetParam().utm, points);
  Context context;
  const Overlay overlaid = overlay(pair.a, pair.b, {}, context);
  const RoundingReport& report = overlaid.rounding;
  EXPECT_EQ(support::wrong_with(flat(overlaid)), "");
  EXPECT_LE(report.max_spill, 3 * report.max_move + report.max_snap);
  const Tin result = flat(overlaid);
  Tin a = pair.a;
  for (Point& p : a.vertices) p.z = 0;
  EXPECT_EQ(support::missing_vertices(canonical(a), result), 0u) << "A's vertices never move";

  // Heights at places well inside faces, where 2 * (delta + tau) of play changes nothing that can be seen.
  const double play = 2 * (report.max_move + report.max_snap);
  const support::Sampler of_a(pair.a), of_b(pair.b);
  for (int input : {0, 1}) {
    const Tin tin = lifted(overlaid, input);
    const support::Sampler z(tin);
    const support::Sampler& wanted = input == 0 ? of_a : of_b;
    for (const Point2 p : support::random_places(bounds(tin), 2000, 9)) {
      if (!z.clear_of_edges(p, std::max(1e-3, 1e6 * play)) || !wanted.clear_of_edges(p, std::max(1e-3, 1e6 * play)))
        continue;
      EXPECT_EQ(std::isnan(z(p)), std::isnan(wanted(p)));
      if (!std::isnan(z(p))) {
        EXPECT_NEAR(z(p), wanted(p), 1e-6);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Overlay, NastyPair, ::testing::ValuesIn(cases()), [](const auto& info) {
  std::string name = info.param.name + (info.param.utm ? "_utm" : "");
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace terrane
