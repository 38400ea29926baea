// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay/completed.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/error.hpp"
#include "core/mesh/pages.hpp"
#include "core/parallel.hpp"
#include "core/plan/region_fill.hpp"
#include "core/predicates.hpp"
#include "core/triangle_height.hpp"

namespace terrane {
namespace {

/// Equal places of a canonical TIN are neighbours; of any other they are found by hashing.
enum class Search { neighbours, everywhere };

/// Gives each vertex the number of its place: equal x and y share one. `used`: empty, or which vertices to look at.
std::vector<Index> number_places(const Tin& tin, const std::vector<Point2>* moved, const std::vector<bool>& used,
                                 Search search, CompletedMesh& mesh) {
  const std::size_t n = tin.vertices.size();
  std::vector<Index> place_of(n, none);
  mesh.places.reserve(n + 4);
  mesh.z.reserve(n + 4);
  const std::size_t slots = search == Search::everywhere ? std::bit_ceil(2 * n + 16) : 0;
  std::vector<Index> table(slots, none);  // open addressing over the bit patterns
  for (std::size_t v = 0; v < n; ++v) {
    if (!used.empty() && !used[v]) continue;
    Point2 p = moved ? (*moved)[v] : plan(tin.vertices[v]);
    p.x += 0.0, p.y += 0.0;  // -0 and 0 are one place
    const Index next = static_cast<Index>(mesh.places.size());
    Index place = next;
    if (search == Search::neighbours) {
      if (next > 0 && mesh.places.back() == p) place = next - 1;
    } else {
      const auto hx = std::bit_cast<std::uint64_t>(p.x), hy = std::bit_cast<std::uint64_t>(p.y);
      std::uint64_t key = (hx * 0x9E3779B97F4A7C15ull) ^ std::rotl(hy * 0xC2B2AE3D27D4EB4Full, 31);
      key *= 0x9E3779B97F4A7C15ull;
      std::size_t slot = (key >> 20) & (slots - 1);
      while (table[slot] != none && !(mesh.places[table[slot]] == p)) slot = (slot + 1) & (slots - 1);
      if (table[slot] == none) table[slot] = next;
      place = table[slot];
    }
    place_of[v] = place;
    if (place == next) {
      mesh.places.push_back(p);
      mesh.z.push_back(tin.vertices[v].z);
    } else if (mesh.z[place] != tin.vertices[v].z) {
      mesh.jumps = true;
    }
  }
  return place_of;
}

/// The edge of half-edge h and its twin t (none on the box). Which of the two defines it is read off coordinates, so
/// that what is computed along it does not depend on the order of the faces.
void add_edge(CompletedMesh& mesh, Index h, Index t, std::uint8_t sides) {
  const Point2 from = mesh.at(mesh.origin(h)), to = mesh.at(mesh.target(h));
  const bool forward = t == none || from.x < to.x || (from.x == to.x && from.y < to.y);
  const Index e = mesh.edges();
  mesh.links[h >> 2].edge[h & 3] = 2 * e + !forward;
  if (t != none) mesh.links[t >> 2].edge[t & 3] = 2 * e + forward;
  mesh.half.push_back(forward ? h : t);
  mesh.sides.push_back(sides);
}

/// Adds the faces that have an area and pairs their half-edges over shared edges. Those that wait for their twin hang
/// in a chain at the lower of their ends, linked through `twin` until it is known; edges of a valid TIN have two at
/// most. Returns those that wait for ever: the border.
std::vector<Index> add_real_faces(const Tin& tin, const std::vector<Index>& place_of, CompletedMesh& mesh) {
  const std::size_t n = tin.faces.size();
  mesh.links.reserve(n + n / 8 + 256);  // ghosts will follow
  mesh.half.reserve(n * 3 / 2 + n / 8 + 256);
  mesh.sides.reserve(n * 3 / 2 + n / 8 + 256);
  mesh.out.assign(mesh.places.size() + 4, none);
  Array<Index> waiting(mesh.places.size(), none);
  const auto twin = [&](Index h) -> Index& { return mesh.links[h >> 2].twin[h & 3]; };
  bool walls = false;
  std::size_t stop = 0;
  for (std::size_t f = 0; f < n; ++f) {
    if (f == stop) {
      stop = next_stop(f, n);
      populate(mesh.links, mesh.links.size(), stop);
      populate(mesh.half, mesh.half.size(), stop * 3 / 2);
    }
    const Face& face = tin.faces[f];
    const Index corner[3] = {place_of[face[0]], place_of[face[1]], place_of[face[2]]};
    const bool wall = corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0];
    if (wall && !walls) {  // from here on the numbers differ
      mesh.face_in_tin.resize(f);
      std::iota(mesh.face_in_tin.begin(), mesh.face_in_tin.end(), 0);
      walls = true;
    }
    if (wall) continue;
    if (walls) mesh.face_in_tin.push_back(static_cast<Index>(f));
    const Index first = 4 * mesh.faces();
    mesh.links.push_back({{corner[0], corner[1], corner[2]}, {none, none, none}, {}});
    for (int k = 0; k < 3; ++k) {
      const Index h = first + k, u = corner[k], w = corner[k == 2 ? 0 : k + 1], low = std::min(u, w);
      if (mesh.out[u] == none) mesh.out[u] = h;
      Index* link = &waiting[low];
      while (*link != none && !(mesh.origin(*link) == w && mesh.target(*link) == u)) link = &twin(*link);
      if (*link == none) {
        twin(h) = std::exchange(waiting[low], h);
      } else {
        const Index t = *link;
        *link = twin(t);
        twin(t) = h;
        twin(h) = t;
        add_edge(mesh, h, t, 2);
      }
    }
  }
  mesh.real_faces = mesh.faces();
  std::vector<Index> border;
  for (Index h : waiting)
    while (h != none) {
      border.push_back(h);
      h = std::exchange(twin(h), none);
    }
  return border;
}

/// Fills the rest of the box with ghost faces and links them. `border`: the half-edges without a twin. False when the
/// border crosses itself or has two places in one.
bool add_ghosts(CompletedMesh& mesh, const std::vector<Index>& border, const Box& box) {
  const Index n = static_cast<Index>(mesh.places.size());
  mesh.places.insert(mesh.places.end(),
                     {{box.xmin, box.ymin}, {box.xmax, box.ymin}, {box.xmax, box.ymax}, {box.xmin, box.ymax}});
  mesh.z.insert(mesh.z.end(), 4, std::numeric_limits<double>::quiet_NaN());
  std::vector<BorderEdge> outside;  // the border as the exterior sees it: the outside on the left
  outside.reserve(border.size() + 4);
  for (const Index h : border) outside.push_back({mesh.target(h), mesh.origin(h), h});
  for (Index k = 0; k < 4; ++k) outside.push_back({n + k, n + (k + 1) % 4, none});
  const FilledRegion filled = fill_region(mesh.places, outside);
  if (!filled.sound) return false;
  const Index first = mesh.faces();
  for (const Face& f : filled.faces) mesh.links.push_back({{f[0], f[1], f[2]}, {none, none, none}, {}});
  for (std::size_t i = 0; i < filled.faces.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const Index h = 4 * (first + static_cast<Index>(i)) + k, other = filled.across[i][k];
      const Index t = other >= 0 ? 4 * first + other : outside[-1 - other].tag;
      mesh.links[h >> 2].twin[k] = t;
      if (mesh.out[mesh.origin(h)] == none || t == none) mesh.out[mesh.origin(h)] = h;
      if (other >= 0 && t < h) continue;  // the edge was added with its twin
      if (other < 0 && t != none) mesh.links[t >> 2].twin[t & 3] = h;
      add_edge(mesh, h, t, other < 0 ? 1 : 0);  // a border's one real side; on the box the exterior
    }
  return true;
}

/// False when the border does not bound.
bool link(const Tin& tin, const Box& box, const std::vector<Point2>* moved, Search search, CompletedMesh& mesh) {
  mesh = {};
  const std::vector<Index> place_of = number_places(tin, moved, {}, search, mesh);
  std::vector<Index> border = add_real_faces(tin, place_of, mesh);
  if (!mesh.face_in_tin.empty()) {  // a free-standing wall may stand where no face has a corner: no place of the mesh
    std::vector<bool> used(tin.vertices.size());
    for (std::size_t v = 0; v < used.size(); ++v) used[v] = mesh.out[place_of[v]] != none;
    if (!std::all_of(used.begin(), used.end(), [](bool u) { return u; })) {
      mesh = {};
      border = add_real_faces(tin, number_places(tin, moved, used, search, mesh), mesh);
    }
  }
  return add_ghosts(mesh, border, box);
}

}  // namespace

