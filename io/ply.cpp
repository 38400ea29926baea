// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include "io/bad_input.hpp"
#include "io/format_list.hpp"
#include "io/ply_body.hpp"
#include "io/ply_header.hpp"
#include "io/polygon.hpp"
#include "io/rows.hpp"
#include "io/text.hpp"

// PLY: ASCII and both binary orders in, binary little-endian doubles out.
namespace terrane {

namespace {

static_assert(std::endian::native == std::endian::little, "rows are copied as they lie in memory");
static_assert(sizeof(Point) == 3 * sizeof(double), "a vertex is x, y and z and nothing else");

constexpr std::size_t face_row = 1 + sizeof(Face);  // three, and the corners

/// Rows to take at a time where they are copied: what was touched is still in the cache when it is looked at.
constexpr std::size_t batch = 16384;

class PlyReader {
 public:
  PlyReader(Source source, const ReadOptions& options, Context& context)
      : header_(read_ply_header(source, options)),
        body_(std::move(source), header_.encoding),
        options_(options),
        context_(context) {}

  Dataset read() {
    Dataset out;
    if (!header_.crs.empty()) out.crs = declared_crs(header_.crs, options_, context_);
    bool vertices = false, faces = false;
    for (const PlyElement& element : header_.elements) {
      const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
      if ((is_vertex && vertices) || (is_face && faces))
        bad_input(options_, "bad-header", "", "two elements of the same name in the header");
      if (is_vertex) {
        vertices = true;
        read_vertices(element);
      } else if (is_face) {
        faces = true;
        read_faces(element);
      } else {
        skip_element(element);
      }
    }
    if (!vertices) bad_input(options_, "bad-header", "", "the header names no element vertex");
    if (!faces)
      bad_input(options_, "bad-header", "",
                "the header names no element face: points are no surface; triangulate them");
    finish();
    out.surface = std::move(tin_);
    return out;
  }

 private:
  struct Polygon {
    std::size_t first, count, face;
  };

  [[noreturn]] void bad_row(const std::string& place) { bad_row(place, body_.left() < 8); }
  [[noreturn]] void bad_row(const std::string& place, bool at_end) {
    if (body_.encoding() != PlyHeader::ascii && at_end)
      bad_input(options_, "truncated", place, "the file ends here; send it again");
    bad_input(options_, "bad-number", place, "no finite number, or the file ends here");
  }

  bool skip_property(const PlyProperty& property) {
    const bool ascii = body_.encoding() == PlyHeader::ascii;
    std::size_t values = 1;
    if (property.list) {
      double count = 0;
      if (!body_.read(property.count_type, count) || count < 0 || count != std::floor(count) || count > body_.left())
        return false;
      values = static_cast<std::size_t>(count);
    }
    if (!ascii) return body_.skip(values * ply_size(property.type));
    for (; values != 0; --values)
      if (!body_.skip_word()) return false;
    return true;
  }

  void skip_element(const PlyElement& element) {
    if (element.properties.empty()) return;
    for (std::size_t row = 0; row < element.count; ++row) {
      if (row % 65536 == 65535) context_.progress("read", 0.5);
      for (const PlyProperty& property : element.properties)
        if (!skip_property(property))
          bad_row("element " + one_line(element.name.substr(0, 40)) + " " + std::to_string(row));
    }
  }

  /// Rows as we write them are copied instead of taken apart.
  bool is_ours(const PlyElement& element) const {
    if (header_.encoding != PlyHeader::little) return false;
    const auto& properties = element.properties;
    if (element.name == "face")
      return properties.size() == 1 && properties[0].list && ply_size(properties[0].count_type) == 1 &&
             properties[0].type == PlyScalar::i32;
    return properties.size() == 3 && std::equal(properties.begin(), properties.end(), "xyz", [](const auto& p, char axis) {
             return p.name[0] == axis && p.type == PlyScalar::f64;
           });
  }

