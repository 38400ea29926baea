// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstring>
#include <limits>

#include "io/bad_input.hpp"
#include "io/format_list.hpp"
#include "io/obj_lines.hpp"
#include "io/polygon.hpp"
#include "io/rows.hpp"
#include "io/text.hpp"

// Wavefront OBJ, Z up. The first line says whose file it is and that an end line follows, so that a cut is noticed.
namespace terrane {

namespace {

constexpr std::string_view header = "# Terrane TIN, Z up, closed by an end line";

class ObjReader {
 public:
  ObjReader(Source source, const ReadOptions& options, Context& context)
      : source_(std::move(source)), options_(options), context_(context) {}

  Dataset read();

 private:
  struct Polygon {
    std::size_t first, count, line;
  };

  void read_block(std::string_view block);
  void read_piece(ObjLines& plain, const char* begin, const char* end);
  bool append(const ObjLines& plain, const char* p, const char* end);
  const char* read_any_line(const char* p, const char* end);
  void read_line(const char* p, const char* end);
  void read_comment(std::string_view text);
  void read_vertex(const char* p, const char* end);
  void read_face(const char* p, const char* end);
  Index corner(const char*& p, const char* end);
  void read_end(std::string_view text);
  void finish();
  [[noreturn]] void bad(std::string code, const std::string& what, std::size_t line) const {
    bad_input(options_, std::move(code), "line " + std::to_string(line), what);
  }

  Index largest_index() const {
    return static_cast<Index>(std::min<std::size_t>(options_.max_vertices, std::numeric_limits<Index>::max()));
  }

