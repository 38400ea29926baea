// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/inputs.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/error.hpp"
#include "core/validate.hpp"
#include "ops/measure.hpp"

namespace terrane {
namespace {

/// The least distance between vertices of the two, on a sample of at most 3000 each: an upper bound good enough to say.
double apart(const Surface& a, const Surface& b) {
  const auto &va = a.tin().vertices, &vb = b.tin().vertices;
  const std::size_t step_a = std::max<std::size_t>(1, va.size() / 3000),
                    step_b = std::max<std::size_t>(1, vb.size() / 3000);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < va.size(); i += step_a)
    for (std::size_t j = 0; j < vb.size(); j += step_b)
      least = std::min(least, distance(plan(va[i]), plan(vb[j]), a.crs));
  return least;
}

std::string no_overlap(const Surface& a, const Surface& b) {
  std::string message = "'" + a.name + "' and '" + b.name + "' do not overlap";
  if (a.level() || b.level() || a.tin().vertices.empty() || b.tin().vertices.empty()) return message;
  char text[64];
  const bool degrees = a.crs.known() && a.crs.geographic();
  const double gap = apart(a, b);
  std::snprintf(text, sizeof text, gap < 1000 ? "%.4g %s" : "%.0f %s", gap,
                degrees || !a.crs.known() ? "m" : a.crs.length_unit().c_str());
  if (gap == 0) return message + ": they only touch";
  return message + ": they are about " + text + " apart";
}

double mean_height(const Tin& tin) {
  double sum = 0;
  for (const Point& p : tin.vertices) sum += p.z;
  return tin.vertices.empty() ? 0 : sum / tin.vertices.size();
}

}  // namespace

Surface* find_input(std::vector<Surface>& inputs, std::string_view slot) {
  const auto it = std::find_if(inputs.begin(), inputs.end(), [&](const Surface& s) { return s.slot == slot; });
  return it == inputs.end() ? nullptr : &*it;
}

Surface& input(std::vector<Surface>& inputs, std::string_view slot) {
  Surface* found = find_input(inputs, slot);
  if (!found) throw Error(ErrorKind::usage, "missing-input", "the input '" + std::string(slot) + "' is missing");
  return *found;
}

void refuse_no_overlap(const Surface& a, const Surface& b, const std::string& remedy) {
  throw Error(ErrorKind::input, "no-overlap", no_overlap(a, b) + "; check their CRSs, or say " + remedy);
}

void warn_no_overlap(const Surface& a, const Surface& b, Context& context) {
  context.warn({"no-overlap", "", "", no_overlap(a, b) + "; the result is empty", "check their CRSs"});
}

Tin with_heights(Tin tin, double scale, double raise, const std::string& name, const std::string& doing) {
  for (std::size_t v = 0; v < tin.vertices.size(); ++v) {
    double& z = tin.vertices[v].z;
    const double before = z;
    z = z * scale + raise;
    if (!(std::fabs(z) <= largest_coordinate))
      throw Error(ErrorKind::input, "overflow",
                  "the height of vertex " + std::to_string(v) + " of '" + name + "', " + nlohmann::json(before).dump() +
                      ", gets too large with " + doing + ": heights up to 1e100 can be computed with");
  }
  return tin;
}

void warn_feet_beside_metres(const Surface& a, const Surface& b, Context& context) {
  if (a.level() || b.level()) return;
  const double za = std::fabs(mean_height(a.tin())), zb = std::fabs(mean_height(b.tin()));
  if (std::min(za, zb) < 50) return;
  const double ratio = std::max(za, zb) / std::min(za, zb);
  if (std::fabs(ratio - 1 / 0.3048) > 0.03) return;
  const Surface& feet = za > zb ? a : b;
  context.warn({"feet-beside-metres", feet.name, "",
                "the heights of '" + feet.name + "' are on average 3.28 times those of '" + (za > zb ? b : a).name +
                    "': perhaps they are in feet",
                "scale them with 'transform' and z-scale=0.3048"});
}

}  // namespace terrane
