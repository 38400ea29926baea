// SPDX-License-Identifier: GPL-3.0-or-later
// The polygon pairs on which other overlays failed: JTS's tests and those of Clipper2, triangulated, overlaid, and
// their areas held against GEOS's. The data is not ours to pass on: TERRANE_DATA names the folder that has robust/ in
// it; without it the folder beside the checkout is looked at, and where there is none these tests say so and skip.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>

#include "core/error.hpp"
#include "core/logic.hpp"
#include "core/overlay.hpp"
#include "core/validate.hpp"
#include "core/volume.hpp"
#include "support/oracle.hpp"
#include "support/overlay_judge.hpp"
#include "support/polygons.hpp"

namespace terrane {
namespace {

using support::Polygons;

std::filesystem::path data() {
  const char* given = std::getenv("TERRANE_DATA");
  const std::filesystem::path folder =
      given ? std::filesystem::path(given) : std::filesystem::path(TERRANE_SOURCE_DIR) / ".." / "shared" / "data";
  return folder / "robust";
}

std::string unpacked(const std::filesystem::path& path) {
  std::string text;
  FILE* pipe = popen(("gzip -dc '" + path.string() + "'").c_str(), "r");
  if (!pipe) return text;
  char buffer[65536];
  for (std::size_t n; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) text.append(buffer, n);
  pclose(pipe);
  return text;
}

struct Tally {
  int right = 0, refused = 0, geos_wrong = 0;

  void refuse(const std::string& name, const std::string& reason) {
    ++refused;
    std::printf("%s refused: %s\n", name.c_str(), reason.substr(0, 200).c_str());
  }
};

/// A plane over each, so that heights are judged as well.
Tin surface(const Polygons& polygons, double slope) {
  Tin tin = support::triangulated(polygons.rings());
  for (Point& p : tin.vertices) p.z = slope * (p.x - tin.vertices[0].x) + (p.y - tin.vertices[0].y);
  return tin;
}

/// AND and OR of the two as areas of truth: valid, and of these areas.
void judge_logic(const Tin& a, const Tin& b, double shared, double united, double play) {
  Context context;
  const auto truth = [&](Tin tin) {
    for (Point& p : tin.vertices) p.z = 255;
    return read_binary(tin, {}, context).mesh;
  };
  const ZonedMesh first = truth(a), second = truth(b);
  const auto area = [&](const TruthTable& table) {
    const Tin result =
        lifted(combine(first, second, table, Extent::box, context).mesh, std::vector<double>{0, 255}, context).tin;
    const Inspection seen = inspect(result);
    EXPECT_EQ(seen.inverted + seen.degenerate + seen.t_junctions + seen.non_manifold_edges + seen.overlaps, 0u);
    Tin part{result.vertices, {}};
    for (const Face& f : result.faces)
      if (result.vertices[f[0]].z == 255 && !is_wall(result, f)) part.faces.push_back(f);
    return plan_area(part);
  };
  EXPECT_NEAR(area({is_false, is_false, is_false, is_true}), shared, play);
  EXPECT_NEAR(area({is_false, is_true, is_true, is_true}), united, play);
}

void judge(const std::string& name, Polygons first, Polygons second, Tally& tally) {
  SCOPED_TRACE(name);
  std::optional<Tin> a, b;
  Context context;
  try {
    a = checked(surface(first, 0.5), "a", context), b = checked(surface(second, -0.25), "b", context);
  } catch (const Error& refusal) {
    EXPECT_EQ(refusal.kind, ErrorKind::input);
    return tally.refuse(name, refusal.what());
  }
  if (a->faces.empty() || b->faces.empty()) return tally.refuse(name, "it is empty");
  const auto by_doubles = [](const Tin& tin) {  // what GEOS's sum of products is good to
    const Box box = bounds(tin);
    return 1e-15 * (box.xmax - box.xmin) * (box.ymax - box.ymin) * static_cast<double>(tin.faces.size());
  };
  EXPECT_NEAR(plan_area(*a), first.area(), by_doubles(*a));
  EXPECT_NEAR(plan_area(*b), second.area(), by_doubles(*b));
  try {
    const OverlayOptions options;
    const Overlay overlaid = overlay(*a, *b, options, context);
    if (overlaid.faces.size() < 3000) {  // the judge compares all pairs of faces
      EXPECT_EQ(support::broken_promises(*a, *b, options, overlaid), "");
    }
    double united = 0, shared = 0, perimeter = 0;
    for (std::size_t f = 0; f < overlaid.faces.size(); ++f) {
      const Point2 p = overlaid.points[overlaid.faces[f][0]], q = overlaid.points[overlaid.faces[f][1]],
                   r = overlaid.points[overlaid.faces[f][2]];
      const double area = 0.5 * ((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x));
      united += area;
      if (overlaid.parents[f][0] != none && overlaid.parents[f][1] != none) shared += area;
      perimeter += std::abs(q.x - p.x) + std::abs(q.y - p.y) + std::abs(r.x - p.x) + std::abs(r.y - p.y);
    }
    const double play = 4 * (overlaid.rounding.max_move + overlaid.rounding.max_snap) * perimeter + 1e-11 * united;
    judge_logic(*a, *b, shared, united, play);
    ++tally.right;
    const double by_geos[2] = {first.united_area(second), first.shared_area(second)};
    if (std::abs(united - by_geos[0]) <= play && std::abs(shared - by_geos[1]) <= play) return;
    // One of the two is wrong: the exact arrangement knows which.
    const support::OracleCounts truth = support::oracle_counts(*a, *b);
    EXPECT_NEAR(united, truth.area, play);
    EXPECT_NEAR(shared, truth.overlap_area, play);
    ++tally.geos_wrong;
    std::printf("%s: GEOS says %.17g and %.17g, the exact arrangement %.17g and %.17g\n", name.c_str(), by_geos[0],
                by_geos[1], truth.area, truth.overlap_area);
  } catch (const Error& refusal) {
    EXPECT_EQ(refusal.kind, ErrorKind::input) << refusal.what();
    tally.refuse(name, refusal.what());
  }
}

/// Nothing where GEOS says they are not valid and parity does not make them so.
std::optional<Polygons> made_valid(const Polygons& polygons) {
  const Polygons made = polygons.invalidity().empty() ? polygons : polygons.repaired();
  return made.invalidity().empty() ? std::optional(made) : std::nullopt;
}

class RobustPolygons : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(data()))
      GTEST_SKIP() << "no polygons in " << data() << " (TERRANE_DATA names the folder)";
  }
  Tally tally;
};

