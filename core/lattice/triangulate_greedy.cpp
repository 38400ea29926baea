// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/lattice/triangulate_greedy.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "core/error.hpp"
#include "core/lattice/greedy_refine.hpp"
#include "core/lattice/greedy_scan.hpp"
#include "core/lattice/lattice_blocks.hpp"
#include "core/lattice/thin_line.hpp"
#include "core/lattice/triangulate_domain.hpp"
#include "core/parallel.hpp"

namespace terrane {

namespace {

// Blocks of this many samples each way stay near the processor. Where vertices are sparse blocks are larger, so that
// the vertices that only their seams want do not count: about one in a hundred.
constexpr int smallest_block = 512, vertices_along_block = 48;

struct Range {
  double low = INFINITY, high = -INFINITY;
};

Range height_range(const Raster& dem, const Context& context) {
  std::vector<Range> rows(dem.height);
  parallel_for(context, dem.height, 64, [&](std::size_t first, std::size_t last) {
    for (std::size_t j = first; j < last; ++j) {
      Range range;
      const double* row = dem.samples.data() + j * dem.width;
      for (int i = 0; i < dem.width; ++i) {
        if (row[i] < range.low) range.low = row[i];
        if (row[i] > range.high) range.high = row[i];
      }
      rows[j] = range;
    }
  });
  Range all;
  for (const Range& row : rows) all = {std::min(all.low, row.low), std::max(all.high, row.high)};
  return all;
}

class Greedy {
 public:
  Greedy(const Raster& dem, const TriangulateOptions& options, Context& context)
      : dem_(dem),
        options_(options),
        context_(context),
        mesh_(dem.width, dem.height),
        grid_{dem.width, dem.height},
        result_scan_(dem) {}

  Triangulated run() {
    cut_out();
    if (mesh_.triangles.empty()) return {};
    const Range range = height_range(dem_, context_);
    if (range.high - range.low <= 0x1p12 * options_.max_error) {
      // Floats miss the bound by no more than a thousandth of it here; what they overlook the second search finds.
      refine_blocks(LatticeScan<float>(dem_, 0.5 * (range.low + range.high), free_border_, context_),
                    options_.max_error * (1 + 0x1p-10));
    } else {
      const double noise = 0x1p-44 * std::max(std::fabs(range.low), std::fabs(range.high));
      refine_blocks(LatticeScan<double>(dem_, 0, free_border_, context_), std::max(options_.max_error, noise));
    }
    return finish();
  }

 private:
  /// The domain's border, with the samples that carry the seams of the blocks inside it.
  void cut_out() {
    LatticeBorder border = find_border(dem_, options_.max_error);
    if (options_.max_triangles == 0) {
      grid_ = suitable_grid();
      thin_seams(grid_, [&](LatticePoint p) {
        if (inside(p)) border.points.push_back(p);
      });
    } else if (border.edges.size() > options_.max_triangles / 2) {
      // A border that alone takes much of the allowed triangles is refined like the inside.
      free_border_ = true;
      border = find_border(dem_, -1);
    }
    mesh_.cut_out(border.points, border.edges);
  }

  LatticeGrid grid(double block_size) const {
    const auto blocks = [block_size](int n) { return std::max(1, static_cast<int>(std::lround(n / block_size))); };
    return {dem_.width, dem_.height, blocks(dem_.width), blocks(dem_.height)};
  }

  LatticeGrid suitable_grid() const {
    std::size_t kept = 0;
    const std::size_t samples = thin_seams(grid(smallest_block), [&](LatticePoint) { ++kept; });
    const double spacing = static_cast<double>(samples) / static_cast<double>(kept + 1);
    return grid(std::max<double>(smallest_block, vertices_along_block * spacing));
  }

