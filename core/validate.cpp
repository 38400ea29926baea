// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/validate.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/predicates.hpp"
#include "core/shortest.hpp"
#include "core/surface/mend.hpp"
#include "core/topology.hpp"

namespace terrane {
namespace {

std::string name_of(const char* what, Index number) { return std::string(what) + " " + std::to_string(number); }

/// Do the interiors of two counter-clockwise triangles meet? Exactly not when a side of one has all of the other behind
/// it.
bool overlap(const std::array<Point2, 3>& a, const std::array<Point2, 3>& b) {
  const auto separates = [](const std::array<Point2, 3>& s, const std::array<Point2, 3>& t) {
    for (int k = 0; k < 3; ++k) {
      const Point2 p = s[k], q = s[(k + 1) % 3];
      if (orientation(p, q, t[0]) <= 0 && orientation(p, q, t[1]) <= 0 && orientation(p, q, t[2]) <= 0) return true;
    }
    return false;
  };
  return !separates(a, b) && !separates(b, a);
}

/// Goes through a TIN step by step, writes down what is wrong and mends what is harmless.
/// Vertices keep the numbers they came with; faces remember theirs.
class Audit {
 public:
  Audit(Tin tin, std::size_t limit, const Context& context) : tin_(std::move(tin)), limit_(limit), context_(context) {
    original_.resize(tin_.faces.size());
    std::iota(original_.begin(), original_.end(), 0);
  }

  void run();
  const Mending& mending() const { return mending_; }
  /// Defects in the order of the contract: first those that stop the work, then those that were mended.
  std::vector<Defect> all() const;
  const std::vector<Defect>& fatal() const { return fatal_; }
  const std::vector<Defect>& mended() const { return mended_; }
  /// The mended TIN; only when nothing is fatal.
  Tin take();

 private:
  void check_values();
  void find_unused();
  void weld();
  void look_at_faces();
  void drop_duplicate_faces();
  void find_crowded_edges();
  void find_overlaps(const BorderReport& border);
  void pairs_inside(const std::array<Point2, 3>& region, std::vector<std::array<Index, 2>>& pairs) const;
  void split_touched(const BorderReport& border);
  void find_two_heights();
  std::array<Point2, 3> in_plan(Index face) const;
  std::string place_of(Index vertex) const;
  void note(std::vector<Defect>& list, std::size_t count, std::string code, std::string element, std::string message) {
    if (count < limit_) list.push_back({std::move(code), std::move(element), std::move(message)});
  }