CompletedMesh complete(const Tin& tin, const Box& box, const std::vector<Point2>* moved) {
  if (tin.faces.size() > 250'000'000)
    throw Error(ErrorKind::limit, "too-many-faces", "a surface of more than 250 million faces; cut it into tiles");
  CompletedMesh mesh;
  // Places that were missed because the TIN is not canonical lie twice on the border, which shows.
  if (!link(tin, box, moved, Search::neighbours, mesh) && !link(tin, box, moved, Search::everywhere, mesh))
    throw Error(ErrorKind::input, "overlapping-faces",
                "the border of the surface crosses itself: faces overlap in plan");
  return mesh;
}

namespace {

/// Walks straight from the face `hint` towards q while signs are beyond doubt in plain doubles. Returns the face where
/// that ends; `found` when q lies strictly inside.
Index walk_towards(const CompletedMesh& mesh, Point2 q, Index hint, bool& found) {
  const auto side = [q](Point2 o, Point2 t, bool& sure) {
    const double l = (t.x - o.x) * (q.y - o.y), r = (t.y - o.y) * (q.x - o.x), d = l - r;
    sure = sure && std::fabs(d) > orientation_bound(l, r);
    return d;
  };
  found = false;
  Index h = 4 * hint;
  Point2 from = mesh.at(mesh.origin(h)), to = mesh.at(mesh.target(h));
  bool sure = true;
  if (side(from, to, sure) < 0) {  // the first face is entered through an edge that has q on its left
    h = mesh.twin(h);
    if (h == none) return hint;
    std::swap(from, to);
  }
  for (int steps = 0; steps < 100; ++steps) {
    const Point2 apex = mesh.at(mesh.apex(h));
    const double after = side(to, apex, sure), before = side(apex, from, sure);
    if (!sure) break;
    found = after > 0 && before > 0;
    if (found) break;
    const bool leave_after = after < 0;  // as good as random, so no branch
    const Index g = mesh.twin(leave_after ? next_half(h) : prev_half(h));
    if (g == none) break;
    h = g;
    from = leave_after ? apex : from;
    to = leave_after ? to : apex;
  }
  return h >> 2;
}

}  // namespace

