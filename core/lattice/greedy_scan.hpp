// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "core/lattice/lattice_mesh.hpp"
#include "core/lattice/lattice_scan.hpp"
#include "core/parallel.hpp"
#include "core/raster.hpp"

// The two ways greedy insertion measures a triangle against its samples: fast, and as the result will be read. Each has
//   Worst worst(mesh, t, bound)         its largest error; errors below `bound` may be told too small
//   LatticePoint place(mesh, t, worst)  the first sample with that error in that row
namespace terrane {

struct Worst {
  double error = 0;
  std::int32_t row = 0;
};

inline std::array<LatticePoint, 3> corners(const LatticeMesh& mesh, Index t) {
  const auto& v = mesh.triangles[t].v;
  return {mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]]};
}

/// In lattice geometry, on heights as numbers of type T row by row from the south, relative to a height `zero`. Samples
/// on an edge are looked at from one of its sides only; those on the border have been settled by its thinning.
template <class T>
class LatticeScan {
 public:
  LatticeScan(const Raster& dem, double zero, bool free_border, const Context& context)
      : stride_(row_stride(dem.width)), free_border_(free_border), z_(new T[stride_ * dem.height]) {
    parallel_for(context, dem.height, 64, [&](std::size_t first, std::size_t last) {
      for (std::size_t y = first; y < last; ++y) {
        const double* from = dem.samples.data() + (dem.height - 1 - y) * dem.width;
        T* to = z_.get() + y * stride_;
        for (int x = 0; x < dem.width; ++x) to[x] = static_cast<T>(from[x] - zero);
        for (std::size_t x = dem.width; x < stride_; ++x) to[x] = 0;
      }
    });
  }

  Worst worst(const LatticeMesh& mesh, Index t, double bound) const {
    const Plane plane(*this, mesh, t);
    // Of a large triangle every few rows tell well enough where it is worst; all are asked before it is let go.
    int skip = 0;
    while (skip < 4 && plane.area > (1024 << 2 * skip)) ++skip;
    for (std::int32_t mask = (1 << skip) - 1;; mask = 0) {
      Furthest<T> furthest;
      for_each_row(plane.p, plane.own, [&](std::int32_t y, std::int32_t first, std::int32_t last) {
        if ((y & mask) != 0) return;
        const T* z = at({first, y});
        const T n = static_cast<T>(last - first + 1), base = plane.at(first, y), slope = plane.slope;
        Lanes place;
        for (int l = 0; l < lanes; ++l) place[l] = static_cast<T>(l);
        for (; place[0] < n; place += static_cast<T>(lanes), z += lanes) {
          furthest.add(Furthest<T>::absolute(Furthest<T>::load(z) - (base + slope * place)), place < n, y);
        }
      });
      if (mask == 0 || furthest.error() > bound) return {furthest.error(), furthest.row()};
    }
  }

  LatticePoint place(const LatticeMesh& mesh, Index t, const Worst& worst) const {
    const Plane plane(*this, mesh, t);
    LatticePoint found;
    for_each_row(plane.p, plane.own, [&](std::int32_t y, std::int32_t first, std::int32_t) {
      if (y != worst.row) return;
      const T* z = at({first, y});
      const T base = plane.at(first, y);
      std::int32_t k = 0;
      while (std::fabs(z[k] - (base + plane.slope * static_cast<T>(k))) != static_cast<T>(worst.error)) ++k;
      found = {first + k, y};
    });
    return found;
  }

 private:
  static constexpr int lanes = Furthest<T>::lanes;
  typedef typename Furthest<T>::Lanes Lanes;

  struct Plane {
    std::array<LatticePoint, 3> p;
    std::array<bool, 3> own;
    double za, gx, gy, area;
    T slope;

    Plane(const LatticeScan& scan, const LatticeMesh& mesh, Index t) : p(corners(mesh, t)) {
      for (int k = 0; k < 3; ++k) {
        const LatticePoint from = p[(k + 1) % 3], to = p[(k + 2) % 3];
        const Index beyond = mesh.triangles[t].n[k];
        own[k] = beyond >= 0 ? from.y > to.y || (from.y == to.y && from.x < to.x) : scan.free_border_ && beyond == none;
      }
      za = *scan.at(p[0]);
      const double zb = *scan.at(p[1]) - za, zc = *scan.at(p[2]) - za;
      const double bx = p[1].x - p[0].x, by = p[1].y - p[0].y, cx = p[2].x - p[0].x, cy = p[2].y - p[0].y;
      area = bx * cy - by * cx;
      const double scale = 1 / area;
      gx = (zb * cy - zc * by) * scale;
      gy = (bx * zc - cx * zb) * scale;
      slope = static_cast<T>(gx);
    }
    T at(std::int32_t x, std::int32_t y) const { return static_cast<T>(za + gx * (x - p[0].x) + gy * (y - p[0].y)); }
  };

