// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay/overlay_faces.hpp"

#include <algorithm>
#include <iterator>
#include <span>

#include "core/error.hpp"
#include "core/overlay/region_tracer.hpp"
#include "core/parallel.hpp"
#include "core/plan/region_fill.hpp"

namespace terrane {
namespace {

/// Puts together and triangulates what ghost edges cut up.
class GroupFiller {
 public:
  GroupFiller(const Arrangement& arrangement, Refinement refinement, bool exactly, Traced& sink)
      : arrangement_(arrangement),
        groups_(arrangement, refinement),
        exactly_(exactly),
        sink_(sink),
        tracer_(arrangement, refinement, {}, sink) {}

  /// Pieces sorted by group. Sets `exterior` to where its faces begin.
  void run(std::span<const GroupedPiece> grouped, std::size_t& exterior) {
    exterior = sink_.count;
    for (std::size_t i = 0; i < grouped.size();) {
      std::size_t j = i;
      const Index group = grouped[i].group;
      bool only[2] = {true, true};
      for (; j < grouped.size() && grouped[j].group == group; ++j) only[1 - grouped[j].piece.mesh] = false;
      const auto [a, b] = groups_.parents(group);
      if (group == groups_.exterior) exterior = sink_.count;
      if (a != none && only[0])
        tracer_.whole(0, a, {a, b});
      else if (b != none && only[1] && !groups_.outline)
        tracer_.whole(1, b, {a, b});
      else
        fill(group, grouped.subspan(i, j - i));
      i = j;
    }
  }

 private:
  /// A region with any border: pieces are joined over vertices that do not stay, then filled.
  void fill(Index group, std::span<const GroupedPiece> pieces) {
    border_.clear();
    for (const GroupedPiece& g : pieces) {
      LinePiece p = g.piece;
      const Index from = arrangement_.vertex(p.mesh, p.tail());
      if (from == none) continue;
      Index to;
      while ((to = arrangement_.vertex(p.mesh, p.head())) == none) p.at += p.direction == 0 ? 1 : -1;
      border_.push_back({from, to});
    }
    FilledRegion filled;
    if (!exactly_) filled = fill_region(arrangement_.points, border_);
    if (!filled.sound)
      filled = fill_region_exactly(
          arrangement_.points, [&](Index v) { return exact_place(arrangement_, v); }, border_);
    if (!filled.sound) throw Error(ErrorKind::internal, "overlay", "a region's border does not close");
    if (group != groups_.exterior) sink_.regions += filled.parts;
    const auto& at = arrangement_.points;
    sink_.make_room(filled.faces.size());
    for (const Face& f : filled.faces) {
      sink_.add(f, groups_.parents(group));
      sink_.all_positive = sink_.all_positive && orientation(at[f[0]], at[f[1]], at[f[2]]) > 0;
    }
  }

  const Arrangement& arrangement_;
  Groups groups_;
  bool exactly_;
  Traced& sink_;
  RegionTracer tracer_;
  std::vector<BorderEdge> border_;
};

/// Every face of A, then every face of B, in ranges.
Traced trace_all(const Arrangement& arrangement, Refinement refinement, Context& context) {
  const std::size_t count[2] = {static_cast<std::size_t>(arrangement.mesh[0]->faces()),
                                static_cast<std::size_t>(arrangement.mesh[1]->faces())};
  const std::size_t chunk[2] = {chunk_for(context, count[0]), chunk_for(context, count[1])};
  const std::size_t ranges[2] = {(count[0] - 1) / chunk[0] + 1, (count[1] - 1) / chunk[1] + 1};
  const bool alone = ranges[0] + ranges[1] == 2;  // then both ranges, one after the other, share a sink
  Array<std::uint8_t> visited(2 * arrangement.lines[0].nodes.size(), 0);
  std::vector<Traced> sinks(alone ? 1 : ranges[0] + ranges[1]);
  // What general position gives; memory that is never touched costs nothing.
  const std::size_t expected = 2 * static_cast<std::size_t>(arrangement.first_corner) + 64;
  for (int m = 0; m < 2; ++m)
    parallel_for(context, count[m], chunk[m], [&](std::size_t begin, std::size_t end) {
      Traced& place = sinks[alone ? 0 : m * ranges[0] + begin / chunk[m]];
      Traced sink = std::move(place);  // on this thread's own cache lines while it grows
      if (m == 0) sink.resize(begin == 0 ? expected : expected / ranges[0]);
      RegionTracer tracer(arrangement, refinement, visited, sink);
      for (std::size_t f = begin; f < end; ++f) {
        if ((f & 0xFFFF) == 0) context.stop_if_cancelled();
        if (m == 0)
          tracer.face_of_a(static_cast<Index>(f));
        else
          tracer.face_of_b(static_cast<Index>(f));
      }
      place = std::move(sink);
    });
  Traced& all = sinks[0];
  std::vector<std::size_t> offset{0};
  for (const Traced& sink : sinks) {
    offset.push_back(offset.back() + sink.count);
    if (&sink == &all) continue;
    all.grouped.insert(all.grouped.end(), sink.grouped.begin(), sink.grouped.end());
    all.regions += sink.regions;
    all.all_positive = all.all_positive && sink.all_positive;
  }
  all.count = offset.back();
  if (all.count > all.faces.size()) all.trim();
  parallel_tasks(context, 2 * (sinks.size() - 1), [&](std::size_t i) {
    const std::size_t s = i / 2 + 1;
    const auto at = static_cast<std::ptrdiff_t>(offset[s]);
    if (i % 2 == 0)
      std::copy_n(sinks[s].faces.begin(), sinks[s].count, all.faces.begin() + at);
    else
      std::copy_n(sinks[s].parents.begin(), sinks[s].count, all.parents.begin() + at);
  });
  return std::move(all);
}

}  // namespace

OverlayFaces faces_of(const Arrangement& arrangement, Refinement refinement, Context& context) {
  Traced sink = trace_all(arrangement, refinement, context);
  context.progress("overlay", 0.75);
  std::stable_sort(sink.grouped.begin(), sink.grouped.end(), [](auto& s, auto& t) { return s.group < t.group; });
  const std::vector<GroupedPiece> grouped = std::move(sink.grouped);
  const std::size_t plain = sink.count;
  const Index plain_regions = sink.regions;
  std::size_t exterior;
  GroupFiller(arrangement, refinement, false, sink).run(grouped, exterior);
  if (!sink.all_positive) {
    sink.count = plain;
    sink.regions = plain_regions;
    GroupFiller(arrangement, refinement, true, sink).run(grouped, exterior);
  }
  sink.trim();
  context.progress("overlay", 0.8);
  return {std::move(sink.faces), std::move(sink.parents), exterior, sink.regions, sink.all_positive};
}

}  // namespace terrane