  /// Calls keep(p) for the samples that hold the others on the seams of a grid within the bound. Returns how many
  /// samples the seams have.
  template <class Keep>
  std::size_t thin_seams(const LatticeGrid& grid, Keep keep) const {
    std::size_t samples = 0;
    const auto thin = [&](int length, auto place) {
      samples += thin_runs(
          length, [&](int k) { return sample(place(k)); }, options_.max_error, [&](int k) { keep(place(k)); });
    };
    for (int k = 1; k < grid.columns; ++k) {
      const int x = static_cast<int>(std::int64_t{k} * (dem_.width - 1) / grid.columns);
      thin(dem_.height, [x](int i) { return LatticePoint{x, i}; });
    }
    for (int k = 1; k < grid.rows; ++k) {
      const int y = static_cast<int>(std::int64_t{k} * (dem_.height - 1) / grid.rows);
      thin(dem_.width, [y](int i) { return LatticePoint{i, y}; });
    }
    return samples;
  }

  double sample(LatticePoint p) const { return dem_.at(p.x, dem_.height - 1 - p.y); }
  bool exists(LatticePoint p) const { return !std::isnan(sample(p)); }
  /// Off the border: all cells around are of the domain.
  bool inside(LatticePoint p) const {
    if (p.x == 0 || p.y == 0 || p.x == dem_.width - 1 || p.y == dem_.height - 1) return false;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (!exists({p.x + dx, p.y + dy})) return false;
      }
    }
    return true;
  }

  template <class Scan>
  void refine_blocks(const Scan& scan, double bound) {
    LatticeBlocks parts(std::move(mesh_), grid_);
    std::atomic<std::size_t> done = 0;
    parallel_tasks(context_, parts.blocks.size(), [&, caller = std::this_thread::get_id()](std::size_t b) {
      const auto tick = [&](double share) {
        if (std::this_thread::get_id() == caller) {
          context_.progress("triangulate", 0.9 * (static_cast<double>(done) + share) / parts.blocks.size());
        } else if (context_.cancelled) {
          throw Error(ErrorKind::cancelled, "cancelled", "cancelled");
        }
      };
      LatticeMesh& mesh = parts.blocks[b];
      GreedyRefiner<Scan> refiner(mesh, scan, bound, options_.max_triangles);
      refiner.scan(0, static_cast<Index>(mesh.triangles.size()));
      refiner.refine(tick);
      ++done;
    });
    mesh_ = parts.join();
  }

  /// The surface measured as it will be read: the planes of its final doubles at the samples' places.
  Triangulated finish() {
    const double bound = options_.max_error > 0 ? options_.max_error : INFINITY;
    GreedyRefiner<ResultScan> refiner(mesh_, result_scan_, bound, options_.max_triangles);
    parallel_for(context_, mesh_.triangles.size(), 4096, [&](std::size_t first, std::size_t last) {
      refiner.scan(static_cast<Index>(first), static_cast<Index>(last));
    });
    refiner.refine([&](double share) { context_.progress("triangulate", 0.9 + 0.1 * share); });
    Triangulated result{numbered(), 0};
    for (const Worst& worst : refiner.worst) result.error = std::max(result.error, worst.error);
    return result;
  }

  Tin numbered() const {
    Tin tin;
    std::vector<Index> number(mesh_.points.size(), none);
    for (const LatticeTriangle& t : mesh_.triangles) {
      for (const Index v : t.v) number[v] = 0;
    }
    for (std::size_t v = 0; v < number.size(); ++v) {
      if (number[v] == none) continue;
      number[v] = static_cast<Index>(tin.vertices.size());
      tin.vertices.push_back(result_scan_.at(mesh_.points[v]));
    }
    tin.faces.reserve(mesh_.triangles.size());
    for (const LatticeTriangle& t : mesh_.triangles) {
      tin.faces.push_back({number[t.v[0]], number[t.v[1]], number[t.v[2]]});
    }
    return tin;
  }

  const Raster& dem_;
  const TriangulateOptions& options_;
  Context& context_;
  LatticeMesh mesh_;
  LatticeGrid grid_;
  ResultScan result_scan_;
  bool free_border_ = false;
};

}  // namespace

Triangulated triangulate_greedily(const Raster& dem, const TriangulateOptions& options, Context& context) {
  return Greedy(dem, options, context).run();
}

}  // namespace terrane
