// SPDX-License-Identifier: GPL-3.0-or-later
#include "soak/judge.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/arithmetic.hpp"
#include "core/error.hpp"
#include "core/validate.hpp"
#include "core/volume.hpp"
#include "support/cells.hpp"
#include "support/merge_judge.hpp"
#include "support/oracle.hpp"
#include "support/overlay_judge.hpp"
#include "support/plan_mesh.hpp"

namespace terrane::soak {
namespace {

double integral_in_plan(const Tin& tin) {
  long double sum = 0;
  for (const Face& f : tin.faces) {
    const Point &a = tin.vertices[f[0]], &b = tin.vertices[f[1]], &c = tin.vertices[f[2]];
    const long double ux = static_cast<long double>(b.x) - a.x, uy = static_cast<long double>(b.y) - a.y;
    const long double vx = static_cast<long double>(c.x) - a.x, vy = static_cast<long double>(c.y) - a.y;
    sum += (ux * vy - uy * vx) / 6 * (static_cast<long double>(a.z) + b.z + c.z);
  }
  return static_cast<double>(sum);
}

/// The difference is a valid surface over the overlap, and its integral is the difference of the integrals.
std::string wrong_with_difference(const Tin& a, const Tin& b, Context& context) {
  const Assembled difference = combine(a, b, -1, Outside::drop, {}, context);
  std::ostringstream wrong;
  wrong.precision(17);
  const bool walls = std::any_of(difference.tin.faces.begin(), difference.tin.faces.end(),
                                 [&](const Face& f) { return is_wall(difference.tin, f); });
  wrong << support::wrong_with_surface(difference.tin, false);
  const RoundingReport& report = difference.rounding;
  const double reach = 3 * report.max_move + 2 * report.max_snap;
  double volume_truth = 0, area = 0, border = 0, highest = 0, measuring = 0;
  for (const support::Cell& cell : support::shared_cells(a, b)) {
    volume_truth += cell.volume, area += cell.area, border += cell.perimeter;
    measuring += 1e-17 * cell.perimeter * cell.perimeter;  // of long doubles
  }
  double outline = 0;  // of the one that snapping moves, over places that the two do not share as well
  for (const Tin* tin : {&a, &b}) {
    const support::PlanMesh mesh = support::plan_mesh(*tin);
    double length = 0;
    for (const auto& [u, v] : support::border_of(mesh.faces))
      length += std::hypot(mesh.points[u].x - mesh.points[v].x, mesh.points[u].y - mesh.points[v].y);
    outline = std::max(outline, length);
  }
  for (const Tin* tin : {&a, &b})
    for (const Point& p : tin->vertices) highest = std::max(highest, std::fabs(p.z));
  double allowed = (2 * reach * border + 2 * report.max_snap * outline + 1e-15 * area + measuring) * highest;
  if (walls) allowed += area * 2e-9 * std::max(1.0, highest);  // welding
  const double found = integral_in_plan(difference.tin);
  if (!(std::fabs(found - volume_truth) <= allowed))
    wrong << "the difference holds " << found << " instead of " << volume_truth << ", off by more than " << allowed
          << "; ";
  const Volume report_of_volume = volume(a, b, 0, {}, context);
  const double net = report_of_volume.fill.volume - report_of_volume.cut.volume;
  if (!(std::fabs(net - volume_truth) <= allowed))
    wrong << "the volume is " << net << " instead of " << volume_truth << ", off by more than " << allowed << "; ";
  return wrong.str();
}

std::string wrong_with_counts(const Tin& a, const Tin& b, const Overlay& overlay) {
  const support::OracleCounts truth = support::oracle_counts(a, b);
  if (static_cast<std::size_t>(overlay.rounding.regions) == truth.regions) return {};
  std::ostringstream wrong;
  wrong << overlay.rounding.regions << " regions instead of " << truth.regions << "; ";
  return wrong.str();
}

}  // namespace

Verdict judge(const Case& made, std::uint64_t seed) {
  Verdict verdict;
  Context context;
  context.threads = made.threads;
  try {
    std::vector<Tin> inputs;
    for (const Tin& tin : made.inputs) inputs.push_back(checked(tin, "input", context));
    if (!context.warnings.empty()) verdict.wrong += "valid input was mended: " + context.warnings[0].message + "; ";
    if (made.merge) {
      verdict.wrong += support::broken_promises(inputs, made.merging, merge(inputs, made.merging, context));
      return verdict;
    }
    const Overlay overlaid = overlay(inputs[0], inputs[1], made.options, context);
    verdict.wrong += support::broken_promises(inputs[0], inputs[1], made.options, overlaid);
    if (seed % 4 == 0) verdict.wrong += wrong_with_difference(inputs[0], inputs[1], context);
    if (seed % 64 == 0 && made.options.refinement == Refinement::full) {
      verdict.counted = true;
      verdict.wrong += wrong_with_counts(inputs[0], support::as_snapped(inputs[0], inputs[1], overlaid), overlaid);
    }
  } catch (const Error& error) {
    (error.kind == ErrorKind::input || error.kind == ErrorKind::limit ? verdict.refused : verdict.wrong) +=
        std::string(error.what()) + "; ";
  } catch (const std::exception& error) {
    verdict.wrong += std::string("exception: ") + error.what() + "; ";
  }
  return verdict;
}

}  // namespace terrane::soak
