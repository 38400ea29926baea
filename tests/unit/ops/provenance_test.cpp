// SPDX-License-Identifier: GPL-3.0-or-later
// Which faces a result's faces come from, judged at random places by a search through all faces as they were given.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <string>

#include "core/error.hpp"
#include "ops/operation.hpp"
#include "ops/request.hpp"

using namespace terrane;

namespace {

using Parameters = std::vector<std::pair<std::string, std::string>>;
using Json = nlohmann::json;

/// n x n crooked cells from (x, y), faces in random order, some clockwise, one twice: as files may be.
std::string survey(double x, double y, int n, unsigned seed, double wave) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return static_cast<double>(random() >> 8) * 0x1p-24; };
  Json tin = {{"type", "TIN"}, {"crs", "EPSG:25831"}};
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double u = x + 10 * i + 6 * uniform() - 3, v = y + 10 * j + 6 * uniform() - 3;
      tin["vertices"].push_back(
          {u, v, 10 + wave * std::sin(0.07 * (u - x)) + 4 * std::cos(0.05 * (v - y)) + uniform()});
    }
  std::vector<std::array<int, 3>> faces;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int sw = j * (n + 1) + i, nw = sw + n + 1;
      faces.push_back({sw, sw + 1, nw + 1});
      faces.push_back({sw, nw + 1, nw});
    }
  std::shuffle(faces.begin(), faces.end(), random);
  faces.push_back(faces[faces.size() / 2]);
  for (auto& f : faces)
    if (random() % 4 == 0) std::swap(f[0], f[1]);
  tin["triangles"] = faces;
  return tin.dump();
}

const double X = 500000, Y = 4600000;
const std::string first = survey(X, Y, 12, 1, 5), second = survey(X + 45, Y + 25, 11, 2, -6),
                  third = survey(X + 70, Y - 20, 9, 3, 2);

Response run(const std::string& operation, const std::vector<std::pair<std::string, std::string>>& inputs,
             Parameters parameters, const std::string& format = "json", int threads = 1) {
  Request request;
  request.operation = operation;
  int number = 0;
  for (const auto& [slot, bytes] : inputs)
    request.inputs.push_back(
        {slot, bytes[0] == '{' ? std::string(1, static_cast<char>('a' + number++)) + ".json" : "", "", bytes});
  request.parameters = std::move(parameters);
  request.format = format;
  Context context;
  context.threads = threads;
  return execute(plan(std::move(request)), context);
}

/// The height of a face at a place strictly inside it; none elsewhere.
std::optional<double> height_inside(const Json& tin, std::size_t face, double x, double y) {
  std::array<std::array<double, 3>, 3> p;
  for (int k = 0; k < 3; ++k) p[k] = tin["vertices"][tin["triangles"][face][k].get<std::size_t>()];
  const auto area = [](double ax, double ay, double bx, double by, double cx, double cy) {
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
  };
  const double whole = area(p[0][0], p[0][1], p[1][0], p[1][1], p[2][0], p[2][1]);
  double w[3], z = 0;
  for (int k = 0; k < 3; ++k) {
    const auto &b = p[(k + 1) % 3], &c = p[(k + 2) % 3];
    w[k] = area(x, y, b[0], b[1], c[0], c[1]) / whole;
    if (!(w[k] > 1e-7)) return {};
    z += w[k] * p[k][2];
  }
  return z;
}

