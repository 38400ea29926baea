// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/context.hpp"
#include "core/raster.hpp"
#include "core/shade.hpp"
#include "core/shapes.hpp"
#include "core/tin.hpp"
#include "io/geodesy.hpp"
#include "io/source.hpp"

// What a format is. The list of all formats is io/formats.cpp; adding one is one file and one line there.
namespace terrane {

/// What an input holds once decoded, and the CRS its bytes declare (none when they do not).
struct Dataset {
  std::variant<Tin, Raster, PointCloud> surface;
  Crs crs;
  /// "m", "ft" or "ftUS": what a raster says itself of its heights, where its CRS says otherwise or nothing.
  std::string height_unit = {};
};

struct ReadOptions {
  std::string name;                          // for messages: "t3.tif"
  std::size_t max_vertices = 200'000'000;    // checked before memory is taken
  std::size_t max_samples = 400'000'000;
  std::string columns = {};      // of point tables: "PNEZD"; empty: by their first line, else x, y, z
  std::vector<int> classes = {}; // of LAS points; empty: all
};

/// Which faces of the inputs each face of a result lies on.
struct Provenance {
  std::vector<std::string> inputs;  // their names
  std::string policy;               // by which the height was decided, in words: "overlap=first"
  /// Fills in the face of every input that a face of the result lies on (none: it has none there), and returns the input
  /// whose height holds (none: that of all of them together). Called on several threads.
  std::function<Index(std::size_t face, std::span<Index> of_inputs)> trace;
};

struct WriteOptions {
  std::string certificate_json;  // formats that can carry it do (Terrane JSON)
  const Provenance* provenance = nullptr;  // Terrane JSON alone
  // further comment lines (key, value) for formats with comments
  std::vector<std::pair<std::string, std::string>> extra;
};

/// Takes the bytes of an output, front to back; a piece is good only during the call. What it throws ends the writing.
using Sink = std::function<void(std::string_view piece)>;

struct Format {
  std::string name;                     // the word of `format` and `f`: "obj"
  std::vector<std::string> extensions;  // with dot, the first is the one we write: ".obj"
  std::string media_type;               // "model/obj"
  std::string description;              // one sentence for people

  /// Decodes an input on the context's threads. Bounded: never more memory than a small multiple of the bytes, and for
  /// meshes little more than the mesh beside the source's own; throws Error{input} naming the element, the same for any
  /// number of threads. Null: we do not read this format.
  std::function<Dataset(Source source, const ReadOptions&, Context&)> read;
  /// Encodes a TIN, block by block, on the context's threads; the same bytes for the same value. Null: we do not write
  /// it.
  std::function<void(const Tin&, const Crs&, const WriteOptions&, const Sink&, Context&)> write;
  /// True when the first bytes can only be this format.
  std::function<bool(std::string_view head)> sniff;
  bool carries_certificate = false;  // what is written depends on WriteOptions::certificate_json
};

/// Every format, in the order of the documentation.
const std::vector<Format>& formats();

/// By `format` word; nullptr when there is none.
const Format* format_named(std::string_view word);
/// By media type (parameters after ';' ignored); nullptr when none. application/octet-stream is nobody's.
const Format* format_of_media_type(std::string_view media_type);
/// By the longest extension that matches the file name, case-insensitive.
const Format* format_of_file(std::string_view file_name);
/// By content.
const Format* format_of_bytes(std::string_view head);

/// A TIN in a format that is written, as bytes in memory.
std::string written(const Format& format, const Tin& tin, const Crs& crs, const WriteOptions& options,
                    Context& context);

/// A raster as the bytes of a GeoTIFF ("tif") or an Esri ASCII grid ("asc"), heights as doubles, voids as the NoData
/// value -9999. The GeoTIFF has cells (pixel is area), blocks of 256 x 256, DEFLATE, and its CRS inside with the vertical
/// part; an ASCII grid holds none. The same bytes for the same values. Warns where the file cannot hold the CRS.
std::string write_raster(const Raster& raster, const Crs& crs, std::string_view word, Context& context);

/// A picture as PNG bytes.
std::string write_png(const Picture& picture);

}  // namespace terrane
