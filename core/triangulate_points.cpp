// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/triangulate_points.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_plus_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>
#include <unordered_map>

#include "core/box.hpp"
#include "core/error.hpp"
#include "core/mesh/hilbert.hpp"
#include "core/shortest.hpp"
#include "core/surface/mend.hpp"

namespace terrane {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<Index, Kernel>;
using FaceBase = CGAL::Constrained_triangulation_face_base_2<Kernel>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
// Crossings are constructed in doubles and are vertices from then on: all that follows is exact about these.
using Delaunay = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::Exact_predicates_tag>;
using Constrained = CGAL::Constrained_triangulation_plus_2<Delaunay>;
using VertexHandle = Constrained::Vertex_handle;
using FaceHandle = Constrained::Face_handle;

bool same_place(const Point& a, const Point& b) { return a.x == b.x && a.y == b.y; }

/// Places with heights that contradict each other, the first 20 of them by name.
class Contradictions {
 public:
  void add(const Point& p, double z) {
    if (count_++ < 20)
      text_ += (count_ > 1 ? "; " : "") + shortest(p.x) + " " + shortest(p.y) + " (" + shortest(p.z) + " and " +
               shortest(z) + ")";
  }
  void refuse_any(const char* what) const {
    if (count_ > 0)
      throw Error(ErrorKind::input, "different-heights",
                  std::string(what) + " at " + std::to_string(count_) + " places: " + text_ +
                      (count_ > 20 ? "; ..." : "") + "; correct them, or ask for their mean with duplicates=mean");
  }

 private:
  std::size_t count_ = 0;
  std::string text_;
};

class Surveyor {
 public:
  Surveyor(const SurveyOptions& options, Context& context) : options_(options), context_(context) {}

  Survey make(std::vector<Point> points, const std::vector<Line>& breaklines) {
    survey_.duplicates = doubled(points);
    for (const Line& line : breaklines) points.insert(points.end(), line.begin(), line.end());
    points_ = one_per_place(std::move(points));
    insert_points();
    insert_breaklines(breaklines);
    if (triangulation_.dimension() < 2)
      throw Error(ErrorKind::input, "too-few-points",
                  "a surface needs at least three points that do not lie on one line in plan");
    find_heights_of_crossings();
    collect_faces();
    if (options_.max_edge > 0) peel();
    survey_.tin = canonical(Tin{std::move(points_), std::move(faces_)}, context_);
    return std::move(survey_);
  }

 private:
  /// How many points lie at the place of another. Sorts them.
  static std::size_t doubled(std::vector<Point>& points) {
    for (Point& p : points) p.x += 0.0, p.y += 0.0;  // -0 is 0
    std::sort(points.begin(), points.end(),
              [](const Point& a, const Point& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); });
    std::size_t count = 0;
    for (std::size_t i = 1; i < points.size(); ++i) count += same_place(points[i - 1], points[i]);
    return count;
  }