TEST_F(RobustPolygons, OfJtsAreRightOrRefused) {
  std::istringstream lines(unpacked(data() / "jts-polygon-pairs.tsv.gz"));
  int pairs = 0;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    std::string name, a, b;
    std::getline(fields, name, '\t'), std::getline(fields, a, '\t'), std::getline(fields, b, '\t');
    ++pairs;
    const Polygons first = Polygons::from_wkt(a), second = Polygons::from_wkt(b);
    // As they came: what is invalid must be refused, or be right by parity where that is defined.
    if (first.invalidity().empty() && second.invalidity().empty()) {
      judge(name, first, second, tally);
      continue;
    }
    const auto valid_first = made_valid(first), valid_second = made_valid(second);
    if (valid_first && valid_second)
      judge(name + " repaired", *valid_first, *valid_second, tally);
    else
      tally.refuse(name, first.invalidity() + " / " + second.invalidity());
  }
  std::printf("%d pairs: %d right (GEOS wrong on %d), %d refused\n", pairs, tally.right, tally.geos_wrong,
              tally.refused);
  EXPECT_EQ(tally.right + tally.refused, pairs);
  EXPECT_GT(tally.right, pairs * 9 / 10);
}

TEST_F(RobustPolygons, OfClipper2AreRightOrRefused) {
  std::istringstream lines(unpacked(data() / "clipper2-polygons.txt.gz"));
  int tasks = 0;
  std::string caption;
  std::vector<std::vector<Point2>> rings[2];
  int group = 0;
  const auto finish = [&] {
    if (caption.empty()) return;
    ++tasks;
    const Polygons raw[2] = {Polygons::from_rings(rings[0]),
                             Polygons::from_rings(rings[1].empty() ? rings[0] : rings[1])};
    const auto first = made_valid(raw[0]), second = made_valid(raw[1]);
    if (first && second)
      judge(caption, *first, *second, tally);
    else
      tally.refuse(caption, raw[0].invalidity() + " / " + raw[1].invalidity());
  };
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("CAPTION")) {
      finish();
      caption = line, rings[0].clear(), rings[1].clear(), group = 0;
    } else if (line.starts_with("SUBJECTS")) {
      group = 0;
    } else if (line.starts_with("CLIPS")) {
      group = 1;
    } else if (!line.empty() && (line[0] == '-' || (line[0] >= '0' && line[0] <= '9'))) {
      std::replace(line.begin(), line.end(), ',', ' ');
      std::istringstream numbers(line);
      std::vector<Point2> ring;
      for (Point2 p; numbers >> p.x >> p.y;) ring.push_back(p);
      rings[group].push_back(std::move(ring));
    }
  }
  finish();
  std::printf("%d tasks: %d right (GEOS wrong on %d), %d refused\n", tasks, tally.right, tally.geos_wrong,
              tally.refused);
  EXPECT_EQ(tally.right + tally.refused, tasks);
  EXPECT_GT(tally.right, tasks * 9 / 10);
}

}  // namespace
}  // namespace terrane
