// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "core/error.hpp"
#include "core/triangulate.hpp"
#include "io/format.hpp"

// How a reader complains: "t3.obj, line 42: a coordinate is not a finite number". One shape for every format.
namespace terrane {

/// `element` is "line 42" or "vertex 17", or empty when the whole file is meant. Bytes of the file are not echoed.
[[noreturn]] inline void bad_input(const ReadOptions& options, std::string code, const std::string& element,
                                   const std::string& what) {
  std::string message = options.name.empty() ? "input" : options.name;
  if (!element.empty()) message += ", " + element;
  throw Error(ErrorKind::input, std::move(code), message + ": " + what);
}

/// Refuses before memory is taken.
inline void check_count(const ReadOptions& options, std::size_t count, std::size_t limit, const char* things) {
  if (count > limit)
    throw Error(ErrorKind::limit, std::string("too-many-") + things,
                (options.name.empty() ? "input" : options.name) + ": more than " + std::to_string(limit) + " " +
                    things + "; split the input into tiles or raise the limit");
}

/// Refuses a raster that no TIN can be made of while the input's name is known.
inline void check_raster(const ReadOptions& options, const Raster& raster) {
  try {
    check_triangulable(raster);
  } catch (const Error& error) {
    throw Error(error.kind, error.code, (options.name.empty() ? "input" : options.name) + ": " + error.what());
  }
}

/// The CRS a file declares. One that cannot be understood is a warning and none, because `crs` may yet replace it.
inline Crs declared_crs(std::string_view text, const ReadOptions& options, Context& context) {
  try {
    return Crs::parse(text);
  } catch (const Error&) {
    context.warn({"bad-crs", options.name, "", "the coordinate reference system the file declares is not understood",
                  "give the right one with crs or assume-crs"});
    return {};
  }
}

}  // namespace terrane