  Tin tin_;
  std::size_t limit_;
  const Context& context_;
  std::vector<Index> original_;  // per face: its number in the input
  Array<Index> places_;
  std::vector<bool> used_;
  PlanTopology topology_;
  Mending mending_;
  std::vector<Defect> fatal_, mended_;
};

std::string Audit::place_of(Index vertex) const {
  return "(" + shortest(tin_.vertices[vertex].x) + ", " + shortest(tin_.vertices[vertex].y) + ")";
}

std::array<Point2, 3> Audit::in_plan(Index face) const {
  const Face& f = tin_.faces[face];
  const bool turned = topology_.turn[face] == Turn::right;
  return {plan(tin_.vertices[f[0]]), plan(tin_.vertices[f[turned ? 2 : 1]]), plan(tin_.vertices[f[turned ? 1 : 2]])};
}

void Audit::check_values() {
  const auto n = static_cast<Index>(tin_.vertices.size());
  std::size_t count = 0;
  for (Index v = 0; v < n; ++v) {
    const Point& p = tin_.vertices[v];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      note(fatal_, count++, "not-finite", name_of("vertex", v), "has a coordinate that is not a finite number");
  }
  count = 0;
  for (Index v = 0; v < n; ++v) {
    const Point& p = tin_.vertices[v];
    const double largest = std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
    if (std::isfinite(largest) && largest > largest_coordinate)
      note(fatal_, count++, "too-large", name_of("vertex", v),
           "has a coordinate beyond 1e100, with which areas and volumes overflow; check its units");
  }
  count = 0;
  for (Index f = 0; f < static_cast<Index>(tin_.faces.size()); ++f)
    for (const Index v : tin_.faces[f])
      if (v < 0 || v >= n) {
        note(
            fatal_, count++, "index-out-of-range", name_of("face", f),
            "names vertex " + std::to_string(v) + ", but there are " + std::to_string(n) + " vertices, counted from 0");
        break;
      }
}

void Audit::find_unused() {
  used_.assign(tin_.vertices.size(), false);
  for (const Face& face : tin_.faces)
    for (const Index v : face) used_[v] = true;
  for (Index v = 0; v < static_cast<Index>(used_.size()); ++v)
    if (!used_[v])
      note(mended_, mending_.unused_vertices++, "unused-vertex", name_of("vertex", v), "belongs to no face");
}

void Audit::weld() {
  for (const auto& [gone, kept] : weld_duplicates(tin_, places_, used_))
    note(mended_, mending_.duplicate_vertices++, "duplicate-vertex",
         "vertices " + std::to_string(kept) + " and " + std::to_string(gone), "are the same point " + place_of(kept));
}

void Audit::look_at_faces() {
  const auto n = static_cast<Index>(tin_.faces.size());
  for (Index f = 0; f < n; ++f)
    if (topology_.turn[f] == Turn::flat)
      note(mended_, mending_.zero_area_faces++, "zero-area-face", name_of("face", f), "has no area");
  for (Index f = 0; f < n; ++f)
    if (topology_.turn[f] == Turn::right)
      note(mended_, mending_.clockwise_faces++, "clockwise-face", name_of("face", f), "is clockwise seen from above");
}

/// Equal faces crowd an edge or are walls, so only those are compared.
void Audit::drop_duplicate_faces() {
  std::vector<bool> crowded(topology_.crowded.empty() ? 0 : tin_.vertices.size(), false);
  for (const auto& edge : topology_.crowded) crowded[edge[0]] = crowded[edge[1]] = true;
  std::vector<std::pair<Face, Index>> candidates;
  for (Index f = 0; f < static_cast<Index>(tin_.faces.size()); ++f) {
    if (topology_.in_plan(f) ? crowded.empty() : topology_.turn[f] != Turn::wall) continue;
    Face sorted = tin_.faces[f];
    std::sort(sorted.begin(), sorted.end());
    if (topology_.turn[f] == Turn::wall || crowded[topology_.place[sorted[0]]]) candidates.emplace_back(sorted, f);
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<std::pair<Index, Index>> doubles;
  for (std::size_t i = 0, first = 0; i < candidates.size(); ++i) {
    if (candidates[i].first != candidates[first].first) first = i;
    if (i != first) doubles.emplace_back(candidates[i].second, candidates[first].second);
  }
  if (doubles.empty()) return;
  std::sort(doubles.begin(), doubles.end());
  std::vector<bool> gone(tin_.faces.size(), false);
  for (const auto& [copy, kept] : doubles) {
    gone[copy] = true;
    note(mended_, mending_.duplicate_faces++, "duplicate-face",
         "faces " + std::to_string(kept) + " and " + std::to_string(copy), "have the same corners");
  }
  std::size_t kept = 0;
  for (std::size_t f = 0; f < tin_.faces.size(); ++f) {
    if (gone[f]) continue;
    tin_.faces[kept] = tin_.faces[f];
    original_[kept++] = original_[f];
  }
  tin_.faces.resize(kept);
  original_.resize(kept);
  topology_ = plan_topology(tin_, std::move(places_), context_);
}

void Audit::find_crowded_edges() {
  std::map<std::array<Index, 2>, std::vector<Index>> faces;
  for (const auto& edge : topology_.crowded)
    if (faces.size() < limit_) faces[edge];
  if (faces.empty()) return;
  for (Index h = 0; h < static_cast<Index>(topology_.mate.size()); ++h) {
    if (!topology_.in_plan(h / 3)) continue;
    const Index a = topology_.place[topology_.from(tin_, h)], b = topology_.place[topology_.to(tin_, h)];
    const auto edge = faces.find({std::min(a, b), std::max(a, b)});
    if (edge != faces.end()) edge->second.push_back(original_[h / 3]);
  }
  for (const auto& [edge, users] : faces) {
    std::string list;
    for (std::size_t i = 0; i < users.size() && i < 8; ++i) list += (i ? ", " : "") + std::to_string(users[i]);
    if (users.size() > 8) list += ", ...";
    const std::string use =
        users.size() > 2 ? " is used by " + std::to_string(users.size()) + " faces: " : " has two faces on one side: ";
    fatal_.push_back({"non-manifold-edge", "edge " + std::to_string(edge[0]) + "-" + std::to_string(edge[1]),
                      "from " + place_of(edge[0]) + " to " + place_of(edge[1]) + use + list});
  }
}

/// Faces that overlap inside a region that is covered twice: one that reaches into it, and all that overlap that one.
void Audit::pairs_inside(const std::array<Point2, 3>& region, std::vector<std::array<Index, 2>>& pairs) const {
  const auto n = static_cast<Index>(tin_.faces.size());
  Index first = 0;
  while (first < n && !(topology_.in_plan(first) && overlap(in_plan(first), region))) ++first;
  if (first == n) return;
  for (Index f = 0; f < n && pairs.size() < 4 * limit_; ++f)
    if (f != first && topology_.in_plan(f) && overlap(in_plan(f), in_plan(first)))
      pairs.push_back({std::min(f, first), std::max(f, first)});
}

void Audit::find_overlaps(const BorderReport& border) {
  std::vector<std::array<Index, 2>> pairs;
  for (const auto& [a, b] : border.crossing) pairs.push_back({std::min(a / 3, b / 3), std::max(a / 3, b / 3)});
  for (const auto& region : border.doubled)
    if (pairs.size() < 4 * limit_) pairs_inside(region, pairs);
  for (auto& pair : pairs) pair = {original_[pair[0]], original_[pair[1]]};
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  for (std::size_t i = 0; i < pairs.size(); ++i)
    note(fatal_, i, "overlapping-faces", "faces " + std::to_string(pairs[i][0]) + " and " + std::to_string(pairs[i][1]),
         "overlap seen from above");
}

void Audit::split_touched(const BorderReport& border) {
  for (const auto& touch : border.touches)
    note(mended_, mending_.t_junctions++, "t-junction", name_of("vertex", touch.place),
         "lies in the middle of an edge of face " + std::to_string(original_[touch.half_edge / 3]));
  split_at_touches(tin_, topology_, border.touches, original_);
  topology_ = plan_topology(tin_, context_);
}

/// Two heights at a place are a jump when a wall, or an edge whose two faces disagree at both its ends, leads from one
/// to the other; or when the faces on them do not hang together around the place: then parts of the surface meet there
/// in a point, along no line, as tiles of a merge do that touch in one corner.
void Audit::find_two_heights() {
  const auto n = static_cast<Index>(tin_.vertices.size());
  Index alone = 0;
  while (alone < n && topology_.place[alone] == alone) ++alone;
  if (alone == n) return;
  std::vector<bool> tall(n, false);
  std::vector<Index> root(n, none);  // of used vertices: by jumps
  std::vector<Index> fan(n, none);   // of used vertices: by faces that share an edge
  for (std::size_t f = 0; f < tin_.faces.size(); ++f)
    if (topology_.turn[f] != Turn::flat)
      for (const Index v : tin_.faces[f]) {
        root[v] = fan[v] = v;
        const Index place = topology_.place[v];
        if (place != v) tall[place] = true;
      }
  const auto find = [](std::vector<Index>& up, Index v) {
    while (up[v] != v) v = up[v] = up[up[v]];
    return v;
  };
  const auto join = [&](std::vector<Index>& up, Index a, Index b) {
    if (a != b && topology_.place[a] == topology_.place[b]) up[find(up, a)] = find(up, b);
  };
  for (Index h = 0; h < static_cast<Index>(topology_.mate.size()); ++h) {
    const Index m = topology_.mate[h];
    if (topology_.turn[h / 3] == Turn::wall) join(root, tin_.faces[h / 3][h % 3], tin_.faces[h / 3][(h + 1) % 3]);
    if (m < h) continue;
    // A jump is a line, not a point: an open edge joins heights only when both its ends have two.
    const Index from[2] = {topology_.from(tin_, h), topology_.to(tin_, m)};
    const Index to[2] = {topology_.to(tin_, h), topology_.from(tin_, m)};
    join(fan, from[0], from[1]);
    join(fan, to[0], to[1]);
    if (from[0] == from[1] || to[0] == to[1]) continue;
    join(root, from[0], from[1]);
    join(root, to[0], to[1]);
  }
  std::map<Index, Index> first;  // per fan at a place with several vertices: one of them
  std::size_t count = 0;
  for (Index v = 0; v < static_cast<Index>(root.size()); ++v) {
    if (root[v] == none || !tall[topology_.place[v]]) continue;
    const auto [other, fresh] = first.emplace(find(fan, v), v);
    if (fresh || find(root, other->second) == find(root, v)) continue;
    note(fatal_, count++, "two-heights", "vertices " + std::to_string(other->second) + " and " + std::to_string(v),
         "are two heights at " + place_of(v) + " that no wall and no jump along an edge joins");
  }
}

void Audit::run() {
  check_values();
  if (!fatal_.empty()) return;
  find_unused();
  places_ = places(tin_.vertices, context_);
  weld();
  topology_ = plan_topology(tin_, places_, context_);
  look_at_faces();
  drop_duplicate_faces();
  find_crowded_edges();
  const BorderReport border = examine_border(tin_, border_edges(tin_, topology_), limit_);
  find_overlaps(border);
  if (!border.touches.empty()) split_touched(border);
  if (fatal_.empty()) find_two_heights();
}

std::vector<Defect> Audit::all() const {
  std::vector<Defect> list = fatal_;
  list.insert(list.end(), mended_.begin(), mended_.end());
  return list;
}

Tin Audit::take() {
  std::size_t kept = 0;
  for (std::size_t f = 0; f < tin_.faces.size(); ++f) {
    if (topology_.turn[f] == Turn::flat) continue;
    Face face = tin_.faces[f];
    if (topology_.turn[f] == Turn::right) std::swap(face[1], face[2]);
    tin_.faces[kept++] = face;
  }
  tin_.faces.resize(kept);
  return std::move(tin_);
}

std::string remedy(const std::string& code) {
  if (code == "not-finite") return "Remove or correct these vertices; gaps are the absence of faces, never a number.";
  if (code == "index-out-of-range") return "The file is damaged or was cut short; export it again.";
  if (code == "two-heights") return "Join the heights by a vertical face, or give the place one height.";
  return "Run validate to see all of it, and correct the surface where it was made.";
}

[[noreturn]] void refuse(const std::string& name, const std::vector<Defect>& fatal) {
  std::string text = name.empty() ? std::string("the surface") : name;
  text += " cannot be computed on: ";
  for (std::size_t i = 0; i < fatal.size() && i < 20; ++i)
    text += (i ? "; " : "") + fatal[i].element + " " + fatal[i].message;
  if (fatal.size() > 20) text += "; and more";
  throw Error(ErrorKind::input, fatal.front().code, text + ". " + remedy(fatal.front().code));
}

/// One warning per kind, with the first element.
void warn_of_mends(const std::string& name, const Audit& audit, Context& context) {
  const Mending& m = audit.mending();
  const std::map<std::string, std::pair<std::size_t, const char*>> kinds = {
      {"duplicate-vertex", {m.duplicate_vertices, "duplicate vertices of equal height became one"}},
      {"duplicate-face", {m.duplicate_faces, "duplicate faces were dropped"}},
      {"unused-vertex", {m.unused_vertices, "vertices that belong to no face were dropped"}},
      {"zero-area-face", {m.zero_area_faces, "faces without area were dropped"}},
      {"clockwise-face", {m.clockwise_faces, "clockwise faces were turned"}},
      {"t-junction", {m.t_junctions, "vertices lay in the middle of an edge of another face, which was split"}}};
  std::string last;
  for (const Defect& defect : audit.mended()) {
    if (defect.code == last) continue;
    last = defect.code;
    const auto& [count, what] = kinds.at(defect.code);
    context.warn({"mended", name, defect.element, std::to_string(count) + " " + what,
                  "correct the file to be rid of this warning"});
  }
}

/// Is every coordinate one that can be computed with, and every index one of a vertex?
bool values_are_fit(const Tin& tin, const Context& context) {
  const auto n = static_cast<Index>(tin.vertices.size());
  std::atomic<bool> fit = true;
  parallel_for(context, tin.vertices.size(), chunk_for(context, tin.vertices.size()), [&](auto begin, auto end) {
    const auto is_fit = [](double v) { return std::fabs(v) <= largest_coordinate; };
    for (std::size_t v = begin; v < end; ++v)
      if (const Point& p = tin.vertices[v]; !is_fit(p.x) || !is_fit(p.y) || !is_fit(p.z)) return fit.store(false);
  });
  parallel_for(context, tin.faces.size(), chunk_for(context, tin.faces.size()), [&](auto begin, auto end) {
    for (std::size_t f = begin; f < end; ++f)
      for (const Index v : tin.faces[f])
        if (v < 0 || v >= n) return fit.store(false);
  });
  return fit;
}

/// The surface in canonical order if an audit of it would find nothing, as of most inputs: where all lies near in
/// memory that is seen at once. None where it might: then the audit, on the elements as they came, says what it is.
std::optional<Tin> sound_in_order(const Tin& tin, const Context& context) {
  if (!values_are_fit(tin, context)) return {};
  Tin sorted = canonical(tin.vertices, tin.faces, context);
  if (sorted.vertices.size() != tin.vertices.size()) return {};  // some were alike or of no face
  const auto border = sound_border(sorted, context);
  if (!border || !examine_border(sorted, *border, 0).sound()) return {};
  return sorted;
}

}  // namespace

std::vector<Defect> find_defects(const Tin& tin, std::size_t limit, const Context& context) {
  Audit audit(tin, std::max<std::size_t>(limit, 1), context);
  audit.run();
  return audit.all();
}

Tin checked(Tin tin, const std::string& name, Context& context, Mending* mending) {
  if (auto sound = sound_in_order(tin, context)) {
    if (mending) *mending = {};
    return *std::move(sound);
  }
  Audit audit(std::move(tin), 20, context);
  audit.run();
  if (!audit.fatal().empty()) refuse(name, audit.fatal());
  warn_of_mends(name, audit, context);
  if (mending) *mending = audit.mending();
  return canonical(audit.take(), context);
}

}  // namespace terrane
