// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/triangulate_greedy.hpp"

#include <algorithm>
#include <cmath>

#include "core/greedy_queue.hpp"
#include "core/lattice_mesh.hpp"
#include "core/lattice_scan.hpp"
#include "core/triangulate_domain.hpp"

namespace terrane {

namespace {

struct Worst {
  double error = 0;
  LatticePoint at;
};

/// Heights as the fast search sees them: row by row from the south, relative to `zero`.
template <class T>
struct Heights {
  std::vector<T> z;
  int width;

  Heights(const Raster& dem, double zero) : z(dem.samples.size()), width(dem.width) {
    for (int y = 0; y < dem.height; ++y) {
      const double* row = dem.samples.data() + static_cast<std::size_t>(dem.height - 1 - y) * width;
      T* to = z.data() + static_cast<std::size_t>(y) * width;
      for (int x = 0; x < width; ++x) to[x] = static_cast<T>(row[x] - zero);
    }
  }
  const T* at(LatticePoint p) const { return z.data() + static_cast<std::size_t>(p.y) * width + p.x; }
};

class Greedy {
 public:
  Greedy(const Raster& dem, const TriangulateOptions& options, Context& context)
      : dem_(dem), options_(options), context_(context), mesh_(dem.width, dem.height) {
    for (const double z : dem.samples) {
      if (z < zmin_) zmin_ = z;
      if (z > zmax_) zmax_ = z;
    }
    for (int x = 0; x < dem.width; ++x) xs_.push_back(dem.place(x, 0).x);
    for (int y = 0; y < dem.height; ++y) ys_.push_back(dem.place(0, dem.height - 1 - y).y);
    LatticeBorder border = find_border(dem, options.max_error);
    // A border that alone takes much of the allowed triangles is refined like the inside.
    if (options.max_triangles > 0 && border.edges.size() > options.max_triangles / 2) {
      free_border_ = true;
      border = find_border(dem, -1);
    }
    mesh_.cut_out(border.points, border.edges);
  }

  Triangulated run() {
    if (mesh_.triangles.empty()) return {};
    const double range = zmax_ - zmin_;
    if (range <= 0x1p12 * options_.max_error) {
      // Floats miss the bound by no more than a thousandth of it here; what they overlook the second search finds.
      const Heights<float> heights(dem_, 0.5 * (zmin_ + zmax_));
      refine(options_.max_error * (1 + 0x1p-10), [&](Index t) { return search(heights, t); });
    } else {
      const Heights<double> heights(dem_, 0);
      const double noise = 0x1p-44 * std::max(std::fabs(zmin_), std::fabs(zmax_));
      refine(std::max(options_.max_error, noise), [&](Index t) { return search(heights, t); });
    }
    // From here on the surface is measured as it will be read: the planes of its final doubles at the samples' places.
    refine(options_.max_error > 0 ? options_.max_error : INFINITY, [&](Index t) { return measure(t); });
    return result();
  }

 private:
  std::array<LatticePoint, 3> corners(Index t) const {
    const auto& v = mesh_.triangles[t].v;
    return {mesh_.points[v[0]], mesh_.points[v[1]], mesh_.points[v[2]]};
  }
  double sample(LatticePoint p) const { return dem_.at(p.x, dem_.height - 1 - p.y); }
  const double* samples(int x, int y) const {
    return dem_.samples.data() + static_cast<std::size_t>(dem_.height - 1 - y) * dem_.width + x;
  }

  /// The worst sample of a triangle in lattice geometry. Samples on an edge are searched from one of its sides only;
  /// those on the border have been settled by its thinning.
  template <class T>
  Worst search(const Heights<T>& heights, Index t) const {
    const auto p = corners(t);
    std::array<bool, 3> own;
    for (int k = 0; k < 3; ++k) {
      const LatticePoint from = p[(k + 1) % 3], to = p[(k + 2) % 3];
      own[k] = mesh_.triangles[t].n[k] == none ? free_border_ : from.y > to.y || (from.y == to.y && from.x < to.x);
    }
    const double za = *heights.at(p[0]), zb = *heights.at(p[1]) - za, zc = *heights.at(p[2]) - za;
    const double bx = p[1].x - p[0].x, by = p[1].y - p[0].y, cx = p[2].x - p[0].x, cy = p[2].y - p[0].y;
    const double scale = 1 / (bx * cy - by * cx);
    const double gx = (zb * cy - zc * by) * scale, gy = (bx * zc - cx * zb) * scale;
    Worst worst;
    T largest = 0;
    // Of a large triangle every few rows tell well enough where it is worst; all are asked before it is let go.
    const double area = bx * cy - by * cx;
    int skip = 0;
    while (skip < 4 && area > (1024 << 2 * skip)) ++skip;
    for (int mask = (1 << skip) - 1;; mask = 0) {
      for_each_row(p, own, [&](int y, int first, int last) {
        if ((y & mask) != 0) return;
        const T base = static_cast<T>(za + gx * (first - p[0].x) + gy * (y - p[0].y)), slope = static_cast<T>(gx);
        const T* row = heights.at({first, y});
        const T error = worst_in_row(row, base, slope, last - first + 1);
        if (error > largest) {
          largest = error;
          worst.at = {first + place_in_row(row, base, slope, error), y};
        }
      });
      if (mask == 0 || largest > bound_) break;
    }
    worst.error = largest;
    return worst;
  }

