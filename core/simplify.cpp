// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/simplify.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/corner_heights.hpp"
#include "core/error.hpp"
#include "core/mesh/half_edges.hpp"
#include "core/parallel.hpp"
#include "core/predicates.hpp"
#include "core/simplify/deviation.hpp"
#include "core/simplify/star_patch.hpp"
#include "core/topology.hpp"

namespace terrane {
namespace {

/// Vertices by the error their removal makes, least first to within 1 part in 256; of those alike the one that waits
/// longest, so that removals spread over flat ground instead of eating through it.
class RemovalQueue {
 public:
  explicit RemovalQueue(std::size_t vertices) : latest_(vertices, 0) {}

  void set(Index v, double error) {
    const auto level = std::bit_cast<std::uint32_t>(static_cast<float>(error)) >> 15;
    latest_[v] = ++turn_;
    heap_.push_back({std::uint64_t{level} << 44 | turn_, v});
    std::push_heap(heap_.begin(), heap_.end(), later);
  }
  bool waits(Index v) const { return latest_[v] != 0; }

  /// Takes the first out; none when all are.
  Index pop() {
    while (!heap_.empty()) {
      std::pop_heap(heap_.begin(), heap_.end(), later);
      const Entry first = heap_.back();
      heap_.pop_back();
      if ((first.key & ((std::uint64_t{1} << 44) - 1)) != latest_[first.vertex]) continue;
      latest_[first.vertex] = 0;
      return first.vertex;
    }
    return none;
  }

 private:
  struct Entry {
    std::uint64_t key;
    Index vertex;
  };
  static bool later(const Entry& a, const Entry& b) { return a.key > b.key; }

  std::vector<Entry> heap_;
  std::vector<std::uint64_t> latest_;  // the turn of the entry that counts, 0: none does
  std::uint64_t turn_ = 0;
};

class Simplifier {
 public:
  Simplifier(const Tin& tin, const SimplifyOptions& options, Context& context)
      : tin_(tin),
        options_(options),
        context_(context),
        original_(half_edges(tin, context)),
        mesh_(original_),
        deviation_(tin, original_),
        first_covered_(mesh_.faces.size(), none),
        next_covered_(tin.vertices.size(), none),
        stays_(vertices_that_stay()),
        outdated_(tin.vertices.size(), 0),
        error_(tin.vertices.size(), 0),
        queue_(tin.vertices.size()),
        left_(tin.faces.size()) {
    double largest = 0;
    for (const Point& p : tin.vertices) largest = std::max(largest, std::fabs(p.z));
    // Errors are measured to a few ulp of the heights; what a lattice of whole metres puts right on the bound is
    // within.
    rounding_ = 0x1p-48 * largest;
    limit_ = options.max_error + rounding_;
    widest_ = 4 * largest + 1;
  }

  Simplified run() {
    measure_all();
    if (options_.max_triangles != 0)
      raise_limit();
    else
      take_all();
    const double error = measured();
    return {result(), error <= limit_ && error > options_.max_error ? options_.max_error : error, 0};
  }

 private:
  bool enough() const { return options_.max_triangles != 0 && left_ <= options_.max_triangles; }

  /// Removes whatever may go within the limit, cheapest first.
  void take_all() {
    StarPatch patch(deviation_);
    for (Index v = enough() ? none : queue_.pop(); v != none; v = enough() ? none : queue_.pop()) {
      if (++steps_ % 4096 == 0) context_.progress("simplify", progress());
      if (std::exchange(outdated_[v], 0)) {
        measure(v, patch);
        if (error_[v] <= limit_) queue_.set(v, error_[v]);
        continue;
      }
      if (!remove(v, patch)) continue;
      ++removed_;
      for (const Index w : patch.ring) {
        if (stays_[w]) continue;
        outdated_[w] = 1;
        if (!queue_.waits(w)) queue_.set(w, std::min(error_[w], limit_));
      }
    }
  }

  /// A limit makes holes be filled as well as they can be, which no order of removals makes up for. So where a number
  /// of faces is asked for the limit is raised until they are reached.
  void raise_limit() {
    std::vector<double> errors;
    for (std::size_t v = 0; v < error_.size(); ++v)
      if (!stays_[v] && error_[v] > 0 && error_[v] < INFINITY) errors.push_back(error_[v]);
    const double most = limit_;
    if (!errors.empty()) {
      std::nth_element(errors.begin(), errors.begin() + errors.size() / 2, errors.end());
      limit_ = std::min(most, errors[errors.size() / 2]);
    }
    for (;;) {
      take_all();
      if (enough() || limit_ >= most) return;
      limit_ = std::min(most, limit_ < widest_ ? 1.5 * limit_ : INFINITY);
      for (std::size_t v = 0; v < error_.size(); ++v) {
        if (stays_[v] || mesh_.out[v] == none) continue;
        outdated_[v] = 1;
        queue_.set(static_cast<Index>(v), std::min(error_[v], limit_));
      }
    }
  }