  void copy_vertices(std::size_t count) {
    for (std::size_t row = 0; row < count; row += batch) {
      context_.progress("read", body_.fraction());
      tin_.vertices.resize(std::min(count, row + batch));
      const std::span<Point> rows = std::span(tin_.vertices).subspan(row);
      const std::size_t there = body_.copy(reinterpret_cast<char*>(rows.data()), rows.size_bytes()) / sizeof(Point);
      for (std::size_t k = 0; k < rows.size(); ++k) {
        const Point& p = rows[k];
        if (k == there || !std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
          bad_row("vertex " + std::to_string(row + k), k == there);
      }
    }
  }

  /// Triangles up to the first row that is none or is wrong; how many there were.
  std::size_t copy_faces(std::size_t count) {
    for (std::size_t row = 0; row < count;) {
      context_.progress("read", body_.fraction());
      const std::string_view seen = body_.peek(std::min(count - row, batch) * face_row);
      const std::size_t rows = std::min({count - row, batch, seen.size() / face_row});
      tin_.faces.resize(row + rows);
      std::size_t good = 0;
      for (const char* p = seen.data(); good < rows && *p == 3; ++good, p += face_row) {
        Face& face = tin_.faces[row + good];
        std::memcpy(face.data(), p + 1, sizeof(Face));
        if (std::ranges::any_of(face, [](Index v) { return v < 0 || v == std::numeric_limits<Index>::max(); })) break;
        check_indices(face, row + good);
      }
      body_.skip(good * face_row);
      tin_.faces.resize(row += good);
      if (good < rows || rows == 0) return row;
    }
    return count;
  }

  void read_vertices(const PlyElement& element) {
    check_count(options_, element.count, options_.max_vertices, "vertices");
    std::vector<int> axis;  // of each property, or -1
    int found = 0;
    for (const PlyProperty& property : element.properties) {
      const std::size_t k = property.list || property.name.size() != 1 ? std::string_view::npos
                                                                       : std::string_view("xyz").find(property.name[0]);
      axis.push_back(k == std::string_view::npos ? -1 : static_cast<int>(k));
      if (axis.back() >= 0) {
        if (found & 1 << axis.back()) bad_input(options_, "bad-header", "", "a vertex has the same coordinate twice");
        found |= 1 << axis.back();
      }
    }
    if (found != 7) bad_input(options_, "bad-header", "", "a vertex needs the properties x, y and z");
    tin_.vertices.reserve(element.count);
    if (is_ours(element)) return copy_vertices(element.count);
    for (std::size_t row = 0; row < element.count; ++row) {
      if (row % 65536 == 65535)
        context_.progress("read", static_cast<double>(row) / static_cast<double>(element.count) / 2);
      double xyz[3];
      for (std::size_t k = 0; k < axis.size(); ++k) {
        const PlyProperty& property = element.properties[k];
        if (axis[k] < 0 ? !skip_property(property) : !body_.read(property.type, xyz[axis[k]]))
          bad_row("vertex " + std::to_string(row));
      }
      tin_.vertices.push_back({xyz[0], xyz[1], xyz[2]});
    }
  }

  void read_faces(const PlyElement& element) {
    std::size_t list = element.properties.size();
    for (std::size_t k = 0; k < element.properties.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      if (property.list && (property.name == "vertex_indices" || property.name == "vertex_index")) list = k;
    }
    if (list == element.properties.size() && element.count != 0)
      bad_input(options_, "bad-header", "", "a face needs the list property vertex_indices");
    tin_.faces.reserve(element.count);
    for (std::size_t row = is_ours(element) ? copy_faces(element.count) : 0; row < element.count; ++row) {
      if (row % 65536 == 65535)
        context_.progress("read", 0.5 + static_cast<double>(row) / static_cast<double>(element.count) / 2);
      for (std::size_t k = 0; k < element.properties.size(); ++k) {
        if (k == list)
          read_corners(element.properties[k], row);
        else if (!skip_property(element.properties[k]))
          bad_row("face " + std::to_string(row));
      }
    }
  }

  void read_corners(const PlyProperty& property, std::size_t face) {
    const auto place = [&] { return "face " + std::to_string(face); };
    double count = 0;
    if (!body_.read(property.count_type, count)) bad_row(place());
    if (!(count >= 3 && count <= max_polygon_corners) || count != std::floor(count))
      bad_input(
          options_, "bad-face", place(),
          "a face has from 3 to " + std::to_string(max_polygon_corners) + " corners; triangulate larger ones first");
    const std::size_t first = corners_.size();
    for (int k = 0; k < static_cast<int>(count); ++k) {
      double index = 0;
      if (!body_.read(property.type, index)) bad_row(place());
      if (!(index >= 0 && index < 0x7fffffff) || index != std::floor(index))
        bad_input(options_, "index-out-of-range", place(), "a vertex index is no whole number from 0 up");
      corners_.push_back(static_cast<Index>(index));
    }
    if (count == 3) {
      tin_.faces.push_back({corners_[first], corners_[first + 1], corners_[first + 2]});
      check_indices(std::span(corners_).subspan(first), face);
      corners_.resize(first);
    } else {
      polygons_.push_back({first, static_cast<std::size_t>(count), face});
    }
  }

  /// Faces may stand before vertices in the file; their indices are looked at when the vertices are there.
  void check_indices(std::span<const Index> corners, std::size_t face) {
    for (Index v : corners)
      if (v >= std::max(furthest_, static_cast<Index>(tin_.vertices.size()))) {
        furthest_ = v;
        furthest_face_ = face;
      }
  }

  void finish() {
    for (const Polygon& polygon : polygons_)
      check_indices(std::span(corners_).subspan(polygon.first, polygon.count), polygon.face);
    if (furthest_ >= static_cast<Index>(tin_.vertices.size()))
      bad_input(options_, "index-out-of-range", "face " + std::to_string(furthest_face_),
                "vertex " + std::to_string(furthest_) + " does not exist; there are " +
                    std::to_string(tin_.vertices.size()) + ", counted from 0");
    std::size_t done = 0;
    for (const Polygon& polygon : polygons_) {
      if (++done % 256 == 0) context_.progress("read", 1);
      if (!append_polygon(tin_.faces, tin_.vertices, std::span(corners_).subspan(polygon.first, polygon.count)))
        bad_input(options_, "bad-face", "face " + std::to_string(polygon.face),
                  "a polygon that crosses itself in plan; triangulate it first");
    }
  }

  PlyHeader header_;
  PlyBody body_;
  const ReadOptions& options_;
  Context& context_;
  Tin tin_;
  std::vector<Index> corners_;  // of the polygons, one after another
  std::vector<Polygon> polygons_;
  Index furthest_ = -1;
  std::size_t furthest_face_ = 0;
};

void write_ply(const Tin& tin, const Crs& crs, const WriteOptions& options, const Sink& sink, Context& context) {
  std::string head = "ply\nformat binary_little_endian 1.0\n";
  if (crs.known()) head.append("comment crs: ").append(one_line(crs.id())).append("\n");
  for (const auto& [key, value] : options.extra)
    head.append("comment ").append(one_line(key)).append(": ").append(one_line(value)).append("\n");
  head.append("element vertex ").append(std::to_string(tin.vertices.size()));
  head.append("\nproperty double x\nproperty double y\nproperty double z\nelement face ");
  head.append(std::to_string(tin.faces.size())).append("\nproperty list uchar int vertex_indices\nend_header\n");
  sink(head);
  context.progress("write", 0);
  const std::span<const std::byte> vertices = std::as_bytes(std::span(tin.vertices));
  if (!vertices.empty()) sink({reinterpret_cast<const char*>(vertices.data()), vertices.size()});
  RowWriter rows(sink, tin.faces.size(), context);
  rows.write(tin.faces.size(), face_row, [&](char* to, std::size_t i) {
    *to = 3;
    std::memcpy(to + 1, tin.faces[i].data(), sizeof(Face));
    return to + face_row;
  });
}

}  // namespace

Format ply_format() {
  return {"ply",
          {".ply"},
          "model/ply",
          "PLY, binary little-endian doubles (ASCII, big-endian and floats are read), CRS in a comment.",
          [](Source source, const ReadOptions& options, Context& context) {
            source.skip_mark();
            return PlyReader(std::move(source), options, context).read();
          },
          write_ply,
          [](std::string_view head) { return head.starts_with("ply\n") || head.starts_with("ply\r\n"); }};
}

}  // namespace terrane