  /// Whole lines of the cache, an odd number of them, so that neighbours in a column do not fall on one place of it;
  /// and room to read a few samples beyond the last one.
  static std::size_t row_stride(int width) {
    constexpr std::size_t line = 64 / sizeof(T);
    return ((static_cast<std::size_t>(width) + lanes + line - 1) / line | 1) * line;
  }
  const T* at(LatticePoint p) const { return z_.get() + static_cast<std::size_t>(p.y) * stride_ + p.x; }

  std::size_t stride_;
  bool free_border_;
  std::unique_ptr<T[]> z_;
};

/// On the doubles of the result: the planes through its vertices at the places of all samples, those on edges too.
class ResultScan {
 public:
  explicit ResultScan(const Raster& dem) : dem_(dem) {
    for (int x = 0; x < dem.width; ++x) xs_.push_back(dem.place(x, 0).x);
    for (int y = 0; y < dem.height; ++y) ys_.push_back(dem.place(0, dem.height - 1 - y).y);
  }

  Point at(LatticePoint p) const { return {xs_[p.x], ys_[p.y], *samples(p.x, p.y)}; }

  Worst worst(const LatticeMesh& mesh, Index t, double) const {
    const Plane plane(*this, mesh, t);
    Furthest<double> furthest;
    for_each_row(plane.p, {true, true, true}, [&](std::int32_t y, std::int32_t first, std::int32_t last) {
      const double* z = samples(first, y);
      const double *x = xs_.data() + first, *end = xs_.data() + last;
      const double rise = plane.rise(ys_[y]);
      for (; x < end; x += 2, z += 2) {
        const auto dx = Furthest<double>::load(x) - plane.a.x;
        const auto error = Furthest<double>::load(z) - (plane.a.z + (plane.gx * dx + rise));
        furthest.add(Furthest<double>::absolute(error), all, y);
      }
      if (x == end) furthest.add(Lanes{} + plane.error(*x, rise, *z), all, y);
    });
    return {furthest.error(), furthest.row()};
  }

  LatticePoint place(const LatticeMesh& mesh, Index t, const Worst& worst) const {
    const Plane plane(*this, mesh, t);
    LatticePoint found;
    for_each_row(plane.p, {true, true, true}, [&](std::int32_t y, std::int32_t first, std::int32_t) {
      if (y != worst.row) return;
      const double* z = samples(first, y);
      const double rise = plane.rise(ys_[y]);
      std::int32_t x = first;
      while (plane.error(xs_[x], rise, *z) != worst.error) ++x, ++z;
      found = {x, y};
    });
    return found;
  }

 private:
  typedef Furthest<double>::Lanes Lanes;
  static constexpr Furthest<double>::Mask all{-1, -1};

  struct Plane {
    std::array<LatticePoint, 3> p;
    Point a;
    double gx, gy;

    Plane(const ResultScan& scan, const LatticeMesh& mesh, Index t) : p(corners(mesh, t)), a(scan.at(p[0])) {
      const Point b = scan.at(p[1]), c = scan.at(p[2]);
      const double bx = b.x - a.x, by = b.y - a.y, bz = b.z - a.z, cx = c.x - a.x, cy = c.y - a.y, cz = c.z - a.z;
      const double d = bx * cy - by * cx;
      gx = (bz * cy - cz * by) / d;
      gy = (bx * cz - cx * bz) / d;
    }
    double rise(double y) const { return gy * (y - a.y); }
    double error(double x, double rise, double z) const { return std::fabs(z - (a.z + (gx * (x - a.x) + rise))); }
  };

  const double* samples(int x, int y) const {
    return dem_.samples.data() + static_cast<std::size_t>(dem_.height - 1 - y) * dem_.width + x;
  }

  const Raster& dem_;
  std::vector<double> xs_,
      ys_;  // places of columns and, from the south, of rows
};

}  // namespace terrane
