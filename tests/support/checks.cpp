// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/checks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <sstream>
#include <tuple>

#include "core/predicates.hpp"
#include "core/validate.hpp"

namespace terrane::support {
namespace {

int cell_of(double v, double lo, double hi, int size) {
  return hi > lo ? std::clamp(static_cast<int>((v - lo) / (hi - lo) * size), 0, size - 1) : 0;
}

double distance(Point2 p, Point2 a, Point2 b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double t = std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return std::hypot(a.x + t * dx - p.x, a.y + t * dy - p.y);
}

using Place = std::pair<double, double>;
Place place(const Point& p) { return {p.x, p.y}; }

}  // namespace

Sampler::Sampler(const Tin& tin) : tin_(tin), box_(bounds(tin)) {
  size_ = std::max(1, static_cast<int>(std::sqrt(tin.faces.size() / 2.0)));
  cells_.resize(static_cast<std::size_t>(size_) * size_);
  for (std::size_t f = 0; f < tin.faces.size(); ++f) {
    if (is_wall(tin, tin.faces[f])) continue;
    int lo[2] = {size_, size_}, hi[2] = {-1, -1};
    for (const Index v : tin.faces[f]) {
      const int c[2] = {cell_of(tin.vertices[v].x, box_.xmin, box_.xmax, size_),
                        cell_of(tin.vertices[v].y, box_.ymin, box_.ymax, size_)};
      for (int i : {0, 1}) lo[i] = std::min(lo[i], c[i]), hi[i] = std::max(hi[i], c[i]);
    }
    for (int j = lo[1]; j <= hi[1]; ++j)
      for (int i = lo[0]; i <= hi[0]; ++i)
        cells_[static_cast<std::size_t>(j) * size_ + i].push_back(static_cast<Index>(f));
  }
}

const std::vector<Index>& Sampler::near(Point2 at) const {
  if (!(at.x >= box_.xmin && at.x <= box_.xmax && at.y >= box_.ymin && at.y <= box_.ymax)) return empty_;
  const std::size_t row = cell_of(at.y, box_.ymin, box_.ymax, size_);
  return cells_[row * size_ + cell_of(at.x, box_.xmin, box_.xmax, size_)];
}

double Sampler::operator()(Point2 at) const {
  for (const Index f : near(at)) {
    const Point &a = tin_.vertices[tin_.faces[f][0]], &b = tin_.vertices[tin_.faces[f][1]],
                &c = tin_.vertices[tin_.faces[f][2]];
    if (orientation(plan(a), plan(b), at) < 0 || orientation(plan(b), plan(c), at) < 0 ||
        orientation(plan(c), plan(a), at) < 0)
      continue;
    const double wa = area2_accurate(plan(b), plan(c), at), wb = area2_accurate(plan(c), plan(a), at),
                 wc = area2_accurate(plan(a), plan(b), at), sum = wa + wb + wc;
    return wa / sum * a.z + wb / sum * b.z + wc / sum * c.z;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

bool Sampler::clear_of_edges(Point2 at, double clearance) const {
  for (const Index f : near(at))
    for (int k = 0; k < 3; ++k)
      if (distance(at, plan(tin_.vertices[tin_.faces[f][k]]), plan(tin_.vertices[tin_.faces[f][(k + 1) % 3]])) <
          clearance)
        return false;
  return true;
}

std::vector<Point2> random_places(const Box& box, int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&](double lo, double hi) {
    return lo + (hi - lo) * (static_cast<double>(random() >> 11) * 0x1p-53);
  };
  std::vector<Point2> places(count);
  for (Point2& p : places) p.x = uniform(box.xmin, box.xmax), p.y = uniform(box.ymin, box.ymax);
  return places;
}

std::string wrong_with(const Tin& tin) {
  std::ostringstream wrong;
  const Inspection seen = inspect(tin);
  const std::pair<const char*, std::size_t> counts[] = {{"inverted", seen.inverted},
                                                        {"degenerate", seen.degenerate},
                                                        {"t-junctions", seen.t_junctions},
                                                        {"non-manifold edges", seen.non_manifold_edges},
                                                        {"overlaps", seen.overlaps}};
  for (const auto& [name, count] : counts)
    if (count > 0) wrong << count << " " << name << "; ";
  std::set<std::tuple<double, double, double>> places;
  for (const Point& p : tin.vertices)
    if (!places.emplace(p.x, p.y, p.z).second) wrong << "two vertices at " << p.x << " " << p.y << " " << p.z << "; ";
  if (!(canonical(tin) == tin)) wrong << "not canonical; ";
  return wrong.str();
}

std::string open_seams(const Tin& tin) {
  std::map<std::pair<Place, Place>, int> flat;
  std::map<std::pair<Index, Index>, int> directed;
  for (const Face& f : tin.faces)
    for (int k = 0; k < 3; ++k) {
      const Index u = f[k], v = f[(k + 1) % 3];
      ++directed[{u, v}];
      --directed[{v, u}];
      if (is_wall(tin, f)) continue;
      ++flat[{place(tin.vertices[u]), place(tin.vertices[v])}];
      --flat[{place(tin.vertices[v]), place(tin.vertices[u])}];
    }
  std::set<Place> border;
  for (const auto& [edge, count] : flat)
    if (count != 0) border.insert(edge.first), border.insert(edge.second);
  std::ostringstream open;
  for (const auto& [edge, count] : directed) {
    if (count <= 0) continue;
    const Point &u = tin.vertices[edge.first], &v = tin.vertices[edge.second];
    const bool vertical = plan(u) == plan(v);
    const auto on_plan = flat.find({place(u), place(v)});
    const bool at_border = vertical ? border.contains(place(u)) : on_plan != flat.end() && on_plan->second != 0;
    if (!at_border)
      open << "edge " << u.x << " " << u.y << " " << u.z << " - " << v.x << " " << v.y << " " << v.z << "; ";
  }
  return open.str();
}

std::size_t missing_vertices(const Tin& tin, const Tin& result) {
  std::set<std::tuple<double, double, double>> there;
  for (const Point& p : result.vertices) there.emplace(p.x, p.y, p.z);
  std::size_t missing = 0;
  for (const Point& p : tin.vertices) missing += !there.contains({p.x, p.y, p.z});
  return missing;
}

}  // namespace terrane::support
