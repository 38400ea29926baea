// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "io/format.hpp"

namespace terrane {

enum class PlyScalar { i8, u8, i16, u16, i32, u32, f32, f64 };
std::size_t ply_size(PlyScalar type);

struct PlyProperty {
  std::string name;
  PlyScalar type = PlyScalar::f64;  // of the value, or of a list's values
  bool list = false;
  PlyScalar count_type = PlyScalar::u8;
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;

  /// The fewest bytes a row can take: what makes a huge count in a short file visible before memory is taken.
  std::size_t least_row(bool ascii) const;
};

struct PlyHeader {
  enum Encoding { ascii, little, big } encoding = ascii;
  std::vector<PlyElement> elements;
  std::string crs;       // of "comment crs:", empty without
};

/// Takes the header, with every count checked against the bytes that follow.
PlyHeader read_ply_header(Source& source, const ReadOptions& options);

}  // namespace terrane