  /// Sorted by place. Corners of breaklines without a height stand last at their place.
  std::vector<Point> one_per_place(std::vector<Point> points) {
    const std::size_t all = points.size();
    std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) {
      return std::tuple(a.x, a.y, std::isnan(a.z), a.z) < std::tuple(b.x, b.y, std::isnan(b.z), b.z);
    });
    std::vector<Point> kept;
    Contradictions contradictions;
    for (std::size_t i = 0; i < all;) {
      const std::size_t first = i;
      double sum = 0;
      std::size_t heights = 0;
      for (; i < all && same_place(points[i], points[first]); ++i)
        if (!std::isnan(points[i].z)) sum += points[i].z, ++heights;
      Point p = points[first];
      if (heights == 0)
        throw Error(
            ErrorKind::input, "no-height",
            "a corner of a breakline has no height, and no point lies there: " + shortest(p.x) + " " + shortest(p.y));
      const double highest = points[first + heights - 1].z;
      if (highest - p.z > height_rounding(p.z)) {
        if (!options_.average) contradictions.add(p, highest);
        p.z = sum / static_cast<double>(heights);
        ++survey_.averaged;
      }
      kept.push_back(p);
    }
    contradictions.refuse_any("points have different heights");
    return kept;
  }

  void insert_points() {
    context_.progress("triangulate", 0);
    Box box = no_box;
    for (const Point& p : points_) box = around(box, plan(p));
    handles_.resize(points_.size());
    FaceHandle near;
    std::size_t done = 0;
    for (const Index v : along_hilbert(box)) {
      const VertexHandle vertex = triangulation_.insert(Kernel::Point_2(points_[v].x, points_[v].y), near);
      vertex->info() = v;
      handles_[v] = vertex;
      near = vertex->face();
      if (++done % 65536 == 0) {
        context_.stop_if_cancelled();
        context_.progress("triangulate", static_cast<double>(done) / static_cast<double>(points_.size()));
      }
    }
  }

  std::vector<Index> along_hilbert(const Box& box) const {
    std::vector<std::pair<std::uint64_t, Index>> order;
    const HilbertCurve curve(box);
    for (std::size_t v = 0; v < points_.size(); ++v)
      order.emplace_back(curve.key(points_[v].x, points_[v].y), static_cast<Index>(v));
    std::sort(order.begin(), order.end());
    std::vector<Index> indices;
    for (const auto& [key, v] : order) indices.push_back(v);
    return indices;
  }

  VertexHandle handle_at(const Point& p) const {
    const auto at = std::lower_bound(points_.begin(), points_.end(), p, [](const Point& a, const Point& b) {
      return std::tie(a.x, a.y) < std::tie(b.x, b.y);
    });
    return handles_[at - points_.begin()];
  }

  /// Segments in the order of their places: where they cross must not depend on which line came first.
  void insert_breaklines(const std::vector<Line>& breaklines) {
    std::vector<std::array<Index, 2>> segments;
    for (const Line& line : breaklines)
      for (std::size_t i = 1; i < line.size(); ++i) {
        const Index a = handle_at(line[i - 1])->info(), b = handle_at(line[i])->info();
        if (a != b) segments.push_back({std::min(a, b), std::max(a, b)});
      }
    std::sort(segments.begin(), segments.end());
    segments.erase(std::unique(segments.begin(), segments.end()), segments.end());
    for (std::size_t i = 0; i < segments.size(); ++i) {
      if (i % 4096 == 0) context_.stop_if_cancelled();
      triangulation_.insert_constraint(handles_[segments[i][0]], handles_[segments[i][1]]);
    }
  }

  /// Crossings are the vertices that no point has made. On every segment through one its height is that of the line
  /// between the nearest points on either side.
  void find_heights_of_crossings() {
    const std::size_t known = points_.size();
    for (auto v = triangulation_.finite_vertices_begin(); v != triangulation_.finite_vertices_end(); ++v) {
      const Index number = v->info();
      if (number >= 0 && static_cast<std::size_t>(number) < known && handles_[number] == VertexHandle(v)) continue;
      v->info() = static_cast<Index>(points_.size());
      points_.push_back({v->point().x(), v->point().y(), NAN});
    }
    survey_.crossings = points_.size() - known;
    if (survey_.crossings == 0) return;
    std::vector<std::vector<double>> heights(survey_.crossings);
    for (auto c = triangulation_.constraints_begin(); c != triangulation_.constraints_end(); ++c) {
      std::vector<Index> along;
      for (auto v = triangulation_.vertices_in_constraint_begin(*c); v != triangulation_.vertices_in_constraint_end(*c);
           ++v)
        along.push_back((*v)->info());
      note_heights(along, known, heights);
    }
    Contradictions contradictions;
    for (std::size_t i = 0; i < heights.size(); ++i) {
      auto& z = heights[i];
      if (z.empty()) throw Error(ErrorKind::internal, "points", "a crossing on no breakline");
      std::sort(z.begin(), z.end());
      double sum = 0;
      for (const double height : z) sum += height;
      Point& p = points_[known + i];
      p.z = sum / static_cast<double>(z.size());
      // Heights along lines are rounded, and so are crossings.
      if (z.back() - z.front() <= 16 * height_rounding(p.z)) continue;
      ++survey_.averaged;
      if (!options_.average) contradictions.add({p.x, p.y, z.front()}, z.back());
    }
    contradictions.refuse_any("breaklines cross at different heights");
  }

  void note_heights(const std::vector<Index>& along, std::size_t known,
                    std::vector<std::vector<double>>& heights) const {
    const auto distance = [&](Index a, Index b) {
      return std::hypot(points_[a].x - points_[b].x, points_[a].y - points_[b].y);
    };
    const auto is_known = [&](Index v) { return static_cast<std::size_t>(v) < known; };
    for (std::size_t i = 0; i < along.size(); ++i) {
      if (is_known(along[i])) continue;
      std::size_t before = i, after = i;
      while (!is_known(along[before])) --before;
      while (!is_known(along[after])) ++after;
      const Index a = along[before], b = along[after];
      const double from_a = distance(a, along[i]), from_b = distance(b, along[i]), whole = from_a + from_b;
      const double z = whole > 0 ? (points_[a].z * from_b + points_[b].z * from_a) / whole : points_[a].z;
      heights[along[i] - known].push_back(z);
    }
  }

  void collect_faces() {
    Index count = 0;
    std::vector<FaceHandle> all;
    for (auto f = triangulation_.finite_faces_begin(); f != triangulation_.finite_faces_end(); ++f) {
      const Index a = f->vertex(0)->info(), b = f->vertex(1)->info(), c = f->vertex(2)->info();
      faces_.push_back({a, b, c});
      all.push_back(f);
    }
    if (options_.max_edge <= 0) return;
    std::unordered_map<FaceHandle, Index> number;
    for (const FaceHandle f : all) number[f] = count++;
    for (const FaceHandle f : all) {
      std::array<Index, 3> across;
      for (int k = 0; k < 3; ++k) {  // across the edge from corner k to the next
        const FaceHandle g = f->neighbor((k + 2) % 3);
        across[k] = triangulation_.is_infinite(g) ? none : number.at(g);
      }
      across_.push_back(across);
    }
  }

  bool too_long(Index a, Index b) const {
    const Point2 p = plan(points_[a]), q = plan(points_[b]);
    return (options_.length ? options_.length(p, q) : std::hypot(p.x - q.x, p.y - q.y)) > options_.max_edge;
  }

  /// Takes faces away that have an edge too long, from the border inwards.
  void peel() {
    std::vector<bool> gone(faces_.size());
    std::queue<Index> border;
    const auto look_at = [&](Index f) {
      if (gone[f]) return;
      const Face& face = faces_[f];
      if (!too_long(face[0], face[1]) && !too_long(face[1], face[2]) && !too_long(face[2], face[0])) return;
      gone[f] = true;
      border.push(f);
    };
    for (std::size_t f = 0; f < faces_.size(); ++f)
      if (across_[f][0] == none || across_[f][1] == none || across_[f][2] == none) look_at(static_cast<Index>(f));
    for (; !border.empty(); border.pop())
      for (const Index beyond : across_[border.front()])
        if (beyond != none) look_at(beyond);
    std::vector<Face> left;
    std::vector<bool> used(points_.size());
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      if (gone[f]) continue;
      left.push_back(faces_[f]);
      for (const Index v : faces_[f]) used[v] = true;
    }
    if (left.empty())
      throw Error(ErrorKind::input, "empty-result", "every face has an edge longer than max-edge; choose a longer one");
    faces_ = std::move(left);
    survey_.left_out = static_cast<std::size_t>(std::count(used.begin(), used.end(), false));
  }

  const SurveyOptions& options_;
  Context& context_;
  std::vector<Point> points_;  // sorted by place, then the crossings
  Constrained triangulation_;
  std::vector<VertexHandle> handles_;
  std::vector<Face> faces_;
  std::vector<std::array<Index, 3>> across_;
  Survey survey_;
};

}  // namespace

Survey triangulate_points(std::vector<Point> points, const std::vector<Line>& breaklines, const SurveyOptions& options,
                          Context& context) {
  return Surveyor(options, context).make(std::move(points), breaklines);
}

}  // namespace terrane
