// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/tin.hpp"

namespace terrane {

/// The faces of a TIN by where they lie, for questions about many small parts of it. Faces that follow each other lie
/// near each other where the TIN is in canonical order; any other is answered as truly and more slowly. Keeps a
/// reference to the TIN. O(n), half a byte a face; many threads may ask.
class FaceRuns {
 public:
  explicit FaceRuns(const Tin& tin);

  /// The faces, walls among them, whose box in plan touches `box`, in their order, with the vertices they need: a TIN
  /// as valid as the whole.
  Tin near(const Box& box) const;

 private:
  const Tin& tin_;
  std::vector<Box> boxes_;  // of each run of faces
};

}  // namespace terrane
