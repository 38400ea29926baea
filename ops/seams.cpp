// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/seams.hpp"

#include <algorithm>
#include <cmath>

#include "core/topology.hpp"
#include "ops/measure.hpp"

namespace terrane {

namespace {

const char* kind(const SeamPair& pair) { return pair.overlap ? "overlap" : "border"; }

}  // namespace

Vectors seam_lines(const Merged& merged, const std::vector<std::string>& names, const Crs& crs) {
  Vectors lines;
  lines.crs = crs;
  auto pair = merged.seams.begin();
  for (const SeamJump& jump : merged.jumps) {  // in the order of their pairs
    while (pair->a != jump.a || pair->b != jump.b) ++pair;
    Feature feature;
    feature.properties = {{"a", names.at(jump.a)},
                          {"b", names.at(jump.b)},
                          {"kind", kind(*pair)},
                          {"jump_start", jump.dp + 0.0},  // no -0
                          {"jump_end", jump.dq + 0.0},
                          {"max_abs", std::max(std::fabs(jump.dp), std::fabs(jump.dq))},
                          {"length", distance(jump.p, jump.q, crs)}};
    feature.lines.push_back({{jump.p.x, jump.p.y, NAN}, {jump.q.x, jump.q.y, NAN}});
    lines.features.push_back(std::move(feature));
  }
  return lines;
}

nlohmann::json seam_report(const std::vector<SeamPair>& pairs, const std::vector<std::string>& names) {
  nlohmann::json list = nlohmann::json::array();
  for (const SeamPair& p : pairs) {
    nlohmann::json overlap;
    if (p.overlap)
      overlap = {{"area_2d", p.overlap_area_2d}, {"dz_mean", p.dz_mean}, {"dz_median", p.dz_median},
                 {"dz_rmse", p.dz_rmse},         {"dz_nmad", p.dz_nmad}, {"dz_p95_abs", p.dz_p95_abs}};
    list.push_back({{"a", names.at(p.a)},
                    {"b", names.at(p.b)},
                    {"kind", kind(p)},
                    {"overlap", overlap},
                    {"jump",
                     {{"count", p.jump_count},
                      {"length_2d", p.jump_length_2d},
                      {"max_abs", p.jump_max_abs},
                      {"max_at", {p.jump_max_at.x, p.jump_max_at.y}},
                      {"mean_abs", p.jump_mean_abs},
                      {"rmse", p.jump_rmse}}},
                    {"bias_suspected", p.bias_suspected},
                    {"wall_area", p.wall_area}});
  }
  return {{"dz", "b - a"}, {"pairs", list}};
}

void measure_jumps(const Tin& result, const PlanMetric& metric, SeamPair& pair) {
  const PlanTopology topology = plan_topology(result);
  double length = 0, sum = 0, squares = 0;
  pair.jump_count = 0;
  pair.jump_max_abs = 0;
  for (Index h = 0; h < static_cast<Index>(topology.mate.size()); ++h) {
    const Index mate = topology.mate[h];
    if (mate < h) continue;  // each edge once, none without a mate
    const Point &a = result.vertices[topology.from(result, h)], &b = result.vertices[topology.to(result, h)];
    const double ja = std::fabs(a.z - result.vertices[topology.to(result, mate)].z);
    const double jb = std::fabs(b.z - result.vertices[topology.from(result, mate)].z);
    if (ja == 0 && jb == 0) continue;
    // Jumps are linear along an edge and do not change sign on it.
    const double part = metric.distance(plan(a), plan(b));
    length += part;
    sum += part * (ja + jb) / 2;
    squares += part * (ja * ja + ja * jb + jb * jb) / 3;
    ++pair.jump_count;
    if (std::max(ja, jb) > pair.jump_max_abs) {
      pair.jump_max_abs = std::max(ja, jb);
      pair.jump_max_at = ja > jb ? plan(a) : plan(b);
    }
  }
  pair.jump_length_2d = length;
  pair.jump_mean_abs = length > 0 ? sum / length : 0;
  pair.jump_rmse = length > 0 ? std::sqrt(squares / length) : 0;
}

}  // namespace terrane
