// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <map>

#include "core/merge/bisected_mesh.hpp"
#include "core/merge/blend.hpp"
#include "core/merge/line_distance.hpp"
#include "core/mosaic.hpp"
#include "core/plan/delaunay.hpp"
#include "core/rounding/rounding.hpp"

namespace terrane {
namespace {

constexpr Index most_made = 8'000'000;

bool is_a(const Overlay& overlay, Index face) { return overlay.parents[face][0] != none; }

/// The seam, edge by edge and vertex by vertex, and how far the surface that stays lies above the one that bends.
struct SeamLine {
  std::vector<LineDistance::Segment> segments;
  std::vector<std::array<Index, 2>> edges;  // ends, by vertex below
  std::vector<Point> vertices;              // z: the difference
};

SeamLine seam_of(const Overlay& overlay, bool bends_a) {
  PlanarMesh mesh{overlay.points, overlay.faces, {}, {}};
  connect(mesh);
  SeamLine seam;
  std::vector<Index> number(overlay.points.size(), none);
  for (Index f = 0; f < static_cast<Index>(overlay.faces.size()); ++f)
    for (int k = 0; is_a(overlay, f) && k < 3; ++k) {
      const Index g = mesh.neighbours[f][k];
      if (g == none || is_a(overlay, g)) continue;
      std::array<Index, 2> edge;
      for (const int end : {0, 1}) {
        const int corner = (k + 1 + end) % 3;
        const Index v = overlay.faces[f][corner];
        if (number[v] == none) {
          int j = 0;
          while (overlay.faces[g][j] != v) ++j;
          const double above = overlay.height(0, f, corner) - overlay.height(1, g, j);
          number[v] = static_cast<Index>(seam.vertices.size());
          seam.vertices.push_back({overlay.points[v].x, overlay.points[v].y, bends_a ? -above : above});
        }
        edge[end] = number[v];
      }
      seam.edges.push_back(edge);
      seam.segments.push_back({plan(seam.vertices[edge[0]]), plan(seam.vertices[edge[1]])});
    }
  return seam;
}

/// Places of a lattice between one and two widths from the seam, with the difference at the nearest place of it.
std::vector<Point> ring_around(const SeamLine& seam, const BlendOptions& options) {
  const double step = options.width / 2;
  std::vector<std::pair<std::int64_t, std::int64_t>> places;
  for (const auto& [p, q] : seam.segments) {
    const double px = p.x * options.metric.x, py = p.y * options.metric.y;
    const double dx = q.x * options.metric.x - px, dy = q.y * options.metric.y - py;
    const int parts = static_cast<int>(std::ceil(std::hypot(dx, dy) / options.width));
    for (int part = 0; part < std::max(parts, 1); ++part) {
      const double t = (part + 0.5) / std::max(parts, 1);
      const auto column = static_cast<std::int64_t>(std::floor((px + t * dx) / step));
      const auto row = static_cast<std::int64_t>(std::floor((py + t * dy) / step));
      for (std::int64_t i = -5; i <= 6; ++i)
        for (std::int64_t j = -5; j <= 6; ++j) places.emplace_back(column + i, row + j);
    }
    if (places.size() > 10'000'000) {
      std::sort(places.begin(), places.end());
      places.erase(std::unique(places.begin(), places.end()), places.end());
    }
  }
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  const LineDistance lines(seam.segments, options.metric, false);
  std::vector<Point> ring;
  for (const auto& [column, row] : places) {
    const Point2 at = {static_cast<double>(column) * step / options.metric.x,
                       static_cast<double>(row) * step / options.metric.y};
    const LineDistance::Nearest near = lines.nearest(at);
    if (near.distance < options.width || near.distance > 2 * options.width) continue;
    const auto [p, q] = seam.edges[near.segment];
    const double zp = seam.vertices[p].z, zq = seam.vertices[q].z;
    ring.push_back({at.x, at.y, zp + near.t * (zq - zp)});
  }
  return ring;
}

OverTriangle distance_over(const LineDistance& lines, const std::array<Point2, 3>& at, double width) {
  std::array<double, 3> known;
  for (int k = 0; k < 3; ++k) known[k] = lines.at(at[k], width);
  return lines.over(at, known, width);
}

/// The difference as a surface, as far as the width reaches.
Tin difference_around(const SeamLine& seam, const LineDistance& lines, const BlendOptions& options) {
  std::vector<Point> vertices = seam.vertices;
  for (const Point& p : ring_around(seam, options)) vertices.push_back(p);
  Tin all = constrained_delaunay(vertices, seam.edges);
  std::erase_if(all.faces, [&](const Face& f) {
    const OverTriangle d = distance_over(
        lines, {plan(all.vertices[f[0]]), plan(all.vertices[f[1]]), plan(all.vertices[f[2]])}, options.width);
    return d.error() == 0 && d.at == constant(options.width).at;
  });
  return canonical(std::move(all));
}

/// The faces that bend, or the others, as a piece whose contributors are the faces of the overlay.
Piece part_of(const Overlay& overlay, bool of_a) {
  Piece piece;
  piece.surface.points = overlay.points;
  for (Index f = 0; f < static_cast<Index>(overlay.faces.size()); ++f) {
    if (is_a(overlay, f) != of_a) continue;
    piece.surface.faces.push_back(overlay.faces[f]);
    for (int k = 0; k < 3; ++k) {
      piece.surface.z.push_back(overlay.height(of_a ? 0 : 1, f, k));
      piece.surface.firm.push_back(0);
    }
    piece.contributors.push_back(f);
  }
  return piece;
}

class Bender {
 public:
  Bender(const Overlay& overlay, const BlendOptions& options)
      : options_(options),
        bends_a_(options.side == BlendSide::inside),
        seam_(seam_of(overlay, bends_a_)),
        lines_(seam_.segments, options.metric, true),
        stays_(part_of(overlay, !bends_a_)),
        bends_(part_of(overlay, bends_a_)) {}