  /// How far the mesh as it is now is from the surface.
  double measured() const {
    double largest = 0;
    const auto count = static_cast<Index>(mesh_.mate.size());
    for (Index h = 0; h < count; ++h) {
      const Index f = h / 3, v = mesh_.faces[f][0];
      if (v == none) continue;
      if (mesh_.mate[h] < h) largest = std::max(largest, deviation_.along(mesh_.from(h), mesh_.to(h), INFINITY));
      if (h % 3 == 0)
        for (Index p = first_covered_[f]; p != none; p = next_covered_[p])
          largest = std::max(largest, deviation_.at(p, v, mesh_.faces[f][1], mesh_.faces[f][2]));
    }
    return largest;
  }

  double progress() const {
    return 0.2 + 0.8 * static_cast<double>(removed_) / static_cast<double>(tin_.vertices.size());
  }

  std::vector<std::uint8_t> vertices_that_stay() const {
    std::vector<std::uint8_t> stays(tin_.vertices.size(), 0);
    for (const Face& f : tin_.faces)
      if (is_wall(tin_, f))
        for (const Index v : f) stays[v] = 1;
    const Array<Index> place = places(tin_.vertices, context_);
    for (std::size_t v = 0; v < stays.size(); ++v)
      if (place[v] != static_cast<Index>(v)) stays[v] = stays[place[v]] = 1;
    for (const Index h : original_.other_fans) stays[original_.from(h)] = 1;
    for (std::size_t v = 0; v < stays.size(); ++v) {
      const auto vertex = static_cast<Index>(v);
      if (original_.out[v] == none || (options_.keep_boundary && original_.at_border(vertex))) stays[v] = 1;
    }
    return stays;
  }

  /// What a removal of each would do to the surface as it is now.
  void measure_all() {
    const std::size_t n = tin_.vertices.size(), chunk = 4096;
    for (std::size_t done = 0; done < n; done += 64 * chunk) {
      context_.progress("simplify", 0.2 * static_cast<double>(done) / static_cast<double>(n));
      parallel_for(context_, std::min(n - done, 64 * chunk), chunk, [&](std::size_t begin, std::size_t end) {
        StarPatch patch(deviation_);
        for (std::size_t v = done + begin; v < done + end; ++v)
          if (!stays_[v]) measure(static_cast<Index>(v), patch);
      });
    }
    for (std::size_t v = 0; v < n; ++v)
      if (!stays_[v] && error_[v] <= limit_ && error_[v] < INFINITY) queue_.set(static_cast<Index>(v), error_[v]);
  }

  void measure(Index v, StarPatch& patch) { error_[v] = take_out(v, patch) ? patch.fill(limit_) : INFINITY; }

  /// The hole that v leaves; false where the border turns at v.
  bool take_out(Index v, StarPatch& patch) {
    patch.ring.clear();
    patch.covered.assign(1, v);
    const Index start = mesh_.out[v];
    Index h = start, last = start;
    do {
      patch.ring.push_back(mesh_.to(h));
      for (Index p = first_covered_[h / 3]; p != none; p = next_covered_[p]) patch.covered.push_back(p);
      last = h;
      h = mesh_.turn_left(h);
    } while (h != none && h != start);
    patch.open = h == none;
    if (!patch.open) return true;
    patch.ring.push_back(mesh_.from(previous_in_face(last)));
    return straight_on(patch.ring.back(), v, patch.ring.front());
  }

  bool straight_on(Index a, Index b, Index c) const {
    const Point2 p = deviation_.place(a), q = deviation_.place(b), r = deviation_.place(c);
    const auto between = [](double from, double at, double to) {
      return from <= to ? from <= at && at <= to : to <= at;
    };
    return orientation(p, q, r) == 0 && between(p.x, q.x, r.x) && between(p.y, q.y, r.y);
  }

  bool remove(Index v, StarPatch& patch) {
    if (!take_out(v, patch) || !(patch.fill(limit_) <= limit_)) return false;
    std::vector<Index>&outer = outer_, &slots = slots_;
    outer.clear(), slots.clear();
    const Index start = mesh_.out[v];
    Index h = start;
    do {
      outer.push_back(mesh_.mate[next_in_face(h)]);
      slots.push_back(h / 3);
      h = mesh_.turn_left(h);
    } while (h != none && h != start);
    left_ -= slots.size() - patch.triangles.size();
    put_faces(patch);
    connect(patch);
    hand_on_vertices(patch);
    mesh_.out[v] = none;
    return true;
  }

  void put_faces(const StarPatch& patch) {
    // Vertices whose half-edge goes with the old faces; a border's is found again by having no mate.
    lost_.assign(patch.ring.size(), 0);
    for (std::size_t i = 0; i < patch.ring.size(); ++i)
      lost_[i] = std::find(slots_.begin(), slots_.end(), mesh_.out[patch.ring[i]] / 3) != slots_.end();
    for (std::size_t s = 0; s < slots_.size(); ++s) {
      first_covered_[slots_[s]] = none;
      mesh_.faces[slots_[s]] = {none, none, none};
      if (s >= patch.triangles.size()) continue;
      const auto& t = patch.triangles[s];
      mesh_.faces[slots_[s]] = {patch.ring[t[0]], patch.ring[t[1]], patch.ring[t[2]]};
    }
  }

