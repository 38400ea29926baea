// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay/overlay_faces.hpp"

#include <algorithm>
#include <numeric>
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

/// Where the faces of each range of A may begin, and where those of the last may end: regions that touch the border of
/// a face of A are triangles between its corners, what lies on its edges, and the places of B inside it.
std::vector<std::size_t> room_for_a(const Arrangement& arrangement, std::size_t chunk, const Context& context) {
  const CompletedMesh& a = *arrangement.mesh[0];
  const std::size_t faces = static_cast<std::size_t>(a.faces());
  if (chunk >= faces) return {0, 2 * arrangement.points.size()};  // a plane mesh has fewer than two faces per vertex
  std::vector<std::size_t> room((faces - 1) / chunk + 2, 0);
  for (const Location& where : arrangement.location[1])
    if (where.kind == Location::face) room[static_cast<std::size_t>(where.index) / chunk + 1] += 2;
  parallel_for(context, faces, chunk, [&](std::size_t begin, std::size_t end) {
    std::size_t pieces = 0;
    for (Index f = static_cast<Index>(begin); f < static_cast<Index>(end); ++f)
      for (Index k = 0; k < 3; ++k)
        pieces += static_cast<std::size_t>(arrangement.lines[0].pieces(a.edge_of(4 * f + k)));
    room[begin / chunk + 1] += pieces - 2 * (end - begin);
  });
  std::partial_sum(room.begin(), room.end(), room.begin());
  return room;
}

/// Traces every face of A, then every face of B, in ranges, each into a place of its own in two arrays.
class RangeTracer {
 public:
  RangeTracer(const Arrangement& arrangement, Refinement refinement, OverlayFaces& out, Context& context)
      : arrangement_(arrangement),
        refinement_(refinement),
        context_(context),
        visited_(2 * arrangement.lines[0].nodes.size(), 0) {
    for (int m = 0; m < 2; ++m) {
      count_[m] = static_cast<std::size_t>(arrangement.mesh[m]->faces());
      chunk_[m] = chunk_for(context, count_[m]);
    }
    room_for_a_ = room_for_a(arrangement, chunk_[0], context);
    // What touches no border of A is whole faces of B; what is put together later is faces of a plane mesh, too.
    all_.room = std::max(room_for_a_.back(), 2 * arrangement.points.size()) + count_[1];
    out.faces.resize(all_.room);  // memory that is never touched costs nothing
    out.parents.resize(all_.room);
    all_.faces = out.faces.data();
    all_.parents = out.parents.data();
  }

  Traced traced() {
    for (int m = 0; m < 2; ++m) trace_mesh(m);
    return std::move(all_);
  }

 private:
  void trace_mesh(int m) {
    const std::size_t count = count_[m], chunk = chunk_[m], first = all_.count;
    std::vector<Traced> ranges((count - 1) / chunk + 1);
    const auto begin_of = [&](std::size_t r) { return m == 0 ? room_for_a_[r] : first + std::min(count, r * chunk); };
    for (std::size_t r = 0; r < ranges.size(); ++r) {
      ranges[r].faces = all_.faces + begin_of(r);
      ranges[r].parents = all_.parents + begin_of(r);
      ranges[r].room = begin_of(r + 1) - begin_of(r);
    }
    parallel_for(context_, count, chunk, [&](std::size_t begin, std::size_t end) {
      Traced range = std::move(ranges[begin / chunk]);  // on this thread's own cache lines while it grows
      RegionTracer tracer(arrangement_, refinement_, visited_, range);
      for (std::size_t f = begin; f < end; ++f) {
        if ((f & 0xFFFF) == 0) context_.stop_if_cancelled();
        if (m == 0)
          tracer.face_of_a(static_cast<Index>(f));
        else
          tracer.face_of_b(static_cast<Index>(f));
      }
      ranges[begin / chunk] = std::move(range);
    });
    for (const Traced& range : ranges) append(range);
  }

  /// The range's faces close up to those before.
  void append(const Traced& range) {
    parallel_tasks(context_, all_.faces + all_.count == range.faces ? 0 : 2, [&](std::size_t i) {
      if (i == 0)
        std::copy_n(range.faces, range.count, all_.faces + all_.count);
      else
        std::copy_n(range.parents, range.count, all_.parents + all_.count);
    });
    all_.count += range.count;
    all_.grouped.insert(all_.grouped.end(), range.grouped.begin(), range.grouped.end());
    all_.regions += range.regions;
    all_.all_positive = all_.all_positive && range.all_positive;
  }

  const Arrangement& arrangement_;
  Refinement refinement_;
  Context& context_;
  std::size_t count_[2], chunk_[2];
  std::vector<std::size_t> room_for_a_;
  Array<std::uint8_t> visited_;
  Traced all_;
};

}  // namespace

OverlayFaces faces_of(const Arrangement& arrangement, Refinement refinement, Context& context) {
  OverlayFaces out;
  Traced sink = RangeTracer(arrangement, refinement, out, context).traced();
  context.progress("overlay", 0.75);
  std::stable_sort(sink.grouped.begin(), sink.grouped.end(), [](auto& s, auto& t) { return s.group < t.group; });
  const std::vector<GroupedPiece> grouped = std::move(sink.grouped);
  const std::size_t plain = sink.count;
  const Index plain_regions = sink.regions;
  GroupFiller(arrangement, refinement, false, sink).run(grouped, out.exterior);
  if (!sink.all_positive) {
    sink.count = plain;
    sink.regions = plain_regions;
    GroupFiller(arrangement, refinement, true, sink).run(grouped, out.exterior);
  }
  out.faces.resize(sink.count);
  out.parents.resize(sink.count);
  out.regions = sink.regions;
  out.all_positive = sink.all_positive;
  context.progress("overlay", 0.8);
  return out;
}

}  // namespace terrane
