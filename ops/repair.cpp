// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/repair.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/error.hpp"
#include "core/merge.hpp"
#include "core/predicates.hpp"
#include "core/topology.hpp"
#include "core/validate.hpp"

namespace terrane {
namespace {

std::size_t drop_unusable_faces(Tin& tin) {
  const auto usable = [&](const Face& f) {
    return std::all_of(f.begin(), f.end(), [&](Index v) {
      if (v < 0 || v >= static_cast<Index>(tin.vertices.size())) return false;
      const Point& p = tin.vertices[v];
      return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    });
  };
  const std::size_t before = tin.faces.size();
  std::erase_if(tin.faces, [&](const Face& f) { return !usable(f); });
  for (Point& p : tin.vertices)
    if (!std::isfinite(p.x + p.y + p.z)) p = tin.faces.empty() ? Point{} : tin.vertices[tin.faces[0][0]];  // unused now
  return before - tin.faces.size();
}

std::optional<Tin> sound(const Tin& tin, const std::string& name) {
  Context quiet;
  try {
    return checked(tin, name, quiet);
  } catch (const Error& error) {
    if (error.kind != ErrorKind::input) throw;
    return {};
  }
}

/// Lays faces into sheets: pieces joined over shared edges stay together as long as they are sound; a piece that is not is
/// halved along its own order until its parts are.
void lay(const Tin& tin, const std::vector<Index>& faces, const std::string& name, std::vector<Tin>& sheets, Context& context) {
  context.progress("repair", 0.5);
  Tin piece{tin.vertices, {}};
  for (Index f : faces) piece.faces.push_back(tin.faces[f]);
  piece = canonical(piece);  // drops the vertices of the others
  if (auto good = sound(piece, name)) {
    if (!good->faces.empty()) sheets.push_back(std::move(*good));
    return;
  }
  if (faces.size() < 2) return;
  const std::size_t half = faces.size() / 2;
  lay(tin, {faces.begin(), faces.begin() + half}, name, sheets, context);
  lay(tin, {faces.begin() + half, faces.end()}, name, sheets, context);
}

/// Faces in the order of a walk over shared edges, so that halves hang together.
std::vector<Index> walk_order(const Tin& tin) {
  const PlanTopology topology = plan_topology(tin);
  std::vector<Index> order;
  std::vector<bool> seen(tin.faces.size());
  for (Index start = 0; start < static_cast<Index>(tin.faces.size()); ++start) {
    if (seen[start] || !topology.in_plan(start)) continue;
    seen[start] = true;
    order.push_back(start);
    for (std::size_t next = order.size() - 1; next < order.size(); ++next)
      for (int k = 0; k < 3; ++k) {
        const Index mate = topology.mate[3 * order[next] + k];
        if (mate >= 0 && !seen[mate / 3]) seen[mate / 3] = true, order.push_back(mate / 3);
      }
  }
  return order;
}

}  // namespace

Repaired repair(Tin tin, const std::string& name, Context& context) {
  Repaired result;
  const std::size_t before = tin.faces.size(), dropped = drop_unusable_faces(tin);
  Mending mended;
  std::size_t sheets_count = 1;
  if (auto good = sound(tin, name)) {
    result.tin = checked(std::move(tin), name, context, &mended);
  } else {
    std::vector<Tin> sheets;
    lay(tin, walk_order(tin), name, sheets, context);
    sheets_count = sheets.size();
    if (!sheets.empty()) result.tin = merge(sheets, {Overlap::first, {Seam::wall, 0}}, context).surface.tin;
  }
  if (result.tin.faces.empty() && before > 0)
    throw Error(ErrorKind::input, "nothing-left", "input '" + name + "' has no face that could be kept");
  result.changes = {{"faces_before", before},
                    {"faces_after", result.tin.faces.size()},
                    {"unusable_faces", dropped},
                    {"sheets_merged", sheets_count > 1 ? sheets_count : 0},
                    {"duplicate_vertices", mended.duplicate_vertices},
                    {"duplicate_faces", mended.duplicate_faces},
                    {"unused_vertices", mended.unused_vertices},
                    {"zero_area_faces", mended.zero_area_faces},
                    {"clockwise_faces", mended.clockwise_faces},
                    {"t_junctions", mended.t_junctions}};
  return result;
}

}  // namespace terrane