  Source source_;
  const ReadOptions& options_;
  Context& context_;
  std::vector<ObjLines> pieces_ = std::vector<ObjLines>(8);
  Dataset out_;
  Tin tin_;
  std::vector<Index> corners_;  // of the polygons, one after another
  std::vector<Polygon> polygons_;
  std::size_t line_ = 0, faces_ = 0;
  Index furthest_ = -1;  // the largest index used before its vertex was there
  std::size_t furthest_line_ = 0;
  bool ours_ = false, ended_ = false;
};

Dataset ObjReader::read() {
  source_.skip_mark();
  for (std::string_view block = source_.block("\n"); !block.empty(); block = source_.block("\n")) {
    context_.progress("read", source_.fraction());
    if (block.find('\0') != std::string_view::npos) bad_input(options_, "not-obj", "", "this is no text, so no OBJ");
    read_block(block);
  }
  finish();
  out_.surface = std::move(tin_);
  return std::move(out_);
}

/// Pieces of a block are read apart as far as their lines are plain, then put together in their order.
void ObjReader::read_block(std::string_view block) {
  std::vector<std::string_view> texts;
  for (std::size_t left = pieces_.size(); !block.empty(); --left) {
    const std::size_t newline = left == 1 ? std::string_view::npos : block.find('\n', block.size() / left);
    texts.push_back(block.substr(0, newline == std::string_view::npos ? newline : newline + 1));
    block.remove_prefix(texts.back().size());
  }
  parallel_tasks(context_, texts.size(), [&](std::size_t i) {
    pieces_[i].read(texts[i].data(), texts[i].data() + texts[i].size(), largest_index());
  });
  for (std::size_t i = 0; i < texts.size(); ++i)
    read_piece(pieces_[i], texts[i].data(), texts[i].data() + texts[i].size());
}

void ObjReader::read_piece(ObjLines& plain, const char* p, const char* end) {
  while (append(plain, p, end)) {
    p = plain.stop;
    if (p == end) return;
    p = read_any_line(p, end);
    plain.read(p, end, largest_index());
  }
  while (p != end) p = read_any_line(p, end);
}

/// False where there are too many vertices: reading them one by one makes the complaint.
bool ObjReader::append(const ObjLines& plain, const char* p, const char* end) {
  if (plain.vertices.size() > options_.max_vertices - tin_.vertices.size()) return false;
  const std::size_t left = source_.left() + static_cast<std::size_t>(end - plain.stop);
  make_room(tin_.vertices, plain.vertices.size(), static_cast<std::size_t>(plain.stop - p), left);
  make_room(tin_.faces, plain.faces.size(), static_cast<std::size_t>(plain.stop - p), left);
  tin_.vertices.insert(tin_.vertices.end(), plain.vertices.begin(), plain.vertices.end());
  tin_.faces.insert(tin_.faces.end(), plain.faces.begin(), plain.faces.end());
  if (plain.furthest > furthest_) {
    furthest_ = plain.furthest;
    furthest_line_ = line_ + plain.furthest_line;
  }
  faces_ += plain.faces.size();
  line_ += plain.lines;
  return true;
}

/// One line by the book; where the next begins.
const char* ObjReader::read_any_line(const char* p, const char* end) {
  const auto* newline = static_cast<const char*>(std::memchr(p, '\n', static_cast<std::size_t>(end - p)));
  ++line_;
  read_line(p, newline ? newline : end);
  return newline ? newline + 1 : end;
}

void ObjReader::read_line(const char* p, const char* end) {
  p = skip_blanks(p, end);
  if (p == end) return;
  const bool one_letter = end - p > 1 && is_blank(p[1]);
  if (*p == '#')
    read_comment(std::string_view(p, static_cast<std::size_t>(end - p)));
  else if (*p == 'v' && one_letter)
    read_vertex(p + 1, end);
  else if (*p == 'f' && one_letter)
    read_face(p + 1, end);
  else if ((*p == 'v' || *p == 'f') && end - p == 1)
    bad("bad-line", "a vertex or face without numbers; the file is cut off or damaged", line_);
  else if (!((*p >= 'a' && *p <= 'z') || (*p >= 'A' && *p <= 'Z')))
    bad("bad-line", "no statement of an OBJ file", line_);
}

void ObjReader::read_comment(std::string_view text) {
  if (line_ == 1 && trimmed(text) == header) ours_ = true;
  text = trimmed(text.substr(1));
  if (text.starts_with("crs:") && !out_.crs.known()) {
    const std::string_view crs = trimmed(text.substr(4));
    if (!crs.empty()) out_.crs = declared_crs(crs, options_, context_);
  } else if (text.starts_with("end v=")) {
    read_end(text.substr(6));
  }
}

void ObjReader::read_end(std::string_view text) {
  std::size_t vertices = 0, faces = 0;
  const char* const end = text.data() + text.size();
  auto [p, error] = std::from_chars(text.data(), end, vertices);
  p = skip_blanks(p, end);
  const bool found = error == std::errc() && end - p > 2 && p[0] == 'f' && p[1] == '=' &&
                     std::from_chars(p + 2, end, faces).ec == std::errc();
  if (!found || vertices != tin_.vertices.size() || faces != faces_)
    bad("truncated",
        "the end line counts " + std::to_string(vertices) + " vertices and " + std::to_string(faces) +
            " faces, but there are " + std::to_string(tin_.vertices.size()) + " and " + std::to_string(faces_) +
            "; send the file again",
        line_);
  ended_ = true;
}

void ObjReader::read_vertex(const char* p, const char* end) {
  double xyz[3];
  for (double& value : xyz) {
    p = skip_blanks(p, end);
    p = p == end ? nullptr : parse_number(p, end, value);
    if (!p || (p != end && !is_blank(*p)))
      bad("bad-number", "vertex " + std::to_string(tin_.vertices.size() + 1) + " needs three finite numbers", line_);
  }
  check_count(options_, tin_.vertices.size() + 1, options_.max_vertices, "vertices");
  tin_.vertices.push_back({xyz[0], xyz[1], xyz[2]});
}

Index ObjReader::corner(const char*& p, const char* end) {
  long long index = 0;
  const auto [next, error] = std::from_chars(p, end, index);
  if (error == std::errc::invalid_argument || (next != end && !is_blank(*next) && *next != '/'))
    bad("bad-number", "face " + std::to_string(faces_ + 1) + " needs whole numbers as vertex indices", line_);
  const auto count = static_cast<long long>(tin_.vertices.size());
  const bool fits = error == std::errc() && index != 0 && index >= -count && index <= largest_index();
  if (!fits)
    bad("index-out-of-range",
        "face " + std::to_string(faces_ + 1) + " uses a vertex that does not exist; indices run from 1 to " +
            std::to_string(count) + " or from -1 backwards",
        line_);
  p = next;
  while (p != end && !is_blank(*p)) ++p;  // texture and normal indices
  const auto at = static_cast<Index>(index < 0 ? count + index : index - 1);
  if (at >= count && at > furthest_) {
    furthest_ = at;
    furthest_line_ = line_;
  }
  return at;
}

void ObjReader::read_face(const char* p, const char* end) {
  const std::size_t first = corners_.size();
  for (p = skip_blanks(p, end); p != end; p = skip_blanks(p, end)) corners_.push_back(corner(p, end));
  const std::size_t count = corners_.size() - first;
  if (count < 3) bad("bad-face", "face " + std::to_string(faces_ + 1) + " has fewer than three corners", line_);
  if (count > max_polygon_corners)
    bad("bad-face",
        "face " + std::to_string(faces_ + 1) + " has more than " + std::to_string(max_polygon_corners) +
            " corners; triangulate it first",
        line_);
  ++faces_;
  if (count == 3) {
    tin_.faces.push_back({corners_[first], corners_[first + 1], corners_[first + 2]});
    corners_.resize(first);
  } else {
    polygons_.push_back({first, count, line_});
  }
}

void ObjReader::finish() {
  if (ours_ && !ended_) bad("truncated", "the end line is missing, so the file is cut off; send it again", line_);
  if (furthest_ >= static_cast<Index>(tin_.vertices.size()))
    bad("index-out-of-range",
        "a face uses vertex " + std::to_string(furthest_ + 1ll) + " of " + std::to_string(tin_.vertices.size()),
        furthest_line_);
  if (tin_.vertices.empty() && faces_ == 0 && !ours_)
    bad_input(options_, "not-obj", "", "no vertex and no face of an OBJ file");
  std::size_t done = 0;
  for (const Polygon& polygon : polygons_) {
    if (++done % 256 == 0) context_.progress("read", 1);
    if (!append_polygon(tin_.faces, tin_.vertices, std::span(corners_).subspan(polygon.first, polygon.count)))
      bad("bad-face", "a polygon that crosses itself in plan; triangulate it first", polygon.line);
  }
}

void write_obj(const Tin& tin, const Crs& crs, const WriteOptions& options, const Sink& sink, Context& context) {
  std::string text(header);
  text += '\n';
  if (crs.known()) text.append("# crs: ").append(one_line(crs.id())).append("\n");
  for (const auto& [key, value] : options.extra)
    text.append("# ").append(one_line(key)).append(": ").append(one_line(value)).append("\n");
  sink(text);
  RowWriter rows(sink, tin.vertices.size() + tin.faces.size(), context);
  rows.write(tin.vertices.size(), 3 * (number_size + 1) + 2, [&](char* to, std::size_t i) {
    const Point& p = tin.vertices[i];
    *to++ = 'v';
    for (double value : {p.x, p.y, p.z}) {
      *to++ = ' ';
      to = put_number(to, value);
    }
    *to++ = '\n';
    return to;
  });
  rows.write(tin.faces.size(), 3 * (number_size + 1) + 2, [&](char* to, std::size_t i) {
    *to++ = 'f';
    for (Index v : tin.faces[i]) {
      *to++ = ' ';
      to = put_number(to, std::uint32_t{1} + static_cast<std::uint32_t>(v));
    }
    *to++ = '\n';
    return to;
  });
  sink("# end v=" + std::to_string(tin.vertices.size()) + " f=" + std::to_string(tin.faces.size()) + "\n");
}

/// Comments fit many text formats; the first statement decides.
bool sniff_obj(std::string_view head) {
  if (head.starts_with(header)) return true;
  while (!head.empty()) {
    const std::size_t newline = head.find('\n');
    const std::string_view line = trimmed(head.substr(0, newline));
    if (!line.empty() && line.front() != '#') {
      double number;
      if (line.starts_with("v ")) {
        const char* end = line.data() + line.size();
        return parse_number(skip_blanks(line.data() + 2, end), end, number) != nullptr;
      }
      return line.starts_with("mtllib ") || line.starts_with("o ") || line.starts_with("g ");
    }
    if (newline == std::string_view::npos) return false;
    head.remove_prefix(newline + 1);
  }
  return false;
}

}  // namespace

Format obj_format() {
  return {"obj",
          {".obj"},
          "model/obj",
          "Wavefront OBJ, Z up, with full double precision and the CRS in a comment.",
          [](Source source, const ReadOptions& options, Context& context) {
            return ObjReader(std::move(source), options, context).read();
          },
          write_obj,
          sniff_obj};
}

}  // namespace terrane