Location locate(const CompletedMesh& mesh, Point2 q, Index hint) {
  bool found;
  Index f = walk_towards(mesh, q, hint, found), from = none;
  if (found) return {Location::face, f};
  std::uint32_t dice = 0x2545F491u;
  for (int steps = 0;; ++steps) {
    // Near the hint a straight walk is quickest; a stochastic one ends on every triangulation, Delaunay or not.
    int first = from == none ? 0 : from & 3;
    if (steps > 100) {
      dice = dice * 1664525u + 1013904223u;
      first = static_cast<int>(dice >> 30) % 3;
    }
    Index exit = none, zeros[2];
    int zero_count = 0;
    Index h = 4 * f + first;
    for (int i = 0; i < 3 && exit == none; ++i, h = next_half(h)) {
      if (h == from) continue;
      const Point2 o = mesh.at(mesh.origin(h)), t = mesh.at(mesh.target(h));
      const double l = (t.x - o.x) * (q.y - o.y), r = (t.y - o.y) * (q.x - o.x);
      if (std::fabs(l - r) <= 1e-15 * (std::fabs(l) + std::fabs(r))) {  // equal places need no exact predicate
        if (o == q) return {Location::place, mesh.origin(h)};
        if (t == q) return {Location::place, mesh.target(h)};
      }
      const int side = orientation(o, t, q);
      if (side < 0) exit = h;
      if (side == 0 && zero_count < 2) zeros[zero_count++] = h;
    }
    if (exit != none && mesh.twin(exit) != none) {
      from = mesh.twin(exit);
      f = from >> 2;
      continue;
    }
    if (zero_count == 0) return {Location::face, f};
    if (zero_count == 1) return {Location::edge, mesh.half[mesh.edge_of(zeros[0])]};
    const Index shared = mesh.target(zeros[0]) == mesh.origin(zeros[1]) ? mesh.target(zeros[0]) : mesh.origin(zeros[0]);
    return {Location::place, shared};
  }
}

namespace {

/// The height of a continuous surface at a place that lies there.
double height_at(const CompletedMesh& mesh, const Location& where, Point2 p) {
  constexpr double outside = std::numeric_limits<double>::quiet_NaN();
  switch (where.kind) {
    case Location::place:
      return mesh.z[where.index];
    case Location::edge: {
      const Index h = where.index, e = mesh.edge_of(h);
      const Index from = mesh.origin(h), to = mesh.target(h);
      return mesh.sides[e] == 0 ? outside
                                : mix(mesh.z[from], mesh.z[to], fraction_along(mesh.at(from), mesh.at(to), p));
    }
    case Location::face:
      break;
  }
  if (!mesh.real(where.index)) return outside;
  const Index* c = mesh.links[where.index].corner;
  return height_on_triangle({mesh.at(c[0]), mesh.at(c[1]), mesh.at(c[2])}, {mesh.z[c[0]], mesh.z[c[1]], mesh.z[c[2]]},
                            p);
}

}  // namespace

void locate_places(const CompletedMesh& mesh, const CompletedMesh& other, Array<Location>& location, Context& context) {
  const std::size_t n = mesh.places.size();
  parallel_for(context, n, chunk_for(context, n), [&](std::size_t begin, std::size_t end) {
    Index hint = 0, next_place = 0;  // surfaces that share places mostly have them in one order
    for (std::size_t i = begin; i < end; ++i) {
      const Point2 q = mesh.at(static_cast<Index>(i));
      if (location[i].index == none) {
        if (next_place < other.real_places() && other.at(next_place) == q)
          location[i] = {Location::place, next_place};
        else
          location[i] = locate(other, q, hint);
      }
      location[i].z = height_at(other, location[i], q);
      hint = face_at(other, location[i]);
      if (location[i].kind == Location::place) next_place = location[i].index + 1;
    }
  });
}

Index face_at(const CompletedMesh& mesh, Location location) {
  switch (location.kind) {
    case Location::face:
      return location.index;
    case Location::edge:
      return location.index >> 2;
    case Location::place:
      return mesh.out[location.index] >> 2;
  }
  return 0;
}

}  // namespace terrane
