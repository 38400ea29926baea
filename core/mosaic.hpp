// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "core/surface.hpp"
#include "core/tin.hpp"

// The surface that a merge has accumulated, in pieces small enough that a tile finds the faces near it without visiting
// all.
namespace terrane {

/// Sets of tiles, each stored once. A tile is known by its rank in the order of the merge.
class ContributorSets {
 public:
  explicit ContributorSets(int tiles);
  Index single(int tile) const { return tile; }
  Index with(Index set, int tile);
  /// The same tiles, for faces whose heights are no longer what the policy makes of them: ramps.
  Index sloped(Index set);
  bool is_sloped(Index set) const { return sloped_[set]; }
  const std::vector<int>& members(Index set) const { return sets_[set]; }

 private:
  std::vector<std::vector<int>> sets_;  // sorted; the first are the tiles alone
  std::vector<bool> sloped_;
  std::map<std::pair<Index, int>, Index> made_;
};

/// Faces with heights per corner and what they come from.
struct Piece {
  CornerSurface surface;
  std::vector<Index> contributors;  // a set per face
  /// Per face: faces that lie on the same faces of the same tiles have the same number. Empty: not told apart.
  std::vector<Index> cells = {};
};

/// The faces of a piece as the input of an overlay: vertex per place and height; face i is face i of the piece.
Tin as_tin(const Piece& piece);

/// The surface of a tile without its walls, every height firm; faces[i] says which face of the tile face i is.
Piece piece_of(const Tin& tin, Index contributor);

/// The faces of a TIN whose box in plan touches `box`; walls are left out.
Tin near_faces(const Tin& tin, const Box& box);

/// A tile's box with a margin wide against rounding and narrow against terrain.
Box widened(const Box& box);

/// A piece in two.
struct Parted {
  Piece near, far;
  std::vector<Point2> shared;  // the places that both have, sorted
  bool is_shared(Point2 p) const;
};
/// The faces that something within the boxes may change, with those beside them, and the others. O(faces * boxes).
Parted parted(const Piece& piece, const std::vector<Box>& boxes);

class Mosaic {
 public:
  void add(const Piece& piece);
  /// Takes out the faces that a tile within `tile` may change, and those beside them, by their boxes in plan. Time
  /// grows with them and with the number of pieces.
  Piece take_near(const Box& tile);
  /// Everything, points unique by place.
  Piece take_all();

 private:
  struct Part {
    Box box;
    Piece piece;
  };
  void add_part(const Piece& piece, std::size_t first, std::size_t last, std::vector<Index>& local);
  std::vector<Part> parts_;
};

}  // namespace terrane