  void connect(const StarPatch& patch) {
    const int n = static_cast<int>(patch.ring.size());
    edges_.clear();
    for (std::size_t s = 0; s < patch.triangles.size(); ++s)
      for (int k = 0; k < 3; ++k) {
        const int i = patch.triangles[s][k], j = patch.triangles[s][(k + 1) % 3];
        const Index h = 3 * slots_[s] + k;
        mesh_.mate[h] = none;
        const bool rim = j == i + 1 || (j == 0 && i == n - 1 && !patch.open);
        if (rim && outer_[i] != none) mesh_.mate[h] = outer_[i], mesh_.mate[outer_[i]] = h;
        if (!rim) edges_.push_back({std::min(i, j), std::max(i, j), h});
      }
    std::sort(edges_.begin(), edges_.end());
    for (std::size_t e = 0; e + 1 < edges_.size(); ++e)
      if (edges_[e].low == edges_[e + 1].low && edges_[e].high == edges_[e + 1].high)
        mesh_.mate[edges_[e].half_edge] = edges_[e + 1].half_edge,
        mesh_.mate[edges_[e + 1].half_edge] = edges_[e].half_edge;
    for (std::size_t s = 0; s < patch.triangles.size(); ++s)
      for (int k = 0; k < 3; ++k) {
        const int i = patch.triangles[s][k];
        const Index h = 3 * slots_[s] + k;
        if (!lost_[i] && mesh_.mate[h] != none) continue;
        mesh_.out[patch.ring[i]] = h;
        lost_[i] = 0;
      }
  }

  void hand_on_vertices(const StarPatch& patch) {
    for (const Index p : patch.covered)
      for (std::size_t s = 0; s < patch.triangles.size(); ++s) {
        const Face& f = mesh_.faces[slots_[s]];
        const Point2 at = deviation_.place(p), a = deviation_.place(f[0]), b = deviation_.place(f[1]),
                     c = deviation_.place(f[2]);
        if (orientation(a, b, at) < 0 || orientation(b, c, at) < 0 || orientation(c, a, at) < 0) continue;
        next_covered_[p] = std::exchange(first_covered_[slots_[s]], p);
        break;
      }
  }

  Tin result() const {
    std::vector<Face> faces;
    for (const Face& f : mesh_.faces)
      if (f[0] != none) faces.push_back(f);
    for (const Face& f : tin_.faces)
      if (is_wall(tin_, f)) faces.push_back(f);
    return canonical(tin_.vertices, std::move(faces), context_);
  }

  struct InnerEdge {
    int low, high;
    Index half_edge;
    auto operator<=>(const InnerEdge&) const = default;
  };

  const Tin& tin_;
  const SimplifyOptions& options_;
  Context& context_;
  const HalfEdges original_;
  HalfEdges mesh_;
  Deviation deviation_;
  std::vector<Index> first_covered_, next_covered_;  // per face and vertex: those taken out, where they lie now
  std::vector<std::uint8_t> stays_, outdated_;
  std::vector<double> error_;  // of the removal, when it was last measured
  RemovalQueue queue_;
  std::size_t left_;
  double limit_ = 0, rounding_ = 0, widest_ = 0;
  std::size_t steps_ = 0, removed_ = 0;
  std::vector<Index> outer_, slots_;
  std::vector<std::uint8_t> lost_;
  std::vector<InnerEdge> edges_;
};

/// Not a number where the overlay of the two cannot be rounded, which is nothing against the result.
double difference_on_overlay(const Tin& tin, const Tin& simplified, Context& context) {
  try {
    return largest_difference(tin, simplified, context);
  } catch (const Error& error) {
    if (error.kind != ErrorKind::input) throw;
    return NAN;
  }
}

}  // namespace

Simplified simplify(const Tin& tin, const SimplifyOptions& options, Context& context) {
  return Simplifier(tin, options, context).run();
}

Simplified simplify_and_verify(const Tin& tin, SimplifyOptions options, Context& context) {
  const double promised = options.max_error + coplanar_tolerance(tin);
  for (int attempt = 0; attempt < 3; ++attempt) {
    Simplified made = simplify(tin, options, context);
    made.verified = difference_on_overlay(tin, made.tin, context);
    if (!(made.verified > promised)) return made;
    options.max_error = std::max(0.0, options.max_error - 2 * (made.verified - promised));
  }
  throw Error(ErrorKind::internal, "bound-missed", "the simplified surface is further from the original than promised");
}

double coplanar_tolerance(const Tin& tin) {
  double largest = 0;
  for (const Point& p : tin.vertices) largest = std::max(largest, std::fabs(p.z));
  return rounding_jump(largest);
}

}  // namespace terrane