/// Judges a result at random places; `explain` is the height that the named ones of the inputs' heights add up to.
template <class Explain>
int judge(const Response& r, const std::vector<std::string>& inputs, Explain explain) {
  const Json result = Json::parse(r.body), &from = result["provenance"];
  EXPECT_EQ(from["faces"].size(), result["triangles"].size());
  EXPECT_EQ(from["decided"].size(), result["triangles"].size());
  std::vector<Json> tins;
  for (const std::string& bytes : inputs) tins.push_back(Json::parse(bytes));
  std::mt19937 random(7);
  // A face of a tile that was pasted may lie on several of another's: only what decides is named for all of it.
  const bool pasted = from["policy"] == "merge overlap=first" || from["policy"] == "merge overlap=last";
  int judged = 0;
  for (int i = 0; i < 1500; ++i) {
    const std::size_t f = random() % result["triangles"].size();
    double w[3], sum = 0, x = 0, y = 0;
    for (double& weight : w) sum += weight = 0.05 + static_cast<double>(random() >> 8) * 0x1p-24;
    for (int k = 0; k < 3; ++k) {
      const auto& v = result["vertices"][result["triangles"][f][k].get<std::size_t>()];
      x += w[k] / sum * v[0].get<double>(), y += w[k] / sum * v[1].get<double>();
    }
    const auto z = height_inside(result, f, x, y);
    if (!z) continue;  // a wall, or a sliver
    std::vector<std::optional<double>> heights(tins.size());
    bool sure = true;
    for (std::size_t t = 0; t < tins.size(); ++t) {
      const Json& named = from["faces"][f][t];
      std::optional<std::size_t> found;
      for (std::size_t g = 0; g < tins[t]["triangles"].size() && !found; ++g)
        if (height_inside(tins[t], g, x, y)) found = g;
      if (!named.is_null()) {
        heights[t] = height_inside(tins[t], named.get<std::size_t>(), x, y);
        if (!heights[t]) sure = false;  // within 1e-7 of an edge
        if (found && (!pasted || from["decided"][f] == t)) {
          EXPECT_EQ(named, *found) << "input " << t << " at " << x << ", " << y;
        }
      } else if (!pasted || from["decided"][f] == t) {
        EXPECT_FALSE(found) << "input " << t << " at " << x << ", " << y;
      }
    }
    if (!sure) continue;
    ++judged;
    const Json& decided = from["decided"][f];
    const auto expected = explain(heights, decided.is_null() ? -1 : decided.get<int>());
    EXPECT_TRUE(expected.has_value()) << decided;
    if (expected) {
      EXPECT_NEAR(*z, *expected, 1e-6);
    }
  }
  return judged;
}

}  // namespace

TEST(Provenance, OfMergesNamesTheTileWhoseHeightHolds) {
  const std::vector<std::string> tiles = {first, second, third};
  for (const char* overlap : {"first", "last", "min", "max", "median"}) {
    const Response r = run("merge", {{"tiles", first}, {"tiles", second}, {"tiles", third}},
                           {{"overlap", overlap}, {"provenance", "true"}}, "json", 2);
    EXPECT_EQ(Json::parse(r.body)["provenance"]["policy"], std::string("merge overlap=") + overlap);
    EXPECT_EQ(Json::parse(r.body)["provenance"]["inputs"], Json({"a.json", "b.json", "c.json"}));
    const int judged = judge(r, tiles, [&](const auto& z, int decided) -> std::optional<double> {
      if (decided >= 0) return z[decided];
      if (std::string(overlap) != "median") return {};
      double sum = 0;
      for (const auto& height : z) sum += height.value_or(0) / 2;
      return sum;  // of two
    });
    EXPECT_GT(judged, 900) << overlap;
  }
}

TEST(Provenance, OfADifferenceIsBothOrTheLoneOne) {
  for (const char* outside : {"drop", "zero"}) {
    const Response r =
        run("subtract", {{"minuend", first}, {"subtrahend", second}}, {{"outside", outside}, {"provenance", "true"}});
    const int judged = judge(r, {first, second}, [&](const auto& z, int decided) -> std::optional<double> {
      EXPECT_EQ(decided, z[0] && z[1] ? -1 : z[0] ? 0 : 1);
      return z[0].value_or(0) - z[1].value_or(0);
    });
    EXPECT_GT(judged, 1000) << outside;
  }
}

TEST(Provenance, OfOneInputItIsThatInput) {
  const Response r =
      run("clip", {{"surface", first}}, {{"bbox", "500020,4600020,500083,4600071"}, {"provenance", "true"}});
  EXPECT_GT(judge(r, {first},
                  [](const auto& z, int decided) {
                    EXPECT_EQ(decided, 0);
                    return z[0];
                  }),
            1000);
}

