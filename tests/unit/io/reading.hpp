// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <variant>

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "io/format.hpp"

// What the tests of this folder share: reading bytes, expecting complaints, awkward numbers, real files.
namespace terrane {

inline Dataset read(const char* format, std::string_view bytes, Context& context, std::string name = "input") {
  return format_named(format)->read(bytes, {.name = std::move(name)}, context);
}

inline Tin read_tin(const char* format, std::string_view bytes) {
  Context context;
  return std::get<Tin>(read(format, bytes, context).surface);
}

inline Raster read_raster(const char* format, std::string_view bytes, std::string name = "input") {
  Context context;
  return std::get<Raster>(read(format, bytes, context, std::move(name)).surface);
}

/// The error reading ends with; code "" when it does not.
inline Error complaint(const char* format, std::string_view bytes, ReadOptions options = {.name = "bad.file"}) {
  Context context;
  try {
    format_named(format)->read(bytes, options, context);
  } catch (const Error& error) {
    return error;
  }
  return {ErrorKind::internal, "", "no error"};
}

#define EXPECT_COMPLAINT(error, expected_code, place)                                \
  do {                                                                               \
    const Error got = (error);                                                       \
    EXPECT_EQ(got.kind, ErrorKind::input) << got.what();                             \
    EXPECT_EQ(got.code, expected_code) << got.what();                                \
    EXPECT_NE(std::string(got.what()).find(place), std::string::npos) << got.what(); \
    EXPECT_EQ(std::string(got.what()).find("bad.file"), 0u) << got.what();           \
  } while (false)

/// Numbers that a careless writer or reader changes.
inline Tin awkward_tin() {
  constexpr double tiny = std::numeric_limits<double>::denorm_min(), large = std::numeric_limits<double>::max();
  Tin tin;
  tin.vertices = {
      {0.1, 0.2, 0.30000000000000004}, {457010.38774669336, 4372383.8235007255, 1.0 / 3}, {-0.0, 1e-320, tiny},
      {large, -large, 5e-324},         {std::nextafter(1.0, 2.0), 1e22, 123456789.125},   {-180, 90, -10994}};
  tin.faces = {{0, 1, 2}, {2, 1, 3}, {3, 4, 5}};
  return tin;
}

inline void expect_same_bits(const Tin& a, const Tin& b) {
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  EXPECT_EQ(a.faces, b.faces);
  for (std::size_t v = 0; v < a.vertices.size(); ++v) {
    EXPECT_EQ(a.vertices[v], b.vertices[v]);
    EXPECT_EQ(std::signbit(a.vertices[v].x), std::signbit(b.vertices[v].x));
  }
}

/// A file of the real data beside the checkout, when it is there.
inline std::optional<std::string> real_file(const std::string& name) {
  std::ifstream file(std::string(TERRANE_SOURCE_DIR) + "/../shared/data/" + name, std::ios::binary);
  if (!file) return std::nullopt;
  std::stringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

}  // namespace terrane
