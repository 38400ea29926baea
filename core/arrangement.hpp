// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "core/completed.hpp"
#include "core/context.hpp"

// The exact combinatorial overlay of two completed meshes: who crosses whom, in which order, and which regions that
// makes. Nothing here looks at a constructed coordinate.
//
// Notation. Mesh 0 is A, mesh 1 is B. Vertices of the arrangement are numbered: places of A, places of B, crossings; a
// place of B on a place of A goes by A's number. The nodes of an edge are the vertices strictly inside it, in order
// along its defining half-edge; they cut it into nodes + 1 pieces. A piece is known by edge, position and direction (0
// along the defining half-edge, 1 against it), packed into one number per mesh.
namespace terrane {

struct Crossing {
  Index edge[2];
  Index position[2];  // among the nodes of that edge
  bool along;         // B's defining half-edge passes from the right of A's to its left
};

/// Nodes of all edges of one mesh, in one array.
struct Chains {
  std::vector<Index> first;  // of edge e: nodes first[e] .. first[e + 1]
  std::vector<Index> nodes;
  Index count(Index e) const { return first[e + 1] - first[e]; }
};

/// A directed piece of an edge of one mesh. Where pieces of both meshes coincide A's stands for both.
struct Piece {
  int mesh;
  Index edge, position, direction;
  Index edge_of_b = none;  // of the piece of B that coincides with this one of A
};

/// One convex region: its corners counter-clockwise, and the piece that leaves each corner.
struct Region {
  Index parent[2];             // faces of the completed meshes
  std::vector<Index> corners;  // vertices
  std::vector<bool> flat;      // the corner lies on the line of its neighbours
  std::vector<Piece> pieces;   // pieces[i] leaves corners[i]
};

class Arrangement {
 public:
  /// Builds everything but the regions. `b_in_a[j]`: where place j of B lies in A. O(n + crossings) expected.
  Arrangement(const CompletedMesh& a, const CompletedMesh& b, std::vector<Location> b_in_a, Context& context);

  /// Calls visit(Region&) for every region inside the box, each once; the same buffer every time.
  template <class Visitor>
  void trace(Visitor&& visit) const;

  const CompletedMesh& mesh(int m) const { return *mesh_[m]; }
  const std::vector<Crossing>& crossings() const { return crossings_; }
  const Chains& chains(int m) const { return chains_[m]; }
  const Location& location(int m, Index place) const {
    return location_[m][place];
  }  // of a place of m in the other mesh
  Index first_crossing() const { return base_[2]; }
  Index vertices() const { return base_[2] + static_cast<Index>(crossings_.size()); }
  /// The arrangement's number of a place of mesh m.
  Index vertex(int m, Index place) const { return m == 0 ? place : vertex_of_b_[place]; }
  bool is_place_of(int m, Index vertex) const { return vertex >= base_[m] && vertex < base_[m + 1]; }
  Index place(int m, Index vertex) const { return vertex - base_[m]; }
  /// The crossing behind a vertex number; only for vertices >= first_crossing().
  const Crossing& crossing(Index vertex) const { return crossings_[vertex - base_[2]]; }
  /// Vertices at the tail and head of a piece.
  Index tail(const Piece& p) const { return p.direction == 0 ? before(p) : after(p); }
  Index head(const Piece& p) const { return p.direction == 0 ? after(p) : before(p); }
  /// The face to the left of a piece in its own mesh; none outside the box.
  Index left_face(const Piece& p) const {
    const Index h = mesh_[p.mesh]->half[p.edge];
    if (p.direction == 0) return h >> 2;
    return mesh_[p.mesh]->twin[h] == none ? none : mesh_[p.mesh]->twin[h] >> 2;
  }

 private:
  /// An outgoing piece at a junction: a vertex of one mesh that lies on a vertex or an edge of the other.
  struct Spoke {
    Piece piece;    // A's where both meshes have one in this direction
    Index key[2];   // packed piece of A and of B in this direction; none where the mesh has none
    Index left[2];  // the faces of the sector that follows counter-clockwise
    Point2 toward;
  };

