// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/section.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/plan/crossing_point.hpp"
#include "core/predicates.hpp"
#include "core/triangle_height.hpp"

namespace terrane {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A place of a segment with the height of a face there.
struct Place {
  double along, z;
  Point2 at;
};

/// What a face has of a segment.
struct Piece {
  std::size_t surface;
  Place from, to;
};

/// Stations nearer to each other than this, in parts of a segment, are one: rounding.
constexpr double same_station = 1e-13;

bool same(double a, double b) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) && std::isnan(b);
  return std::fabs(a - b) <= 1e-9 * std::max({1.0, std::fabs(a), std::fabs(b)});
}

/// One segment of the line.
class Segment {
 public:
  Segment(Point2 p, Point2 q) : p_(p), q_(q) {}

  void cut(const FaceGrid& grid, std::size_t surface, std::vector<Piece>& pieces) const {
    for (const Index f : grid.along(p_, q_)) cut(grid.tin(), grid.tin().faces[f], surface, pieces);
  }

 private:
  void cut(const Tin& tin, const Face& face, std::size_t surface, std::vector<Piece>& pieces) const {
    std::array<int, 3> side;
    for (int k = 0; k < 3; ++k) side[k] = orientation(p_, q_, plan(tin.vertices[face[k]]));
    if (side[0] == side[1] && side[1] == side[2]) return;
    std::array<Place, 4> places;
    int count = 0;
    for (int k = 0; k < 3; ++k) {
      const Point &a = tin.vertices[face[k]], &b = tin.vertices[face[(k + 1) % 3]];
      if (side[k] == 0) places[count++] = at_vertex(a);
      if (side[k] * side[(k + 1) % 3] < 0) places[count++] = at_edge(a, b);
    }
    if (count != 2) return;  // it touches a corner
    Place &from = places[0], &to = places[1];
    if (to.along < from.along) std::swap(from, to);
    if (!(from.along < 1 && to.along > 0)) return;
    if (from.along < 0) from = end(tin, face, p_, 0);
    if (to.along > 1) to = end(tin, face, q_, 1);
    pieces.push_back({surface, from, to});
  }

  Place at_vertex(const Point& v) const {
    const double dx = q_.x - p_.x, dy = q_.y - p_.y;
    const double along = std::fabs(dx) >= std::fabs(dy) ? (v.x - p_.x) / dx : (v.y - p_.y) / dy;
    return {along, v.z, plan(v)};
  }

  /// The same from both faces of an edge: its ends are taken in one order.
  Place at_edge(const Point& a, const Point& b) const {
    if (b.x < a.x || (b.x == a.x && b.y < a.y)) return at_edge(b, a);
    const double before = area2_accurate(plan(a), plan(b), p_), behind = area2_accurate(plan(a), plan(b), q_);
    const double to_a = std::fabs(area2_accurate(p_, q_, plan(a))), to_b = std::fabs(area2_accurate(p_, q_, plan(b)));
    return {before / (before - behind), mix(a.z, b.z, to_a / (to_a + to_b)),
            crossing_point(p_, q_, plan(a), plan(b), to_a, to_b)};
  }

  static Place end(const Tin& tin, const Face& face, Point2 at, double along) {
    const Point &a = tin.vertices[face[0]], &b = tin.vertices[face[1]], &c = tin.vertices[face[2]];
    return {along, height_on_triangle({plan(a), plan(b), plan(c)}, {a.z, b.z, c.z}, at), at};
  }

  Point2 p_, q_;
};

/// The stations of one segment with the heights before and behind each.
class Stations {
 public:
  Stations(Point2 p, Point2 q, std::size_t surfaces, std::vector<Piece>& pieces) : surfaces_(surfaces) {
    collect(p, q, pieces);
    before_.assign(stations_.size() * surfaces, nan);
    behind_ = before_;
    for (const Piece& piece : pieces) put(piece);
  }

  std::size_t size() const { return stations_.size(); }
  const Place& operator[](std::size_t k) const { return stations_[k]; }
  const double* before(std::size_t k) const { return before_.data() + k * surfaces_; }
  const double* behind(std::size_t k) const { return behind_.data() + k * surfaces_; }

