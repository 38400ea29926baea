// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/overlay/shared_faces.hpp"

#include <algorithm>

#include "core/mesh/hilbert.hpp"

namespace terrane {
namespace {

bool has_two_heights(const Tin& tin) {
  const auto same_place = [](const Point& p, const Point& q) { return plan(p) == plan(q); };
  return std::adjacent_find(tin.vertices.begin(), tin.vertices.end(), same_place) != tin.vertices.end();
}

/// The order of vertices in TINs of one extent.
class CurveOrder {
 public:
  explicit CurveOrder(const Box& box) : curve_(box) {}
  bool operator()(const Point& p, const Point& q) const {
    const std::uint64_t kp = curve_.key(p.x, p.y), kq = curve_.key(q.x, q.y);
    return kp != kq ? kp < kq : p.x != q.x ? p.x < q.x : p.y < q.y;
  }

 private:
  HilbertCurve curve_;
};

/// Does B have most of a sample of A's vertices?
bool mostly_shared(const Tin& a, const Tin& b, const CurveOrder& before) {
  constexpr std::size_t sample = 64;
  std::size_t found = 0;
  for (std::size_t i = 0; i < sample; ++i) {
    const Point& p = a.vertices[i * a.vertices.size() / sample];
    const auto q = std::lower_bound(b.vertices.begin(), b.vertices.end(), p, before);
    found += q != b.vertices.end() && plan(*q) == plan(p);
  }
  return 2 * found > sample;
}

std::vector<Index> partners(const Tin& a, const Tin& b, const CurveOrder& before) {
  std::vector<Index> partner(a.vertices.size(), none);
  std::size_t j = 0;
  for (std::size_t i = 0; i < a.vertices.size(); ++i) {
    while (j < b.vertices.size() && !(plan(a.vertices[i]) == plan(b.vertices[j])) &&
           before(b.vertices[j], a.vertices[i]))
      ++j;
    if (j < b.vertices.size() && plan(a.vertices[i]) == plan(b.vertices[j])) partner[i] = static_cast<Index>(j++);
  }
  return partner;
}

/// Faces begin at their lowest vertex and are sorted, and partners are in the same order on both sides.
std::vector<std::array<Index, 2>> same_faces(const Tin& a, const Tin& b, const std::vector<Index>& partner) {
  std::vector<std::array<Index, 2>> same;
  std::size_t g = 0;
  for (std::size_t f = 0; f < a.faces.size(); ++f) {
    const Face& own = a.faces[f];
    const Face face = {partner[own[0]], partner[own[1]], partner[own[2]]};
    if (face[0] == none || face[1] == none || face[2] == none) continue;
    while (g < b.faces.size() && b.faces[g] < face) ++g;
    if (g < b.faces.size() && b.faces[g] == face) same.push_back({static_cast<Index>(f), static_cast<Index>(g++)});
  }
  return same;
}

void keep_rest(const Tin& tin, int m, Divided& divided) {
  std::vector<Index>& number = divided.vertex[m];
  number.assign(tin.vertices.size(), none);
  auto next = divided.shared.begin();
  for (std::size_t f = 0; f < tin.faces.size(); ++f) {
    if (next != divided.shared.end() && (*next)[m] == static_cast<Index>(f)) {
      ++next;
      continue;
    }
    divided.face[m].push_back(static_cast<Index>(f));
    for (const Index v : tin.faces[f]) number[v] = 0;  // used; its number follows
  }
  Tin& rest = divided.rest[m];
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == none) continue;
    number[v] = static_cast<Index>(rest.vertices.size());
    rest.vertices.push_back(tin.vertices[v]);
  }
  rest.faces.reserve(divided.face[m].size());
  for (const Index f : divided.face[m]) {
    const Face& face = tin.faces[f];
    rest.faces.push_back({number[face[0]], number[face[1]], number[face[2]]});
  }
}

}  // namespace

std::optional<Divided> divide(const Tin& a, const Tin& b) {
  const Box extent = bounds(a);
  if (a.faces.empty() || b.faces.empty() || !(extent == bounds(b))) return {};
  const CurveOrder before(extent);
  if (!mostly_shared(a, b, before) || has_two_heights(a) || has_two_heights(b)) return {};
  Divided divided;
  divided.partner = partners(a, b, before);
  divided.shared = same_faces(a, b, divided.partner);
  if (2 * divided.shared.size() < std::min(a.faces.size(), b.faces.size())) return {};
  keep_rest(a, 0, divided);
  keep_rest(b, 1, divided);
  if (divided.rest[0].faces.empty() != divided.rest[1].faces.empty()) return {};
  return divided;
}

std::optional<Overlay> put_together(const Divided& divided, const Tin& a, const Tin& b, Overlay result) {
  // The vertices of the overlay of the rests begin with those of A; those of B that are not A's follow.
  std::vector<Index> of_b(divided.rest[1].vertices.size(), none);
  for (std::size_t v = 0; v < a.vertices.size(); ++v) {
    const Index in_a = divided.vertex[0][v], q = divided.partner[v];
    if (in_a != none && q != none && divided.vertex[1][q] != none) of_b[divided.vertex[1][q]] = in_a;
  }
  Index next = static_cast<Index>(divided.rest[0].vertices.size());
  for (Index& v : of_b)
    if (v == none) v = next++;
  const auto stands_at = [&](std::size_t v, const Point& p) {
    return v < result.points.size() && result.points[v] == plan(p);
  };
  for (std::size_t i = 0; i < divided.rest[0].vertices.size(); ++i)
    if (!stands_at(i, divided.rest[0].vertices[i])) return {};
  for (std::size_t j = 0; j < of_b.size(); ++j)
    if (!stands_at(of_b[j], divided.rest[1].vertices[j])) return {};

  std::vector<Index> number(a.vertices.size(), none);
  const auto number_of = [&](Index v) {
    if (number[v] != none) return number[v];
    const Index q = divided.partner[v];
    Index n = divided.vertex[0][v];
    if (n == none && divided.vertex[1][q] != none) n = of_b[divided.vertex[1][q]];
    if (n == none) {
      n = static_cast<Index>(result.points.size());
      result.points.push_back(plan(a.vertices[v]));
      for (auto& z : result.heights) z.push_back(0);
    }
    result.heights[0][n] = a.vertices[v].z;
    result.heights[1][n] = b.vertices[q].z;
    return number[v] = n;
  };
  const std::size_t faces = result.faces.size() + divided.shared.size();
  result.faces.reserve(faces);
  result.parents.reserve(faces);
  const std::size_t points = result.points.size() + a.vertices.size() - divided.rest[0].vertices.size();
  result.points.reserve(points);
  for (auto& z : result.heights) z.reserve(points);
  for (std::array<Index, 2>& parents : result.parents)
    for (int m = 0; m < 2; ++m)
      if (parents[m] != none) parents[m] = divided.face[m][parents[m]];
  for (const std::array<Index, 2>& parents : divided.shared) {
    const Face& face = a.faces[parents[0]];
    result.faces.push_back({number_of(face[0]), number_of(face[1]), number_of(face[2])});
    result.parents.push_back(parents);
  }
  result.rounding.regions += static_cast<Index>(divided.shared.size());
  return result;
}

}  // namespace terrane