  void walk_edges(Context& context);
  void walk_edge(Index e);
  void order_b_chains();
  void build_junctions();
  void add_spokes(int m, Index vertex, std::vector<Spoke>& spokes) const;
  void sort_spokes(Point2 centre, std::vector<Spoke>& spokes);

  Index before(const Piece& p) const {
    return p.position == 0 ? vertex(p.mesh, mesh_[p.mesh]->origin(mesh_[p.mesh]->half[p.edge]))
                           : chains_[p.mesh].nodes[chains_[p.mesh].first[p.edge] + p.position - 1];
  }
  Index after(const Piece& p) const {
    return p.position == chains_[p.mesh].count(p.edge)
               ? vertex(p.mesh, mesh_[p.mesh]->target(mesh_[p.mesh]->half[p.edge]))
               : chains_[p.mesh].nodes[chains_[p.mesh].first[p.edge] + p.position];
  }
  /// Packed numbers: unique over both meshes, direction in the lowest bit.
  Index key(const Piece& p) const {
    return key_base_[p.mesh] + 2 * (chains_[p.mesh].first[p.edge] + p.edge + p.position) + p.direction;
  }
  Piece leaving(int m, Index h) const {  // the first piece along half-edge h
    const Index e = mesh_[m]->edge[h];
    return mesh_[m]->half[e] == h ? Piece{m, e, 0, 0} : Piece{m, e, chains_[m].count(e), 1};
  }
  Piece next(const Piece& p, Index head, bool& flat) const;
  Piece turn_at_junction(const Piece& p, Index junction, bool& flat) const;
  const Spoke& spoke(Index junction, Index key) const;

  const CompletedMesh* mesh_[2];
  std::vector<Location> location_[2];
  std::vector<Index> vertex_of_b_;
  Index base_[3];
  std::vector<Crossing> crossings_;
  std::vector<double> along_b_;  // parameter of a crossing along B's edge, relative error below 1e-12
  Chains chains_[2];
  std::vector<Index> position_on_[2];  // of a place of mesh m: its position among the nodes of the other mesh's edge
  Index key_base_[3];
  std::vector<Index> junction_of_;  // per place number; none for plain vertices
  std::vector<Index> junction_first_;
  std::vector<Index> junction_vertex_;
  std::vector<Spoke> spokes_;
  std::vector<bool> spoken_for_;  // pieces of B that coincide with one of A
};

template <class Visitor>
void Arrangement::trace(Visitor&& visit) const {
  Region region;
  std::vector<bool> visited = spoken_for_;
  for (int m = 0; m < 2; ++m)
    for (Index e = 0; e < static_cast<Index>(mesh_[m]->half.size()); ++e)
      for (Index position = 0; position <= chains_[m].count(e); ++position)
        for (Index direction = 0; direction < 2; ++direction) {
          Piece piece{m, e, position, direction};
          const Index start = key(piece);
          if (visited[start] || left_face(piece) == none) continue;
          region.parent[0] = region.parent[1] = none;
          region.corners.clear();
          region.flat.clear();
          region.pieces.clear();
          Index k = start;
          Index corner = tail(piece);
          if (corner < base_[2] && junction_of_[corner] != none) piece = spoke(junction_of_[corner], start).piece;
          bool flat = false;
          do {
            visited[k] = true;
            region.corners.push_back(corner);
            region.flat.push_back(flat);
            region.pieces.push_back(piece);
            region.parent[piece.mesh] = left_face(piece);
            corner = head(piece);
            flat = false;
            piece = next(piece, corner, flat);
            k = key(piece);
            if (corner < base_[2] && junction_of_[corner] != none)  // the sector turned through knows both faces
              for (int m2 = 0; m2 < 2; ++m2) region.parent[m2] = spoke(junction_of_[corner], k).left[m2];
          } while (k != start);
          region.flat[0] = flat;
          for (int side = 0; side < 2; ++side)
            if (region.parent[side] == none) {  // all corners are plain vertices of the other mesh: any of them knows
              const int other = 1 - side;
              region.parent[side] = location_[other][place(other, region.corners[0])].index;
            }
          visit(region);
        }
}

}  // namespace terrane
