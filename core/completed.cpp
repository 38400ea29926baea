// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/completed.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/region_fill.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/predicates.hpp"

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

void add_real_faces(const Tin& tin, const std::vector<Index>& place_of, CompletedMesh& mesh) {
  mesh.links.reserve(tin.faces.size() + tin.faces.size() / 8 + 256);  // ghosts will follow
  bool walls = false;
  for (std::size_t f = 0; f < tin.faces.size(); ++f) {
    const Face& face = tin.faces[f];
    const Index a = place_of[face[0]], b = place_of[face[1]], c = place_of[face[2]];
    const bool wall = a == b || b == c || c == a;
    if (wall && !walls) {  // from here on the numbers differ
      mesh.face_in_tin.resize(f);
      std::iota(mesh.face_in_tin.begin(), mesh.face_in_tin.end(), 0);
      walls = true;
    }
    if (wall) continue;
    mesh.links.push_back({{a, b, c}, {none, none, none}, {}});
    if (walls) mesh.face_in_tin.push_back(static_cast<Index>(f));
  }
  mesh.real_faces = mesh.faces();
}

/// Pairs half-edges over shared edges. Those that wait for their twin hang in a chain at the lower of their ends,
/// linked through `twin` until it is known; edges of a valid TIN have two at most.
void pair_real_halves(CompletedMesh& mesh) {
  const auto twin = [&](Index h) -> Index& { return mesh.links[h >> 2].twin[h & 3]; };
  Array<Index> waiting(mesh.places.size(), none);
  for (Index f = 0; f < mesh.faces(); ++f)
    for (Index h = 4 * f; h < 4 * f + 3; ++h) {
      const Index u = mesh.origin(h), w = mesh.target(h), low = std::min(u, w);
      Index* link = &waiting[low];
      while (*link != none && !(mesh.origin(*link) == w && mesh.target(*link) == u)) link = &twin(*link);
      if (*link == none) {
        twin(h) = std::exchange(waiting[low], h);
      } else {
        const Index t = *link;
        *link = twin(t);
        twin(t) = h;
        twin(h) = t;
      }
    }
  for (Index h : waiting)  // these are the border
    while (h != none) h = std::exchange(twin(h), none);
}

/// Fills the rest of the box with ghost faces and links them. False when the border crosses itself or has two places in
/// one.
bool add_ghosts(CompletedMesh& mesh, const Box& box) {
  const Index n = static_cast<Index>(mesh.places.size());
  mesh.places.insert(mesh.places.end(),
                     {{box.xmin, box.ymin}, {box.xmax, box.ymin}, {box.xmax, box.ymax}, {box.xmin, box.ymax}});
  mesh.z.insert(mesh.z.end(), 4, std::numeric_limits<double>::quiet_NaN());
  std::vector<BorderEdge> border;  // as the exterior sees them: the outside on the left
  for (Index f = 0; f < mesh.faces(); ++f)
    for (Index h = 4 * f; h < 4 * f + 3; ++h)
      if (mesh.twin(h) == none) border.push_back({mesh.target(h), mesh.origin(h), h});
  for (Index k = 0; k < 4; ++k) border.push_back({n + k, n + (k + 1) % 4, none});
  const FilledRegion filled = fill_region(mesh.places, border);
  if (!filled.sound) return false;
  const Index first = mesh.faces();
  for (const Face& f : filled.faces) mesh.links.push_back({{f[0], f[1], f[2]}, {none, none, none}, {}});
  for (std::size_t i = 0; i < filled.faces.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const Index h = 4 * (first + static_cast<Index>(i)) + k, other = filled.across[i][k];
      if (other >= 0) {
        mesh.links[h >> 2].twin[k] = 4 * first + other;
      } else if (const Index b = border[-1 - other].tag; b != none) {
        mesh.links[h >> 2].twin[k] = b;
        mesh.links[b >> 2].twin[b & 3] = h;
      }
    }
  return true;
}

void number_edges(CompletedMesh& mesh) {
  mesh.out.assign(mesh.places.size(), none);
  mesh.half.reserve(mesh.links.size() * 3 / 2 + 8);
  mesh.sides.reserve(mesh.links.size() * 3 / 2 + 8);
  const auto lower = [](Point2 p, Point2 q) { return p.x < q.x || (p.x == q.x && p.y < q.y); };
  for (Index f = 0; f < mesh.faces(); ++f)
    for (Index h = 4 * f; h < 4 * f + 3; ++h) {
      const Index t = mesh.twin(h), from = mesh.origin(h);
      if (mesh.out[from] == none || t == none) mesh.out[from] = h;
      if (t != none && t < h) continue;  // numbered with its twin
      // Which half-edge defines the edge is read off its coordinates, so that what is computed along it does not depend
      // on the order of the faces.
      const bool forward = t == none || lower(mesh.at(from), mesh.at(mesh.target(h)));
      const Index e = mesh.edges();
      mesh.links[f].edge[h & 3] = 2 * e + !forward;
      if (t != none) mesh.links[t >> 2].edge[t & 3] = 2 * e + forward;
      mesh.half.push_back(forward ? h : t);
      mesh.sides.push_back(t == none ? 1 : mesh.real(h >> 2) + mesh.real(t >> 2));
    }
}

/// All but the numbers of edges; false when the border does not bound.
bool link(const Tin& tin, const Box& box, const std::vector<Point2>* moved, Search search, CompletedMesh& mesh) {
  mesh = {};
  add_real_faces(tin, number_places(tin, moved, {}, search, mesh), mesh);
  if (!mesh.face_in_tin.empty()) {  // a free-standing wall may have vertices to itself, which are no places in plan
    std::vector<bool> used(tin.vertices.size(), false);
    for (const Index f : mesh.face_in_tin)
      for (const Index v : tin.faces[f]) used[v] = true;
    if (!std::all_of(used.begin(), used.end(), [](bool u) { return u; })) {
      mesh = {};
      add_real_faces(tin, number_places(tin, moved, used, search, mesh), mesh);
    }
  }
  pair_real_halves(mesh);
  return add_ghosts(mesh, box);
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
  number_edges(mesh);
  return mesh;
}

Location locate(const CompletedMesh& mesh, Point2 q, Index hint) {
  Index f = hint, from = none;
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
