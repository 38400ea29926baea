// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/provenance.hpp"

#include <cmath>
#include <memory>
#include <utility>

#include "core/face_grid.hpp"
#include "core/predicates.hpp"
#include "core/triangle_height.hpp"
#include "core/side_by_side.hpp"

namespace terrane {
namespace {

/// Every face counter-clockwise under its own number; those without a place anywhere become one without area.
Tin turned(const Tin& given) {
  Tin tin{{}, given.faces};
  for (const Point& p : given.vertices) {
    const bool finite = std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    tin.vertices.push_back(finite ? p : tin.vertices.empty() ? Point{} : tin.vertices.back());
  }
  const auto count = static_cast<Index>(given.vertices.size());
  for (Face& f : tin.faces) {
    bool placed = true;
    for (const Index v : f) {
      placed = placed && v >= 0 && v < count;
      if (placed) {
        const Point& p = given.vertices[v];
        placed = std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
      }
    }
    if (!placed)
      f = {0, 0, 0};
    else if (orientation(plan(tin.vertices[f[0]]), plan(tin.vertices[f[1]]), plan(tin.vertices[f[2]])) < 0)
      std::swap(f[1], f[2]);
  }
  return tin;
}

/// An input: a level, or a TIN with its faces sorted by place.
struct Located {
  std::optional<double> level;
  Tin tin;
  std::unique_ptr<const FaceGrid> faces;

  double height(Index face, Point2 place) const {
    const Face& f = tin.faces[face];
    const auto corner = [&](int k) { return plan(tin.vertices[f[k]]); };
    const auto z = [&](int k) { return tin.vertices[f[k]].z; };
    return height_on_triangle({corner(0), corner(1), corner(2)}, {z(0), z(1), z(2)}, place);
  }
};

Point2 centroid(const Tin& tin, const Face& f) {
  const Point &a = tin.vertices[f[0]], &b = tin.vertices[f[1]], &c = tin.vertices[f[2]];
  return {a.x + ((b.x - a.x) + (c.x - a.x)) / 3, a.y + ((b.y - a.y) + (c.y - a.y)) / 3};
}

/// The lone one; of several none.
Index lone(const std::vector<std::optional<double>>& z) {
  Index only = none;
  for (Index i = 0; i < static_cast<Index>(z.size()); ++i) {
    if (!z[i]) continue;
    if (only != none) return none;
    only = i;
  }
  return only;
}

/// The choices that decide heights, as they were made.
std::string policy_of(const Plan& plan, const Outcome& outcome) {
  if (!outcome.policy.empty()) return outcome.policy;
  std::string policy = plan.operation->id;
  for (const char* name : {"overlap", "outside"})
    if (const auto it = plan.parameters.find(name); it != plan.parameters.end() && it->is_string())
      policy += std::string(" ") + name + "=" + it->get<std::string>();
  return policy;
}

}  // namespace

Provenance provenance_of(const Plan& plan, const Tin& result, const std::vector<Surface>& surfaces,
                         const Outcome& outcome, Context& context) {
  auto inputs = std::make_shared<std::vector<Located>>(surfaces.size());
  std::vector<double> sizes;
  for (const Surface& s : surfaces) sizes.push_back(s.given ? static_cast<double>(s.given->faces.size()) : 0);
  side_by_side(sizes, context, [&](std::size_t i, Context&) {
    Located& located = (*inputs)[i];
    if (surfaces[i].level() && surfaces[i].word.empty()) located.level = std::get<double>(surfaces[i].value);
    if (!surfaces[i].given || surfaces[i].given->faces.empty()) return;
    located.tin = turned(*surfaces[i].given);
    located.faces = std::make_unique<FaceGrid>(located.tin);
  });
  Provenance made;
  for (const Surface& s : surfaces) made.inputs.push_back(s.name);
  made.policy = policy_of(plan, outcome);
  made.trace = [inputs, &result, decide = outcome.decider ? outcome.decider : Decider(lone)](
                   std::size_t face, std::span<Index> of_inputs) -> Index {
    const Face& f = result.faces[face];
    if (is_wall(result, f)) return none;
    const Point2 place = centroid(result, f);
    thread_local std::vector<std::optional<double>> z;
    z.assign(inputs->size(), std::nullopt);
    bool any = false;
    for (std::size_t i = 0; i < inputs->size(); ++i) {
      const Located& located = (*inputs)[i];
      z[i] = located.level;
      if (!located.faces) continue;
      of_inputs[i] = located.faces->face(place);
      if (of_inputs[i] == none) continue;
      z[i] = located.height(of_inputs[i], place);
      any = true;
    }
    return any ? decide(z) : none;
  };
  return made;
}

}  // namespace terrane