  Bent run(Context& context) {
    Bent result;
    if (seam_.segments.empty()) {
      join(bends_, std::vector<double>(bends_.surface.z.size(), 0));
    } else {
      divide(result, context);
    }
    BisectedMesh mesh(joined_.surface.points, joined_.surface.faces, {difference_, joined_.surface.z}, options_.metric);
    if (!seam_.segments.empty()) refine(mesh, result, context);
    hand_over(mesh, result);
    return result;
  }

 private:
  /// Divides what bends until the difference is linear on its faces.
  void divide(Bent& result, Context& context) {
    const Tin difference = difference_around(seam_, lines_, options_);
    const Overlay both = overlay(as_tin(bends_), difference, {}, context);
    result.rounding = both.rounding;
    Piece divided;
    std::vector<double> above;
    divided.surface.points = both.points;
    for (Index f = 0; f < static_cast<Index>(both.faces.size()); ++f) {
      if (both.parents[f][0] == none) continue;
      divided.surface.faces.push_back(both.faces[f]);
      divided.contributors.push_back(bends_.contributors[both.parents[f][0]]);
      for (int k = 0; k < 3; ++k) {
        divided.surface.z.push_back(both.height(0, f, k));
        divided.surface.firm.push_back(0);
        above.push_back(both.parents[f][1] == none ? 0 : both.height(1, f, k));
      }
    }
    join(divided, std::move(above));
  }

  /// One mesh of what bends and what stays, so that a vertex made on the seam is one of both.
  void join(const Piece& divided, std::vector<double> above) {
    Mosaic mosaic;
    mosaic.add(divided);
    mosaic.add(stays_);
    joined_ = mosaic.take_all();
    difference_ = std::move(above);
    difference_.resize(joined_.surface.z.size(), 0);
    bending_ = divided.contributors.size();
  }

  void refine(BisectedMesh& mesh, Bent& result, Context& context) {
    std::map<std::pair<double, double>, bool> on;
    for (const Point& p : seam_.vertices) on[{p.x, p.y}] = true;
    on_.clear();
    for (const Point2 p : mesh.points()) on_.push_back(on.contains({p.x, p.y}));
    const auto measure = [&](Point2 p, bool on_seam) {
      distance_.push_back(on_seam ? 0 : lines_.at(p, options_.width));
    };
    for (std::size_t v = 0; v < on_.size(); ++v) measure(mesh.points()[v], on_[v]);
    const auto bends = [&](Index f) { return static_cast<std::size_t>(mesh.label(f)) < bending_; };
    result.report.bound = mesh.refine({[&](Index f) { return error(mesh, f); }, options_.tolerance, bends,
                                       [&](Index m, Index, Index, Index f, Index g) {
                                         on_.push_back(g != none && bends(f) != bends(g));
                                         measure(mesh.points()[m], on_.back());
                                       },
                                       most_made},
                                      context);
    result.report.made = mesh.made();
  }

  double error(const BisectedMesh& mesh, Index f) const {
    std::array<double, 3> d, known;
    std::array<Point2, 3> at;
    for (int k = 0; k < 3; ++k) {
      d[k] = mesh.value(0, f, k);
      at[k] = mesh.points()[mesh.faces()[f][k]];
      known[k] = distance_[mesh.faces()[f][k]];
    }
    const double trivial = 2 * std::max({std::fabs(d[0]), std::fabs(d[1]), std::fabs(d[2])});
    if (trivial <= options_.tolerance) return trivial;
    const OverTriangle share_of_width = scaled(lines_.over(at, known, options_.width), 1 / options_.width);
    if (share_of_width.error() == 0 && share_of_width.at == constant(1).at) return 0;
    return std::min(trivial, error_of_product(share_of_width, d) + 0.0);
  }

  void hand_over(BisectedMesh& mesh, Bent& result) const {
    for (Index f = 0; f < static_cast<Index>(mesh.faces().size()); ++f) {
      bool sloped = false;
      for (int k = 0; k < 3; ++k) {
        const double d = mesh.value(0, f, k), z = mesh.value(1, f, k);
        const double weight = d == 0 ? 0 : 1 - distance_[mesh.faces()[f][k]] / options_.width;
        sloped = sloped || (weight > 0 && d != 0);
        result.surface.z.push_back(weight > 0 ? z + weight * d : z);
      }
      result.sloped.push_back(sloped);
      result.from.push_back(joined_.contributors[mesh.label(f)]);
    }
    result.surface.points = mesh.take_points();
    result.surface.faces = mesh.take_faces();
  }

  BlendOptions options_;
  bool bends_a_;
  SeamLine seam_;
  LineDistance lines_;
  Piece stays_, bends_, joined_;
  std::vector<double> difference_;  // per corner of joined_; 0 where nothing bends
  std::size_t bending_ = 0;         // of its faces, the first
  std::vector<std::uint8_t> on_;    // per vertex: on the seam
  std::vector<double> distance_;    // per vertex, as far as the width
};

}  // namespace

Bent bend(const Overlay& overlay, const BlendOptions& options, Context& context) {
  return Bender(overlay, options).run(context);
}

}  // namespace terrane
