// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/completed.hpp"

#include <bit>
#include <cstring>

#include "core/region_fill.hpp"
#include "core/error.hpp"
#include "core/predicates.hpp"

namespace terrane {
namespace {

/// Gives each vertex the number of its place: equal x and y share one. Open addressing over the bit patterns.
std::vector<Index> number_places(const Tin& tin, const std::vector<Point2>* moved, CompletedMesh& mesh) {
  const std::size_t n = tin.vertices.size();
  const std::size_t slots = std::bit_ceil(2 * n + 16);
  std::vector<Index> table(slots, none), place_of(n);
  mesh.places.reserve(n + 4);
  mesh.any_vertex.reserve(n + 4);
  for (std::size_t v = 0; v < n; ++v) {
    Point2 p = moved ? (*moved)[v] : plan(tin.vertices[v]);
    p.x += 0.0, p.y += 0.0;  // -0 and 0 are one place
    std::uint64_t hx, hy;
    std::memcpy(&hx, &p.x, 8);
    std::memcpy(&hy, &p.y, 8);
    std::uint64_t key = (hx * 0x9E3779B97F4A7C15ull) ^ std::rotl(hy * 0xC2B2AE3D27D4EB4Full, 31);
    key *= 0x9E3779B97F4A7C15ull;
    std::size_t slot = (key >> 20) & (slots - 1);
    while (table[slot] != none && !(mesh.places[table[slot]] == p)) slot = (slot + 1) & (slots - 1);
    if (table[slot] == none) {
      table[slot] = static_cast<Index>(mesh.places.size());
      mesh.places.push_back(p);
      mesh.any_vertex.push_back(static_cast<Index>(v));
    } else if (tin.vertices[mesh.any_vertex[table[slot]]].z != tin.vertices[v].z) {
      mesh.jumps = true;
    }
    place_of[v] = table[slot];
  }
  return place_of;
}

void add_real_faces(const Tin& tin, const std::vector<Index>& place_of, CompletedMesh& mesh) {
  mesh.corner.reserve(4 * tin.faces.size());
  mesh.vertex.reserve(3 * tin.faces.size());
  mesh.face_in_tin.reserve(tin.faces.size());
  for (std::size_t f = 0; f < tin.faces.size(); ++f) {
    const Face& face = tin.faces[f];
    const Index a = place_of[face[0]], b = place_of[face[1]], c = place_of[face[2]];
    if (a == b || b == c || c == a) continue;  // a wall
    mesh.corner.insert(mesh.corner.end(), {a, b, c, none});
    mesh.vertex.insert(mesh.vertex.end(), face.begin(), face.end());
    mesh.face_in_tin.push_back(static_cast<Index>(f));
  }
  mesh.real_faces = mesh.faces();
}

/// Pairs half-edges over shared edges: a bucket per lower end, a few entries each.
void pair_real_halves(CompletedMesh& mesh) {
  const std::size_t halves = mesh.corner.size();
  mesh.twin.assign(halves, none);
  std::vector<Index> start(mesh.places.size() + 2, 0);
  auto each = [&](auto&& visit) {
    for (std::size_t h = 0; h < halves; ++h) {
      if ((h & 3) == 3) continue;
      const Index u = mesh.origin(static_cast<Index>(h)), w = mesh.target(static_cast<Index>(h));
      visit(static_cast<Index>(h), std::min(u, w), std::max(u, w));
    }
  };
  each([&](Index, Index low, Index) { ++start[low + 2]; });
  for (std::size_t i = 2; i < start.size(); ++i) start[i] += start[i - 1];
  struct Entry {
    Index high, half;
  };
  std::vector<Entry> entries(start.back());
  each([&](Index h, Index low, Index high) { entries[start[low + 1]++] = {high, h}; });
  for (std::size_t low = 0; low < mesh.places.size(); ++low)
    for (Index i = start[low]; i < start[low + 1]; ++i)
      for (Index j = i + 1; j < start[low + 1]; ++j)
        if (entries[i].high == entries[j].high) {
          mesh.twin[entries[i].half] = entries[j].half;
          mesh.twin[entries[j].half] = entries[i].half;
        }
}

/// Fills the rest of the box with ghost faces and links them.
void add_ghosts(CompletedMesh& mesh, const Box& box) {
  const Index n = static_cast<Index>(mesh.places.size());
  mesh.places.insert(mesh.places.end(),
                     {{box.xmin, box.ymin}, {box.xmax, box.ymin}, {box.xmax, box.ymax}, {box.xmin, box.ymax}});
  mesh.any_vertex.insert(mesh.any_vertex.end(), 4, none);
  std::vector<BorderEdge> border;  // as the exterior sees them: the outside on the left
  for (Index h = 0; h < static_cast<Index>(mesh.corner.size()); ++h)
    if ((h & 3) != 3 && mesh.twin[h] == none) border.push_back({mesh.target(h), mesh.origin(h), h});
  for (Index k = 0; k < 4; ++k) border.push_back({n + k, n + (k + 1) % 4, none});
  const FilledRegion filled = fill_region(mesh.places, border);
  if (!filled.sound)
    throw Error(ErrorKind::input, "overlapping-faces",
                "the border of the surface crosses itself: faces overlap in plan");
  const Index first = mesh.faces();
  for (const Face& f : filled.faces) mesh.corner.insert(mesh.corner.end(), {f[0], f[1], f[2], none});
  mesh.twin.resize(mesh.corner.size(), none);
  for (std::size_t i = 0; i < filled.faces.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const Index h = 4 * (first + static_cast<Index>(i)) + k, other = filled.across[i][k];
      if (other >= 0) {
        mesh.twin[h] = 4 * first + other;
      } else if (const Index b = border[-1 - other].tag; b != none) {
        mesh.twin[h] = b;
        mesh.twin[b] = h;
      }
    }
}

void number_edges(CompletedMesh& mesh) {
  mesh.edge.assign(mesh.corner.size(), none);
  mesh.out.assign(mesh.places.size(), none);
  mesh.half.reserve(mesh.corner.size() * 3 / 8 + 8);
  for (Index h = 0; h < static_cast<Index>(mesh.corner.size()); ++h) {
    if ((h & 3) == 3) continue;
    if (mesh.out[mesh.origin(h)] == none || mesh.twin[h] == none) mesh.out[mesh.origin(h)] = h;
    if (mesh.edge[h] != none) continue;
    mesh.edge[h] = static_cast<Index>(mesh.half.size());
    if (mesh.twin[h] != none) mesh.edge[mesh.twin[h]] = mesh.edge[h];
    mesh.half.push_back(h);
  }
}

}  // namespace

CompletedMesh complete(const Tin& tin, const Box& box, const std::vector<Point2>* moved) {
  CompletedMesh mesh;
  const std::vector<Index> place_of = number_places(tin, moved, mesh);
  add_real_faces(tin, place_of, mesh);
  pair_real_halves(mesh);
  add_ghosts(mesh, box);
  number_edges(mesh);
  return mesh;
}

Location locate(const CompletedMesh& mesh, Point2 q, Index hint) {
  Index f = hint, from = none;
  std::uint32_t dice = 0x2545F491u;  // a fixed stochastic walk: ends on every triangulation, Delaunay or not
  for (;;) {
    dice = dice * 1664525u + 1013904223u;
    const int first = static_cast<int>(dice >> 30) % 3;
    Index exit = none, zeros[2];
    int zero_count = 0;
    for (int i = 0; i < 3 && exit == none; ++i) {
      const Index h = 4 * f + (first + i) % 3;
      if (h == from) continue;
      const int side = orientation(mesh.at(mesh.origin(h)), mesh.at(mesh.target(h)), q);
      if (side < 0) exit = h;
      if (side == 0 && zero_count < 2) zeros[zero_count++] = h;
    }
    if (exit != none && mesh.twin[exit] != none) {
      from = mesh.twin[exit];
      f = from >> 2;
      continue;
    }
    if (zero_count == 0) return {Location::face, f};
    if (zero_count == 1) return {Location::edge, zeros[0]};
    const Index shared = mesh.target(zeros[0]) == mesh.origin(zeros[1]) ? mesh.target(zeros[0]) : mesh.origin(zeros[0]);
    return {Location::place, shared};
  }
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
