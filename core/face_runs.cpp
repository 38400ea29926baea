// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/face_runs.hpp"

#include <algorithm>

#include "core/box.hpp"

namespace terrane {
namespace {

constexpr std::size_t run_length = 64;

}  // namespace

FaceRuns::FaceRuns(const Tin& tin) : tin_(tin) {
  for (std::size_t f = 0; f < tin.faces.size(); ++f) {
    if (f % run_length == 0) boxes_.push_back(no_box);
    boxes_.back() = around(boxes_.back(), box_of(tin, tin.faces[f]));
  }
}

Tin FaceRuns::near(const Box& box) const {
  Tin part;
  std::vector<Index> used;
  for (std::size_t run = 0; run < boxes_.size(); ++run) {
    if (!touches(boxes_[run], box)) continue;
    const std::size_t end = std::min((run + 1) * run_length, tin_.faces.size());
    for (std::size_t f = run * run_length; f < end; ++f) {
      if (!touches(box_of(tin_, tin_.faces[f]), box)) continue;
      part.faces.push_back(tin_.faces[f]);
      used.insert(used.end(), tin_.faces[f].begin(), tin_.faces[f].end());
    }
  }
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  part.vertices.reserve(used.size());
  for (const Index v : used) part.vertices.push_back(tin_.vertices[v]);
  for (Face& f : part.faces)
    for (Index& v : f) v = static_cast<Index>(std::lower_bound(used.begin(), used.end(), v) - used.begin());
  return part;
}

}  // namespace terrane
