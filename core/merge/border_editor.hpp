// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/mosaic.hpp"
#include "core/plan_metric.hpp"

// A surface whose border is moved and refined, face by face, and stays valid all the while.
namespace terrane {

/// Do two segments have a place in common? Exact.
bool meet(Point2 a, Point2 b, Point2 c, Point2 d);

class BorderEditor {
 public:
  /// Edges and vertices of the border as they come are numbered by the faces; vertices are listed by place. O(n log n).
  explicit BorderEditor(Piece piece);

  struct Edge {
    Index from, to;  // the domain on the left
    Index face;      // that it belonged to at first
  };
  const std::vector<Edge>& edges() const { return edges_; }
  const std::vector<Index>& border() const { return border_; }
  /// The vertices along an edge by now, its ends included.
  const std::vector<Index>& chain(Index edge) const { return chains_[edge]; }
  Point2 at(Index v) const { return piece_.surface.points[v]; }
  /// Whether a vertex of the border stands there.
  bool stands_at(Point2 p) const { return occupied_.contains({p.x, p.y}); }
  const Piece& piece() const { return piece_; }
  /// Faces around a vertex of the border.
  const std::vector<Index>& star(Index v) const { return stars_.at(v); }
  std::size_t made() const { return made_; }

  /// Whether all faces stay positive and the border meets none of the edges given, but where it is joined to them, when
  /// a vertex moves.
  bool can_move(Index v, Point2 to, std::span<const Index> own_edges) const;
  void move(Index v, Point2 to);

  /// The part of an edge that passes nearest to a place.
  struct Nearest {
    Index from = none, to = none;
    std::size_t part = 0;
    double t = 0, distance = 0;
  };
  Nearest nearest(Index edge, Point2 p, const PlanMetric& metric) const;

  /// The same for a vertex made on an edge or beside it: the edge then leads through it.
  bool can_insert(const Nearest& where, Point2 p, std::span<const Index> own_edges) const;
  /// Its height is that of the edge.
  void insert(Index edge, const Nearest& where, Point2 p);

  /// Of the border edges that a move or a new vertex makes.
  Box box_of_border_at(Index v, Point2 to) const;
  Box box_of(const Nearest& where, Point2 p) const;

 private:
  static std::uint64_t key(Index p, Index q) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(p)) << 32 | static_cast<std::uint32_t>(q);
  }
  const Face& face(Index f) const { return piece_.surface.faces[f]; }
  int corner(Index f, Index v) const { return face(f)[0] == v ? 0 : face(f)[1] == v ? 1 : 2; }
  Index opposite(Index f, Index p, Index q) const;
  bool crosses_border(Point2 p, Point2 q, Index v, Index w, std::span<const Index> own_edges) const;

  Piece piece_;
  std::vector<Edge> edges_;
  std::vector<std::vector<Index>> chains_;
  std::vector<Index> border_;
  std::size_t made_ = 0;
  std::vector<std::uint8_t> on_border_;                  // by vertex
  std::unordered_map<std::uint64_t, Index> face_at_;     // border half-edge -> its face
  std::unordered_map<Index, std::vector<Index>> stars_;  // faces around a border vertex
  std::unordered_map<Index, std::vector<Index>> next_;   // its neighbours along the border
  std::map<std::pair<double, double>, Index> occupied_;
};

}  // namespace terrane
