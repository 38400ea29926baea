// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/synthesis.hpp"

#include "core/error.hpp"
#include "core/sum.hpp"
#include "core/synthesize.hpp"

namespace terrane {

double longest_edge(const Length& length, const Crs& crs) {
  constexpr double metres_per_degree = 111'700;  // at most: along a meridian near a pole
  if (crs.known() && crs.geographic()) return length.in(1) / metres_per_degree;
  return length.in(crs.known() ? crs.metres_per_length_unit() : 1);
}

void need_parameters(const nlohmann::json& parameters, const std::string& operation,
                     std::initializer_list<const char*> names) {
  std::string missing;
  for (const char* name : names)
    if (!parameters.contains(name) || parameters[name].is_null())
      missing += (missing.empty() ? "" : ", ") + std::string(name);
  if (!missing.empty()) throw Error(ErrorKind::usage, "missing-parameter", "'" + operation + "' needs " + missing);
}

namespace {

/// Of what a ring encloses, by the ring alone.
double enclosed_area(const std::vector<Point2>& ring) {
  Sum twice;
  for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
    const Point2 p = ring[i], q = ring[i + 1], o = ring[0];
    twice.add((p.x - o.x) * (q.y - o.y) - (q.x - o.x) * (p.y - o.y));
  }
  return std::fabs(twice.value()) / 2;
}

}  // namespace

Outcome level_mesh(const std::vector<Point2>& ring, const std::string& what, const Length& z, const Length& max_edge,
                   const Crs& crs, Context& context) {
  if (const auto contact = self_contact(ring, context))
    throw Error(ErrorKind::input, "crosses-itself",
                what + " crosses or touches itself at " + nlohmann::json(contact->at.x).dump() + ", " +
                    nlohmann::json(contact->at.y).dump() + "; move the points around it apart");
  const double height = z.in(crs.known() ? crs.metres_per_height_unit() : 1);
  Outcome outcome;
  outcome.result = level_area(ring, height, longest_edge(max_edge, crs), context);
  outcome.expected_area = enclosed_area(ring);
  outcome.expected_height = [height](const auto&) -> std::optional<HeightRange> { return HeightRange{height, height}; };
  return outcome;
}

}  // namespace terrane
