// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <vector>

#include "core/lattice/greedy_queue.hpp"
#include "core/lattice/greedy_scan.hpp"
#include "core/lattice/lattice_mesh.hpp"

namespace terrane {

/// Greedy insertion (Garland & Heckbert 1995): the worst sample of the worst triangle becomes a vertex, until no sample
/// is further than `bound` from the mesh or the mesh has `max_triangles` of them (0: no limit).
template <class Scan>
class GreedyRefiner {
 public:
  std::vector<Worst> worst;  // of every triangle

  GreedyRefiner(LatticeMesh& mesh, const Scan& scan, double bound, std::size_t max_triangles)
      : worst(mesh.triangles.size()), mesh_(mesh), scan_(scan), bound_(bound), max_triangles_(max_triangles) {}

  void scan(Index first, Index last) {
    for (Index t = first; t < last; ++t) worst[t] = scan_.worst(mesh_, t, bound_);
  }

  /// To be called once all triangles have been scanned. Calls tick(share of the work done) every so often.
  template <class Tick>
  void refine(Tick tick) {
    queue_.resize(worst.size());
    for (std::size_t t = 0; t < worst.size(); ++t) enqueue(static_cast<Index>(t));
    const double start = std::log(queue_.top_error());
    for (std::size_t count = 0;; ++count) {
      if (count % 1024 == 0) tick(share(start));
      const Index top = queue_.top();
      if (top == none) return;
      if (max_triangles_ > 0 && mesh_.triangles.size() + 2 > max_triangles_) return;
      const Index t = mesh_.insert(scan_.place(mesh_, top, worst[top]), top);
      worst.resize(mesh_.triangles.size());
      queue_.resize(mesh_.triangles.size());
      mesh_.around(t, [&](Index changed) {
        scan(changed, changed + 1);
        enqueue(changed);
      });
    }
  }

 private:
  void enqueue(Index t) { queue_.set(t, worst[t].error > bound_ ? static_cast<float>(worst[t].error) : 0.0F); }

  /// The error falls roughly like a power of the time.
  double share(double start) {
    const double done = (start - std::log(queue_.top_error())) / (start - std::log(bound_));
    return done > 0 ? std::min(done, 1.0) : 0.0;
  }

  LatticeMesh& mesh_;
  const Scan& scan_;
  double bound_;
  std::size_t max_triangles_;
  GreedyQueue queue_;
};

}  // namespace terrane
