// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mosaic.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "core/box.hpp"
#include "core/plan/place_order.hpp"

namespace terrane {
namespace {

struct PlaceHash {
  std::size_t operator()(const Point2& p) const {
    // Adding 0 makes one of the two zeros, which are one place.
    std::uint64_t h = std::bit_cast<std::uint64_t>(p.x + 0.0) * 0x9e3779b97f4a7c15u;
    h = (h ^ (h >> 29) ^ std::bit_cast<std::uint64_t>(p.y + 0.0)) * 0xbf58476d1ce4e5b9u;
    return h ^ (h >> 32);
  }
};

/// Gives every place one index.
class Places {
 public:
  explicit Places(Array<Point2>& points, std::size_t expected) : points_(points) { index_.reserve(expected); }
  Index at(Point2 p) {
    const auto [it, fresh] = index_.try_emplace(p, static_cast<Index>(points_.size()));
    if (fresh) points_.push_back(p);
    return it->second;
  }

 private:
  Array<Point2>& points_;
  std::unordered_map<Point2, Index, PlaceHash> index_;
};

Box box_of(const CornerSurface& surface, const Face& f) {
  Box box = no_box;
  for (const Index v : f) box = around(box, surface.points[v]);
  return box;
}

void copy_face(const Piece& from, std::size_t f, const Face& corners, Piece& to) {
  to.surface.faces.push_back(corners);
  for (std::size_t c = 3 * f; c < 3 * f + 3; ++c) {
    to.surface.z.push_back(from.surface.z[c]);
    to.surface.firm.push_back(from.surface.firm[c]);
  }
  to.contributors.push_back(from.contributors[f]);
  if (!from.cells.empty()) to.cells.push_back(from.cells[f]);
}

/// A box with all faces around it whose boxes touch it: an edge that is crossed in the box is rounded there and so
/// moves all along, past what lies beside it.
Box with_faces(const Box& box, const Piece& piece) {
  Box all = box;
  for (const Face& corners : piece.surface.faces)
    if (const Box face = box_of(piece.surface, corners); touches(face, box)) all = around(all, face);
  return all;
}

/// Moves the faces of `from` to the end of `to`, by place.
void append(const Piece& from, Places& places, Piece& to) {
  std::vector<Index> index(from.surface.points.size(), none);
  for (std::size_t f = 0; f < from.surface.faces.size(); ++f) {
    Face corners = from.surface.faces[f];
    for (Index& v : corners) {
      if (index[v] == none) index[v] = places.at(from.surface.points[v]);
      v = index[v];
    }
    copy_face(from, f, corners, to);
  }
}

}  // namespace

ContributorSets::ContributorSets(int tiles) : sloped_(tiles) {
  for (int t = 0; t < tiles; ++t) sets_.push_back({t});
}

Index ContributorSets::with(Index set, int tile) {
  const auto [it, fresh] = made_.try_emplace({set, tile}, static_cast<Index>(sets_.size()));
  if (!fresh) return it->second;
  std::vector<int> members = sets_[set];
  members.insert(std::lower_bound(members.begin(), members.end(), tile), tile);
  sets_.push_back(std::move(members));
  sloped_.push_back(sloped_[set]);
  return it->second;
}

Index ContributorSets::sloped(Index set) {
  if (sloped_[set]) return set;
  const auto [it, fresh] = made_.try_emplace({set, -1}, static_cast<Index>(sets_.size()));
  if (!fresh) return it->second;
  sets_.push_back(std::vector(sets_[set]));
  sloped_.push_back(true);
  return it->second;
}

Tin as_tin(const Piece& piece) {
  const CornerSurface& surface = piece.surface;
  Tin tin;
  tin.faces.resize(surface.faces.size());
  std::vector<Index> first(surface.points.size(), none);  // vertex of the first height seen at a place
  std::vector<Index> next;                                // vertex of another height at the same place
  for (std::size_t c = 0; c < surface.z.size(); ++c) {
    const Index place = surface.faces[c / 3][c % 3];
    Index* link = &first[place];
    while (*link != none && tin.vertices[*link].z != surface.z[c]) link = &next[*link];
    if (*link == none) {
      *link = static_cast<Index>(tin.vertices.size());
      tin.faces[c / 3][c % 3] = *link;
      tin.vertices.push_back({surface.points[place].x, surface.points[place].y, surface.z[c]});
      next.push_back(none);  // may move what `link` points into: it is not used after this
      continue;
    }
    tin.faces[c / 3][c % 3] = *link;
  }
  return tin;
}

Piece piece_of(const Tin& tin, Index contributor) {
  Piece piece;
  Places places(piece.surface.points, tin.vertices.size());
  std::vector<Index> index(tin.vertices.size(), none);
  for (const Face& f : tin.faces) {
    if (is_wall(tin, f)) continue;
    Face corners = f;
    for (Index& v : corners) {
      piece.surface.z.push_back(tin.vertices[v].z);
      if (index[v] == none) index[v] = places.at(plan(tin.vertices[v]));
      v = index[v];
    }
    piece.surface.faces.push_back(corners);
  }
  piece.surface.firm.assign(piece.surface.z.size(), 1);
  piece.contributors.assign(piece.surface.faces.size(), contributor);
  return piece;
}

Tin near_faces(const Tin& tin, const Box& box) {
  Tin result;
  std::vector<Index> index(tin.vertices.size(), none);
  for (const Face& f : tin.faces) {
    if (!touches(box_of(tin, f), box) || is_wall(tin, f)) continue;
    Face corners = f;
    for (Index& v : corners) {
      if (index[v] == none) {
        index[v] = static_cast<Index>(result.vertices.size());
        result.vertices.push_back(tin.vertices[v]);
      }
      v = index[v];
    }
    result.faces.push_back(corners);
  }
  return result;
}

Box widened(const Box& box) {
  const double largest = std::max({std::fabs(box.xmin), std::fabs(box.xmax), std::fabs(box.ymin), std::fabs(box.ymax)});
  const double margin = 1e-6 * std::max(box.xmax - box.xmin, box.ymax - box.ymin) + 1e-12 * largest;
  return {box.xmin - margin, box.ymin - margin, box.xmax + margin, box.ymax + margin};
}

void Mosaic::add(const Piece& piece) {
  constexpr std::size_t part_size = 4096;
  std::vector<Index> local(piece.surface.points.size(), none);
  for (std::size_t first = 0; first < piece.surface.faces.size(); first += part_size)
    add_part(piece, first, std::min(first + part_size, piece.surface.faces.size()), local);
}

void Mosaic::add_part(const Piece& piece, std::size_t first, std::size_t last, std::vector<Index>& local) {
  Part part{no_box, {}};
  for (std::size_t f = first; f < last; ++f) {
    Face corners = piece.surface.faces[f];
    part.box = around(part.box, box_of(piece.surface, corners));
    for (Index& v : corners) {
      if (local[v] == none) {
        local[v] = static_cast<Index>(part.piece.surface.points.size());
        part.piece.surface.points.push_back(piece.surface.points[v]);
      }
      v = local[v];
    }
    copy_face(piece, f, corners, part.piece);
  }
  for (std::size_t f = first; f < last; ++f)
    for (const Index v : piece.surface.faces[f]) local[v] = none;
  parts_.push_back(std::move(part));
}

bool Parted::is_shared(Point2 p) const { return std::binary_search(shared.begin(), shared.end(), p, before); }

Parted parted(const Piece& piece, const std::vector<Box>& boxes) {
  std::vector<Box> reach;
  for (const Box& box : boxes) reach.push_back(widened(with_faces(box, piece)));
  Parted parts;
  std::vector<std::uint8_t> sides(piece.surface.points.size(), 0);
  for (std::size_t f = 0; f < piece.surface.faces.size(); ++f) {
    const Face& corners = piece.surface.faces[f];
    const Box face = box_of(piece.surface, corners);
    const bool is_near = std::any_of(reach.begin(), reach.end(), [&](const Box& box) { return touches(face, box); });
    copy_face(piece, f, corners, is_near ? parts.near : parts.far);
    for (const Index v : corners) sides[v] |= is_near ? 1 : 2;
  }
  parts.near.surface.points = parts.far.surface.points = piece.surface.points;
  for (std::size_t v = 0; v < sides.size(); ++v)
    if (sides[v] == 3) parts.shared.push_back(piece.surface.points[v]);
  std::sort(parts.shared.begin(), parts.shared.end(), before);
  return parts;
}

Piece Mosaic::take_near(const Box& tile) {
  Box box = tile;
  for (const Part& part : parts_)
    if (touches(part.box, tile)) box = around(box, with_faces(tile, part.piece));
  box = widened(box);
  Piece near;
  Places places(near.surface.points, 0);
  std::vector<Part> parts;
  parts.swap(parts_);
  for (Part& part : parts) {
    if (!touches(part.box, box)) {
      parts_.push_back(std::move(part));
      continue;
    }
    Piece inside, outside;
    for (std::size_t f = 0; f < part.piece.surface.faces.size(); ++f) {
      const Face& corners = part.piece.surface.faces[f];
      copy_face(part.piece, f, corners, touches(box_of(part.piece.surface, corners), box) ? inside : outside);
    }
    inside.surface.points = part.piece.surface.points;
    outside.surface.points = std::move(part.piece.surface.points);
    append(inside, places, near);
    if (!outside.contributors.empty()) add(outside);
  }
  return near;
}

Piece Mosaic::take_all() {
  Piece all;
  std::size_t points = 0;
  for (const Part& part : parts_) points += part.piece.surface.points.size();
  Places places(all.surface.points, points);
  for (Part& part : parts_) {
    append(part.piece, places, all);
    part.piece = {};
  }
  parts_.clear();
  return all;
}

}  // namespace terrane