  /// The worst sample of a triangle and its edges, on the doubles of the result.
  Worst measure(Index t) {
    const auto p = corners(t);
    const double ax = xs_[p[0].x], ay = ys_[p[0].y], az = sample(p[0]);
    const double bx = xs_[p[1].x] - ax, by = ys_[p[1].y] - ay, bz = sample(p[1]) - az;
    const double cx = xs_[p[2].x] - ax, cy = ys_[p[2].y] - ay, cz = sample(p[2]) - az;
    const double d = bx * cy - by * cx;
    const double gx = (bz * cy - cz * by) / d, gy = (bx * cz - cx * bz) / d;
    Worst worst;
    for_each_row(p, {true, true, true}, [&](int y, int first, int last) {
      const double* z = samples(first, y);
      const double dz_row = gy * (ys_[y] - ay);
      for (int x = first; x <= last; ++x, ++z) {
        const double error = std::fabs(*z - (az + (gx * (xs_[x] - ax) + dz_row)));
        if (error > worst.error) worst = {error, {x, y}};
      }
    });
    slots_[t].measured = worst.error;
    return worst;
  }

  struct Slot {
    LatticePoint at;
    double measured = 0;
  };

  template <class Search>
  void look(Index t, double bound, Search& search) {
    const Worst worst = search(t);
    slots_[t].at = worst.at;
    queue_.set(t, worst.error > bound ? static_cast<float>(worst.error) : 0.0F);
  }

  void make_room() {
    slots_.resize(mesh_.triangles.size());
    queue_.resize(mesh_.triangles.size());
  }

  /// Inserts the worst sample of the worst triangle until none is worse than `bound`.
  template <class Search>
  void refine(double bound, Search search) {
    bound_ = bound;
    make_room();
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (t % 1024 == 0) context_.progress("triangulate", done_);
      look(static_cast<Index>(t), bound, search);
    }
    const double start = std::log(queue_.top_error());
    for (std::size_t count = 0;; ++count) {
      if (count % 1024 == 0) report(start, bound);
      const Index worst = queue_.top();
      if (worst == none) return;
      if (options_.max_triangles > 0 && mesh_.triangles.size() + 2 > options_.max_triangles) return;
      const Index t = mesh_.insert(slots_[worst].at, worst);
      make_room();
      mesh_.around(t, [&](Index changed) { look(changed, bound, search); });
    }
  }

  /// The error falls roughly like a power of the time.
  void report(double start, double bound) {
    const double share = (start - std::log(queue_.top_error())) / (start - std::log(bound));
    if (share > done_) done_ = std::min(share, 1.0);
    context_.progress("triangulate", done_);
  }

  Triangulated result() const;

  const Raster& dem_;
  const TriangulateOptions& options_;
  Context& context_;
  LatticeMesh mesh_;
  GreedyQueue queue_;
  std::vector<Slot> slots_;
  std::vector<double> xs_, ys_;  // places of columns and, from the south, of rows
  double zmin_ = INFINITY, zmax_ = -INFINITY, done_ = 0, bound_ = 0;
  bool free_border_ = false;
};

Triangulated Greedy::result() const {
  Triangulated result;
  std::vector<Index> number(mesh_.points.size(), none);
  result.tin.faces.reserve(mesh_.triangles.size());
  for (const LatticeTriangle& t : mesh_.triangles) {
    for (const Index v : t.v) number[v] = 0;
  }
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == none) continue;
    number[v] = static_cast<Index>(result.tin.vertices.size());
    const LatticePoint p = mesh_.points[v];
    result.tin.vertices.push_back({xs_[p.x], ys_[p.y], sample(p)});
  }
  for (const LatticeTriangle& t : mesh_.triangles) {
    result.tin.faces.push_back({number[t.v[0]], number[t.v[1]], number[t.v[2]]});
  }
  for (const Slot& slot : slots_) result.error = std::max(result.error, slot.measured);
  return result;
}

}  // namespace

Triangulated triangulate_greedily(const Raster& dem, const TriangulateOptions& options, Context& context) {
  return Greedy(dem, options, context).run();
}

}  // namespace terrane
