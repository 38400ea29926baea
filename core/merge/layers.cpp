// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/merge/layers.hpp"

#include <algorithm>

#include "core/merge/needless.hpp"
#include "core/overlay/mended_heights.hpp"
#include "core/triangle_height.hpp"

namespace terrane {
namespace {

/// What a face of the refinement lies on: the last tile's face, and the chain of those before it.
struct Ancestor {
  int tile;
  Index face;    // of the tile's piece
  Index before;  // a cell; none: no more
};

Piece flat(const Piece& piece) {
  Piece result = piece;
  result.surface.z.assign(result.surface.z.size(), 0);
  return result;
}

class Refiner {
 public:
  Refiner(const std::vector<Tin>& tiles, const std::vector<int>& order, RoundingReport& report, Context& context)
      : report_(report), context_(context) {
    for (std::size_t rank = 0; rank < order.size(); ++rank) pieces_.push_back(piece_of(tiles[order[rank]], 0));
    refine(tiles, order);
  }

  Layered run() {
    Piece all = mosaic_.take_all();
    result_.points = std::move(all.surface.points);
    result_.faces = std::move(all.surface.faces);
    result_.first.push_back(0);
    for (const Index last : all.contributors) {
      std::vector<Index> chain;
      for (Index a = last; a != none; a = ancestors_[a].before) chain.push_back(a);
      for (auto a = chain.rbegin(); a != chain.rend(); ++a) {
        result_.layers.push_back({ancestors_[*a].tile, {0, 0, 0}, {0, 0, 0}, ancestors_[*a].face});
        ancestor_face_.push_back(ancestors_[*a].face);
      }
      result_.first.push_back(result_.layers.size());
    }
    read_heights();
    return std::move(result_);
  }

 private:
  void refine(const std::vector<Tin>& tiles, const std::vector<int>& order) {
    for (std::size_t rank = 0; rank < order.size(); ++rank) {
      context_.progress("merge", static_cast<double>(rank) / static_cast<double>(order.size()));
      Piece tile = flat(pieces_[rank]);
      for (std::size_t f = 0; f < tile.contributors.size(); ++f)
        tile.contributors[f] = ancestor(cells_.fresh(), {static_cast<int>(rank), static_cast<Index>(f), none});
      tile.cells = tile.contributors;
      const Piece near = mosaic_.take_near(widened(bounds(tiles[order[rank]])));
      mosaic_.add(near.contributors.empty() ? tile : overlaid(near, tile));
    }
  }

  /// Stored once for each cell.
  Index ancestor(Index cell, const Ancestor& own) {
    if (cell == static_cast<Index>(ancestors_.size())) ancestors_.push_back(own);
    return cell;
  }

  Piece overlaid(const Piece& near, const Piece& tile) {
    Overlay overlay = terrane::overlay(as_tin(near), as_tin(tile), {}, context_);
    accumulate(report_, overlay.rounding);
    Piece result;
    for (const auto& [a, b] : overlay.parents) {
      if (a == none || b == none) {
        result.contributors.push_back(a == none ? tile.contributors[b] : near.contributors[a]);
        continue;
      }
      const Ancestor& own = ancestors_[tile.contributors[b]];
      const Ancestor last{own.tile, own.face, near.contributors[a]};
      result.contributors.push_back(ancestor(cells_.both(near.contributors[a], tile.contributors[b]), last));
    }
    result.surface.points = std::move(overlay.points);
    result.surface.faces = std::move(overlay.faces);
    result.surface.z.assign(3 * result.surface.faces.size(), 0);
    result.surface.firm.assign(result.surface.z.size(), 1);
    result.cells = result.contributors;
    return without_needless(std::move(result), near, tile, 2 * overlay.rounding.max_move);
  }

  /// A layer of a face.
  struct Entry {
    std::size_t layer;
    Index face;
  };

  void read_heights() {
    std::vector<std::vector<Entry>> by_tile(pieces_.size());
    for (std::size_t f = 0; f < result_.faces.size(); ++f)
      for (std::size_t l = result_.first[f]; l < result_.first[f + 1]; ++l) {
        const Own own = own_face(l);
        result_.layers[l].slope = slope_of_triangle(own.at, own.z);
        by_tile[result_.layers[l].tile].push_back({l, static_cast<Index>(f)});
      }
    first_height_.assign(result_.points.size(), none);
    for (auto& entries : by_tile) {
      // Where rounding moved a vertex off an edge, the flatter of the two faces there knows the height better.
      std::stable_sort(entries.begin(), entries.end(), [&](const Entry& a, const Entry& b) {
        return result_.layers[a.layer].slope < result_.layers[b.layer].slope;
      });
      for (const Entry& e : entries) read_vertices(e);
      for (const Entry& e : entries) read_others(e);
      for (const Entry& e : entries)
        for (const Index v : result_.faces[e.face]) first_height_[v] = none;
      heights_.clear();
      next_height_.clear();
    }
  }

  struct Own {
    Point2 at[3];
    double z[3];
  };
  Own own_face(std::size_t layer) const {
    const CornerSurface& surface = pieces_[result_.layers[layer].tile].surface;
    const Index face = ancestor_face_[layer];
    Own own;
    for (int k = 0; k < 3; ++k) {
      own.at[k] = surface.points[surface.faces[face][k]];
      own.z[k] = surface.z[3 * static_cast<std::size_t>(face) + k];
    }
    return own;
  }

  void read_vertices(const Entry& e) {
    const Own own = own_face(e.layer);
    Layer& layer = result_.layers[e.layer];
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j)
        if (own.at[j] == result_.points[result_.faces[e.face][k]]) {
          layer.z[k] = own.z[j];
          layer.firm[k] = 1;
          remember(result_.faces[e.face][k], own.z[j]);
        }
  }

  void read_others(const Entry& e) {
    const Own own = own_face(e.layer);
    Layer& layer = result_.layers[e.layer];
    const HeightError error = height_error(own.at, own.z, report_.max_move + report_.max_snap);
    for (int k = 0; k < 3; ++k) {
      if (layer.firm[k]) continue;
      const Index v = result_.faces[e.face][k];
      const double z = height_on_triangle(own.at, own.z, result_.points[v]);
      layer.z[k] = z;
      bool known = false;
      for (Index i = first_height_[v]; i != none && !known; i = next_height_[i])
        if ((known = error.covers(z, heights_[i]))) layer.z[k] = heights_[i];
      if (!known) remember(v, z);
    }
  }

  void remember(Index place, double z) {
    Index* link = &first_height_[place];
    while (*link != none) {
      if (heights_[*link] == z) return;
      link = &next_height_[*link];
    }
    *link = static_cast<Index>(heights_.size());
    heights_.push_back(z);
    next_height_.push_back(none);
  }

  RoundingReport& report_;
  Context& context_;
  std::vector<Piece> pieces_;
  Cells cells_;
  std::vector<Ancestor> ancestors_;  // by cell
  Mosaic mosaic_;
  Layered result_;
  std::vector<Index> ancestor_face_;  // per layer
  // The heights of one tile at every place, in a list each.
  std::vector<Index> first_height_, next_height_;
  std::vector<double> heights_;
};

}  // namespace

Layered layers_of(const std::vector<Tin>& tiles, const std::vector<int>& order, RoundingReport& report,
                  Context& context) {
  return Refiner(tiles, order, report, context).run();
}

}  // namespace terrane
