// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/repair.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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

void add(Mending& sum, const Mending& part) {
  sum.duplicate_vertices += part.duplicate_vertices;
  sum.duplicate_faces += part.duplicate_faces;
  sum.unused_vertices += part.unused_vertices;
  sum.zero_area_faces += part.zero_area_faces;
  sum.clockwise_faces += part.clockwise_faces;
  sum.t_junctions += part.t_junctions;
}

std::optional<Tin> sound(const Tin& tin, const std::string& name, Mending& mended) {
  Context quiet;
  try {
    Mending part;
    Tin good = checked(tin, name, quiet, &part);
    add(mended, part);
    return good;
  } catch (const Error& error) {
    if (error.kind != ErrorKind::input) throw;
    return {};
  }
}

/// Vertices of other sheets: they are no defect of this one.
void drop_unused_vertices(Tin& tin) {
  std::vector<Index> number(tin.vertices.size(), none);
  std::vector<Point> kept;
  for (Face& f : tin.faces)
    for (Index& v : f) {
      if (number[v] == none) number[v] = static_cast<Index>(kept.size()), kept.push_back(tin.vertices[v]);
      v = number[v];
    }
  tin.vertices = std::move(kept);
}

/// A sheet whose faces do not overlap may still have two heights at a place, or a wall that three faces share: it is
/// halved
/// along its order until its parts are sound.
void lay(const Tin& tin, const std::vector<Index>& faces, const std::string& name, std::vector<Tin>& sheets,
         Mending& mended, Context& context) {
  context.progress("repair", 0.5);
  Tin piece{tin.vertices, {}};
  for (Index f : faces) piece.faces.push_back(tin.faces[f]);
  drop_unused_vertices(piece);
  if (auto good = sound(piece, name, mended)) {
    if (!good->faces.empty()) sheets.push_back(std::move(*good));
    return;
  }
  if (faces.size() < 2) return;
  const std::size_t half = faces.size() / 2;
  lay(tin, {faces.begin(), faces.begin() + half}, name, sheets, mended, context);
  lay(tin, {faces.begin() + half, faces.end()}, name, sheets, mended, context);
}

/// Whether two triangles share area in plan: no edge of one has the whole other on its outer side. Exact.
bool overlap(const std::array<Point2, 3>& s, const std::array<Point2, 3>& t) {
  const auto separates = [](const std::array<Point2, 3>& u, const std::array<Point2, 3>& v) {
    const int way = orientation(u[0], u[1], u[2]);
    for (int k = 0; k < 3; ++k)
      if (std::all_of(v.begin(), v.end(), [&](Point2 p) { return way * orientation(u[k], u[(k + 1) % 3], p) <= 0; }))
        return true;
    return false;
  };
  return !separates(s, t) && !separates(t, s);
}

/// Faces laid into sheets one by one, each into the first where it overlaps nothing.
class Sheets {
 public:
  Sheets(const Tin& tin, const std::vector<Index>& order) : tin_(tin), box_(bounds(tin)) {
    side_ = std::max(1, static_cast<int>(std::sqrt(order.size() / 2.0)));
    for (Index f : order) lay(f);
  }
  const std::vector<std::vector<Index>>& faces() const { return faces_; }

 private:
  std::array<Point2, 3> triangle(Index f) const {
    return {plan(tin_.vertices[tin_.faces[f][0]]), plan(tin_.vertices[tin_.faces[f][1]]),
            plan(tin_.vertices[tin_.faces[f][2]])};
  }
  template <class Visit>
  void cells(const std::array<Point2, 3>& t, Visit visit) const {
    const auto cell = [&](double value, double low, double high) {
      return high > low ? std::clamp(static_cast<int>((value - low) / (high - low) * side_), 0, side_ - 1) : 0;
    };
    const auto [xlow, xhigh] = std::minmax({t[0].x, t[1].x, t[2].x});
    const auto [ylow, yhigh] = std::minmax({t[0].y, t[1].y, t[2].y});
    for (int r = cell(ylow, box_.ymin, box_.ymax); r <= cell(yhigh, box_.ymin, box_.ymax); ++r)
      for (int c = cell(xlow, box_.xmin, box_.xmax); c <= cell(xhigh, box_.xmin, box_.xmax); ++c)
        visit(static_cast<std::size_t>(r) * side_ + c);
  }
  void lay(Index f) {
    const auto t = triangle(f);
    for (std::size_t sheet = 0;; ++sheet) {
      if (sheet == faces_.size()) {
        faces_.emplace_back();
        buckets_.emplace_back(static_cast<std::size_t>(side_) * side_);
      }
      bool taken = false;
      cells(t, [&](std::size_t cell) {
        const auto& bucket = buckets_[sheet][cell];
        taken = taken || std::any_of(bucket.begin(), bucket.end(), [&](Index g) { return overlap(t, triangle(g)); });
      });
      // After that many sheets a heap of faces is not worth sorting out: the lower ones are hidden anyway.
      if (taken && sheet >= 64) return;
      if (taken) continue;
      faces_[sheet].push_back(f);
      cells(t, [&](std::size_t cell) { buckets_[sheet][cell].push_back(f); });
      return;
    }
  }

  const Tin& tin_;
  Box box_;
  int side_ = 1;
  std::vector<std::vector<Index>> faces_;
  std::vector<std::vector<std::vector<Index>>> buckets_;
};

/// Faces in the order of a walk over shared edges, so that halves hang together.
std::vector<Index> walk_order(const Tin& tin, const PlanTopology& topology) {
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

/// Counts what no sheet takes up: faces without area, and vertices of no face.
void count_left_out(const Tin& tin, const PlanTopology& topology, Mending& mended) {
  std::vector<bool> used(tin.vertices.size(), false);
  for (const Face& face : tin.faces)
    for (const Index v : face) used[v] = true;
  mended.unused_vertices += std::count(used.begin(), used.end(), false);
  mended.zero_area_faces += std::count(topology.turn.begin(), topology.turn.end(), Turn::flat);
}

}  // namespace

Repaired repair(Tin tin, const std::string& name, Context& context) {
  Repaired result;
  const std::size_t before = tin.faces.size(), dropped = drop_unusable_faces(tin);
  Mending mended;
  std::size_t sheets_count = 1;
  if (auto good = sound(tin, name, mended)) {
    result.tin = std::move(*good);
  } else {
    std::vector<Tin> sheets;
    const PlanTopology topology = plan_topology(tin);
    count_left_out(tin, topology, mended);
    const Sheets laid(tin, walk_order(tin, topology));
    for (const auto& faces : laid.faces()) lay(tin, faces, name, sheets, mended, context);
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