 private:
  void collect(Point2 p, Point2 q, const std::vector<Piece>& pieces) {
    std::vector<Place> all = {{0, 0, p}, {1, 0, q}};
    for (const Piece& piece : pieces) all.push_back(piece.from), all.push_back(piece.to);
    std::sort(all.begin(), all.end(), [](const Place& a, const Place& b) {
      return a.along != b.along ? a.along < b.along : a.at.x != b.at.x ? a.at.x < b.at.x : a.at.y < b.at.y;
    });
    // The ends of the segment stay what they are.
    stations_.push_back({0, 0, p});
    for (const Place& place : all)
      if (place.along - stations_.back().along > same_station && 1 - place.along > same_station)
        stations_.push_back(place);
    stations_.push_back({1, 0, q});
  }

  std::size_t station_at(double along) const {
    const auto next = std::lower_bound(stations_.begin(), stations_.end(), along,
                                       [](const Place& s, double value) { return s.along < value; });
    const auto k = static_cast<std::size_t>(next - stations_.begin());
    if (k == stations_.size()) return k - 1;
    return k > 0 && along - stations_[k - 1].along < stations_[k].along - along ? k - 1 : k;
  }

  /// Of faces beside each other under one part of the segment, the upper one is kept.
  void put(const Piece& piece) {
    const std::size_t first = station_at(piece.from.along), last = station_at(piece.to.along);
    const auto z_at = [&](std::size_t k) {
      if (k == first) return piece.from.z;
      if (k == last) return piece.to.z;
      const double t = (stations_[k].along - piece.from.along) / (piece.to.along - piece.from.along);
      return mix(piece.from.z, piece.to.z, std::clamp(t, 0.0, 1.0));
    };
    for (std::size_t k = first; k < last; ++k) {
      double& from = behind_[k * surfaces_ + piece.surface];
      double& to = before_[(k + 1) * surfaces_ + piece.surface];
      const double z0 = z_at(k), z1 = z_at(k + 1);
      if (!std::isnan(from) && !(z0 + z1 > from + to || (z0 + z1 == from + to && z0 > from))) continue;
      from = z0;
      to = z1;
    }
  }

  std::size_t surfaces_;
  std::vector<Place> stations_;
  std::vector<double> before_, behind_;  // per station and surface
};

/// Rows as they come, two where what lies before and behind differs.
class Table {
 public:
  explicit Table(Section& section) : section_(section) {}

  /// Either side may be null: there is no line there.
  void add(const Section::Row& row, const double* before, const double* behind) {
    const std::size_t n = section_.surfaces;
    const bool jumps = before && behind && !std::equal(before, before + n, behind, same);
    if (jumps) put(row, before);
    put(row, behind ? behind : before);
  }

 private:
  void put(const Section::Row& row, const double* z) {
    section_.rows.push_back(row);
    section_.z.insert(section_.z.end(), z, z + section_.surfaces);
  }

  Section& section_;
};

}  // namespace

Section section(std::span<const Point2> line, std::span<const FaceGrid* const> surfaces, Context& context) {
  Section out;
  out.surfaces = surfaces.size();
  Table table(out);
  std::vector<double> before;  // at the corner between two segments
  for (std::size_t s = 0; s + 1 < line.size(); ++s) {
    context.progress("profile", static_cast<double>(s) / static_cast<double>(line.size()));
    const Segment segment(line[s], line[s + 1]);
    std::vector<Piece> pieces;
    for (std::size_t i = 0; i < surfaces.size(); ++i) segment.cut(*surfaces[i], i, pieces);
    const Stations stations(line[s], line[s + 1], surfaces.size(), pieces);
    for (std::size_t k = 0; k + 1 < stations.size(); ++k) {
      const double* left = k > 0 ? stations.before(k) : s > 0 ? before.data() : nullptr;
      table.add({s, stations[k].along, stations[k].at}, left, stations.behind(k));
    }
    const std::size_t last = stations.size() - 1;
    before.assign(stations.before(last), stations.before(last) + surfaces.size());
    if (s + 2 == line.size()) table.add({s, 1, line[s + 1]}, before.data(), nullptr);
  }
  return out;
}

}  // namespace terrane