TEST(Provenance, ALevelMayDecide) {
  const Response r = run("merge", {{"tiles", first}, {"tiles", "11"}}, {{"overlap", "max"}, {"provenance", "true"}});
  const Json tin = Json::parse(r.body), &from = tin["provenance"];
  int level = 0;
  for (std::size_t f = 0; f < tin["triangles"].size(); ++f) {
    EXPECT_TRUE(from["faces"][f][1].is_null());
    bool flat = true;
    for (const auto& v : tin["triangles"][f]) flat = flat && tin["vertices"][v.get<std::size_t>()][2] == 11.0;
    if (from["decided"][f] != 1) continue;
    EXPECT_TRUE(flat);
    ++level;
  }
  EXPECT_GT(level, 10);
}

TEST(Provenance, WallsComeFromNoFace) {
  const Response r = run("merge", {{"tiles", first}, {"tiles", second}}, {{"provenance", "true"}});
  const Json tin = Json::parse(r.body);
  int walls = 0;
  for (std::size_t f = 0; f < tin["triangles"].size(); ++f) {
    std::vector<std::pair<double, double>> p;
    for (const auto& v : tin["triangles"][f]) {
      const auto& at = tin["vertices"][v.get<std::size_t>()];
      p.emplace_back(at[0], at[1]);
    }
    if (p[0] != p[1] && p[1] != p[2] && p[2] != p[0]) continue;
    ++walls;
    EXPECT_EQ(tin["provenance"]["faces"][f], Json({nullptr, nullptr}));
    EXPECT_TRUE(tin["provenance"]["decided"][f].is_null());
  }
  EXPECT_GT(walls, 10);
}

TEST(Provenance, FollowsReprojection) {
  const Response r =
      run("merge", {{"tiles", first}, {"tiles", second}}, {{"target-crs", "EPSG:4326"}, {"provenance", "true"}});
  const Json result = Json::parse(r.body);
  // Numbers are those of the files, wherever the faces went.
  const Response here = run("merge", {{"tiles", first}, {"tiles", second}}, {{"provenance", "true"}});
  const auto count = [](const Json& from) {
    std::vector<int> faces;
    for (const auto& row : from["faces"])
      if (row[0].is_number() && row[1].is_null()) faces.push_back(row[0]);
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    return faces;
  };
  EXPECT_EQ(count(result["provenance"]), count(Json::parse(here.body)["provenance"]));
}

TEST(Provenance, IsTheSameOnAnyThreadsAndIgnoredWhenRead) {
  const std::vector<std::pair<std::string, std::string>> tiles = {{"tiles", first}, {"tiles", second}};
  const Response one = run("merge", tiles, {{"provenance", "true"}}),
                 three = run("merge", tiles, {{"provenance", "true"}}, "json", 3);
  EXPECT_EQ(one.body, three.body);
  const Response without = run("merge", tiles, {});
  EXPECT_EQ(without.body.find("provenance"), std::string::npos);
  EXPECT_EQ(without.report, one.report);
  EXPECT_EQ(run("convert", {{"surface", one.body}}, {}, "ply").body,
            run("convert", {{"surface", without.body}}, {}, "ply").body);
}

TEST(Provenance, HasAPlaceInTerraneJsonAlone) {
  const auto refusal = [](const std::string& operation, const std::string& slot, const std::string& format) {
    try {
      run(operation, {{slot, first}}, {{"provenance", "true"}}, format);
    } catch (const Error& error) {
      return error.kind;
    }
    return ErrorKind::internal;
  };
  EXPECT_EQ(refusal("merge", "tiles", "obj"), ErrorKind::usage);
  EXPECT_EQ(refusal("validate", "surface", "json"), ErrorKind::usage);
  EXPECT_EQ(refusal("info", "surface", "json"), ErrorKind::usage);
  EXPECT_EQ(refusal("contour", "surface", "geojson"), ErrorKind::usage);
}
