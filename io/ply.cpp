// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <cstring>

#include "io/bad_input.hpp"
#include "io/format_list.hpp"
#include "io/ply_header.hpp"
#include "io/polygon.hpp"
#include "io/text.hpp"

// PLY: ASCII and both binary orders in, binary little-endian doubles out.
namespace terrane {

namespace {

static_assert(std::endian::native == std::endian::little, "rows are copied as they lie in memory");

/// Values of the body one after another, whatever the encoding. Null pointers into the bytes never leave this class.
class Body {
 public:
  Body(std::string_view bytes, PlyHeader::Encoding encoding)
      : p_(bytes.data()), end_(p_ + bytes.size()), encoding_(encoding) {}

  std::size_t left() const { return static_cast<std::size_t>(end_ - p_); }
  PlyHeader::Encoding encoding() const { return encoding_; }

  /// False at the end of the bytes or where there is no finite number.
  bool read(PlyScalar type, double& value) {
    if (encoding_ == PlyHeader::ascii) return read_text(value);
    if (left() < ply_size(type)) return false;
    switch (type) {
      case PlyScalar::i8: value = binary<std::int8_t>(); break;
      case PlyScalar::u8: value = binary<std::uint8_t>(); break;
      case PlyScalar::i16: value = binary<std::int16_t>(); break;
      case PlyScalar::u16: value = binary<std::uint16_t>(); break;
      case PlyScalar::i32: value = binary<std::int32_t>(); break;
      case PlyScalar::u32: value = binary<std::uint32_t>(); break;
      case PlyScalar::f32: value = std::bit_cast<float>(binary<std::uint32_t>()); break;
      case PlyScalar::f64: value = std::bit_cast<double>(binary<std::uint64_t>()); break;
    }
    return std::isfinite(value);
  }

  bool skip(std::size_t bytes) {
    if (left() < bytes) return false;
    p_ += bytes;
    return true;
  }

  bool skip_word() {
    p_ = skip_spaces(p_, end_);
    if (p_ == end_) return false;
    while (p_ != end_ && !is_space(*p_)) ++p_;
    return true;
  }

 private:
  bool read_text(double& value) {
    p_ = skip_spaces(p_, end_);
    const char* after = p_ == end_ ? nullptr : parse_number(p_, end_, value);
    if (!after || (after != end_ && !is_space(*after))) return false;
    p_ = after;
    return true;
  }

  template <class T>
  T binary() {
    unsigned char raw[sizeof(T)];
    std::memcpy(raw, p_, sizeof(T));
    p_ += sizeof(T);
    if (encoding_ == PlyHeader::big) std::reverse(raw, raw + sizeof(T));
    T value;
    std::memcpy(&value, raw, sizeof(T));
    return value;
  }

  const char *p_, *end_;
  PlyHeader::Encoding encoding_;
};

class PlyReader {
 public:
  PlyReader(std::string_view bytes, const ReadOptions& options, Context& context)
      : header_(read_ply_header(bytes, options)),
        body_(bytes.substr(header_.size), header_.encoding),
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

  [[noreturn]] void bad_row(const std::string& place) {
    if (body_.encoding() != PlyHeader::ascii && body_.left() < 8)
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
    for (std::size_t row = 0; row < element.count; ++row) {
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
  Body body_;
  const ReadOptions& options_;
  Context& context_;
  Tin tin_;
  std::vector<Index> corners_;  // of the polygons, one after another
  std::vector<Polygon> polygons_;
  Index furthest_ = -1;
  std::size_t furthest_face_ = 0;
};

template <class T>
void append_raw(std::string& out, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  out.append(raw, sizeof(T));
}

std::string write_ply(const Tin& tin, const Crs& crs, const WriteOptions& options, Context& context) {
  std::string out = "ply\nformat binary_little_endian 1.0\n";
  out.reserve(4096 + tin.vertices.size() * 24 + tin.faces.size() * 13);
  if (crs.known()) out.append("comment crs: ").append(one_line(crs.id())).append("\n");
  for (const auto& [key, value] : options.extra)
    out.append("comment ").append(one_line(key)).append(": ").append(one_line(value)).append("\n");
  out.append("element vertex ").append(std::to_string(tin.vertices.size()));
  out.append("\nproperty double x\nproperty double y\nproperty double z\nelement face ");
  out.append(std::to_string(tin.faces.size())).append("\nproperty list uchar int vertex_indices\nend_header\n");
  context.progress("write", 0);
  for (const Point& p : tin.vertices) {
    append_raw(out, p.x);
    append_raw(out, p.y);
    append_raw(out, p.z);
  }
  for (const Face& face : tin.faces) {
    out += '\3';
    append_raw(out, face);
  }
  return out;
}

}  // namespace

Format ply_format() {
  return {"ply",
          {".ply"},
          "model/ply",
          "PLY, binary little-endian doubles (ASCII, big-endian and floats are read), CRS in a comment.",
          [](std::string_view bytes, const ReadOptions& options, Context& context) {
            return PlyReader(without_mark(bytes), options, context).read();
          },
          write_ply,
          [](std::string_view head) { return head.starts_with("ply\n") || head.starts_with("ply\r\n"); }};
}

}  // namespace terrane
