// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/json_reader.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "io/bad_input.hpp"
#include "io/json_rows.hpp"
#include "io/rows.hpp"
#include "io/text.hpp"

namespace terrane {

namespace {

constexpr int max_depth = 64;

class JsonReader {
 public:
  JsonReader(Source source, const ReadOptions& options, Context& context)
      : source_(std::move(source)), options_(options), context_(context) {}

  Dataset read();

 private:
  void read_member(const std::string& key);
  void read_vertices();
  void read_triangles();
  void read_crs();
  std::string read_string();
  unsigned read_hex4();
  void append_escape(std::string& out);
  void skip_value(int depth);
  void skip_word(std::string_view word);
  void check_indices() const;
  template <class Element>
  void read_array(Element&& element);
  template <class Row>
  void read_rows(std::vector<Row>& list, std::vector<JsonRows<Row>>& pieces, std::size_t most);
  template <class Row>
  void append(std::vector<Row>& list, const JsonRows<Row>& rows);

  /// Another block when this one is read; numbers and words are never torn. False at the end of the input.
  bool more() {
    if (p_ != end_) return true;
    if (kept_) kept_->append(kept_from_, end_);
    const std::string_view block = source_.block(" \t\r\n,]}");
    p_ = kept_from_ = block.data();
    end_ = p_ + block.size();
    fresh_ = true;
    return !block.empty();
  }
  void skip_all_spaces() {
    while (more() && (p_ = skip_spaces(p_, end_)) == end_) continue;
  }
  char next() {
    skip_all_spaces();
    if (p_ == end_) bad("truncated", "the text ends in the middle; send the file again");
    return *p_;
  }
  void expect(char c, const char* what) {
    if (next() != c) bad("bad-json", what);
    ++p_;
  }
  void once(bool& seen, const char* member) {
    if (seen) bad("bad-json", std::string("the member ") + member + " occurs twice");
    seen = true;
  }
  [[noreturn]] void bad(std::string code, const std::string& what) const {
    std::string place = element_.empty() ? "" : element_ + ", ";
    bad_input(options_, std::move(code), place + "byte " + std::to_string(source_.position() - static_cast<std::size_t>(end_ - p_)), what);
  }

  Source source_;
  const char *p_ = nullptr, *end_ = nullptr;  // of the block
  bool fresh_ = false;                        // no rows of the block were read yet
  std::string* kept_ = nullptr;               // where the text from kept_from_ on is kept when the block ends
  const char* kept_from_ = nullptr;
  std::vector<JsonRows<Point>> vertex_rows_ = std::vector<JsonRows<Point>>(8);
  std::vector<JsonRows<Face>> face_rows_ = std::vector<JsonRows<Face>>(8);
  const ReadOptions& options_;
  Context& context_;
  std::string element_;  // "vertex 17" while reading it goes wrong
  Crs crs_;
  Tin tin_;
  bool type_ = false, crs_seen_ = false, vertices_ = false, triangles_ = false;
};

Dataset JsonReader::read() {
  source_.skip_mark();
  skip_all_spaces();
  if (p_ == end_ || *p_ != '{') bad("bad-json", "Terrane JSON is one object in braces");
  ++p_;
  if (next() == '}') {
    ++p_;
  } else {
    while (true) {
      if (next() != '"') bad("bad-json", "a member needs a name in double quotes");
      const std::string key = read_string();
      expect(':', "a colon is missing after a member's name");
      read_member(key);
      const char c = next();
      ++p_;
      if (c == '}') break;
      if (c != ',') bad("bad-json", "a comma or a closing brace is missing");
    }
  }
  skip_all_spaces();
  if (p_ != end_) bad("bad-json", "there is text after the closing brace");
  if (!type_) bad("not-terrane-json", "the member \"type\":\"TIN\" is missing");
  if (!vertices_ || !triangles_) bad("not-terrane-json", "a TIN needs the members vertices and triangles");
  check_indices();
  return {std::move(tin_), crs_};
}

void JsonReader::read_member(const std::string& key) {
  if (key == "type") {
    once(type_, "type");
    if (next() != '"' || read_string() != "TIN") bad("not-terrane-json", "only objects of type TIN are surfaces");
  } else if (key == "crs") {
    once(crs_seen_, "crs");
    read_crs();
  } else if (key == "vertices") {
    once(vertices_, "vertices");
    read_vertices();
  } else if (key == "triangles") {
    once(triangles_, "triangles");
    read_triangles();
  } else {
    skip_value(1);
  }
}

template <class Element>
void JsonReader::read_array(Element&& element) {
  expect('[', "an array is expected");
  if (next() == ']') {
    ++p_;
    return;
  }
  while (true) {
    element();
    const char c = next();
    ++p_;
    if (c == ']') return;
    if (c != ',') bad("bad-json", "a comma or a closing bracket is missing");
  }
}

/// As many rows as are plain: those of a fresh block in pieces, which count as long as each is read to its end; then
/// from where that stopped, so that no row is read more than twice.
template <class Row>
void JsonReader::read_rows(std::vector<Row>& list, std::vector<JsonRows<Row>>& pieces, std::size_t most) {
  if (!more()) return;
  if (std::exchange(fresh_, false)) {
    context_.progress("read", source_.fraction());
    std::vector<const char*> cuts = {p_};
    for (std::size_t left = pieces.size(); left > 0; --left)
      cuts.push_back(left == 1 ? end_ : end_of_row(cuts.back() + (end_ - cuts.back()) / left, end_));
    parallel_tasks(context_, pieces.size(), [&](std::size_t i) { pieces[i].read(cuts[i], cuts[i + 1], most); });
    for (std::size_t i = 0; i < pieces.size() && p_ == cuts[i]; ++i)
      if (pieces[i].rows.size() <= most - list.size()) append(list, pieces[i]);
  }
  pieces.front().read(p_, end_, most - list.size());
  append(list, pieces.front());
}

template <class Row>
void JsonReader::append(std::vector<Row>& list, const JsonRows<Row>& rows) {
  const std::size_t to_come = source_.left() + static_cast<std::size_t>(end_ - rows.stop);
  make_room(list, rows.rows.size(), static_cast<std::size_t>(rows.stop - p_), to_come);
  list.insert(list.end(), rows.rows.begin(), rows.rows.end());
  p_ = rows.stop;
}

void JsonReader::read_vertices() {
  read_array([&] {
    read_rows(tin_.vertices, vertex_rows_, options_.max_vertices);
    const std::size_t count = tin_.vertices.size();
    check_count(options_, count + 1, options_.max_vertices, "vertices");
    double xyz[3];
    for (int k = 0; k < 3; ++k) {
      const char c = next();
      const char* after = nullptr;
      if (c == "[,,"[k]) {
        ++p_;
        next();
        after = parse_number(p_, end_, xyz[k]);
      }
      if (!after) {
        element_ = "vertex " + std::to_string(count);
        bad("bad-number", "a vertex is an array of three finite numbers");
      }
      p_ = after;
    }
    if (next() != ']') {
      element_ = "vertex " + std::to_string(count);
      bad("bad-number", "a vertex is an array of three finite numbers");
    }
    ++p_;
    tin_.vertices.push_back({xyz[0], xyz[1], xyz[2]});
  });
}

void JsonReader::read_triangles() {
  read_array([&] {
    read_rows(tin_.faces, face_rows_, std::numeric_limits<std::size_t>::max());
    const std::size_t count = tin_.faces.size();
    Face face;
    for (int k = 0; k < 4; ++k) {
      bool good = next() == "[,,]"[k];
      if (good) ++p_;
      if (good && k < 3) {
        next();
        const auto [after, error] = std::from_chars(p_, end_, face[k]);
        good = error == std::errc() && (after == end_ || is_space(*after) || *after == ',' || *after == ']');
        if (error == std::errc::result_out_of_range || (good && face[k] < 0)) {
          element_ = "triangle " + std::to_string(count);
          bad("index-out-of-range", "a vertex index is negative or far too large; they count from 0");
        }
        p_ = after;
      }
      if (!good) {
        element_ = "triangle " + std::to_string(count);
        bad("bad-face", "a triangle is an array of three vertex indices");
      }
    }
    tin_.faces.push_back(face);
  });
}

void JsonReader::read_crs() {
  const char c = next();
  if (c == '"') {
    const std::string text = read_string();
    if (!text.empty()) crs_ = declared_crs(text, options_, context_);
  } else if (c == '{') {  // PROJJSON
    std::string text;
    kept_ = &text;
    kept_from_ = p_;
    skip_value(1);
    kept_ = nullptr;
    crs_ = declared_crs(text.append(kept_from_, p_), options_, context_);
  } else {
    skip_word("null");
  }
}

std::string JsonReader::read_string() {
  expect('"', "a string is expected");
  std::string out;
  while (true) {
    if (!more()) bad("truncated", "the text ends inside a string; send the file again");
    const char c = *p_++;
    if (c == '"') return out;
    if (static_cast<unsigned char>(c) < ' ') bad("bad-json", "a control character inside a string");
    if (c == '\\')
      append_escape(out);
    else
      out += c;
  }
}

unsigned JsonReader::read_hex4() {
  unsigned code = 0;
  const std::size_t there = static_cast<std::size_t>(end_ - p_);
  if (there + source_.left() < 4) bad("truncated", "the text ends inside a string; send the file again");
  const auto [after, error] = std::from_chars(p_, p_ + std::min<std::size_t>(there, 4), code, 16);
  if (error != std::errc() || after != p_ + 4) bad("bad-json", "\\u needs four hexadecimal digits");
  p_ += 4;
  return code;
}

void JsonReader::append_escape(std::string& out) {
  if (p_ == end_) bad("truncated", "the text ends inside a string; send the file again");
  const char c = *p_++;
  static constexpr std::string_view names = "\"\\/bfnrt", values = "\"\\/\b\f\n\r\t";
  if (const std::size_t k = names.find(c); k != std::string_view::npos) {
    out += values[k];
    return;
  }
  if (c != 'u') bad("bad-json", "an unknown escape in a string");
  unsigned code = read_hex4();
  if (code >= 0xd800 && code < 0xdc00) {
    if (end_ - p_ < 2 || p_[0] != '\\' || p_[1] != 'u') bad("bad-json", "half of a surrogate pair in a string");
    p_ += 2;
    const unsigned low = read_hex4();
    if (low < 0xdc00 || low > 0xdfff) bad("bad-json", "half of a surrogate pair in a string");
    code = 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00);
  } else if (code >= 0xdc00 && code < 0xe000) {
    bad("bad-json", "half of a surrogate pair in a string");
  }
  const auto put = [&](unsigned byte) { out += static_cast<char>(byte); };
  if (code < 0x80) {
    put(code);
  } else if (code < 0x800) {
    put(0xc0 | code >> 6);
    put(0x80 | (code & 0x3f));
  } else if (code < 0x10000) {
    put(0xe0 | code >> 12);
    put(0x80 | (code >> 6 & 0x3f));
    put(0x80 | (code & 0x3f));
  } else {
    put(0xf0 | code >> 18);
    put(0x80 | (code >> 12 & 0x3f));
    put(0x80 | (code >> 6 & 0x3f));
    put(0x80 | (code & 0x3f));
  }
}

void JsonReader::skip_word(std::string_view word) {
  if (!std::string_view(p_, static_cast<std::size_t>(end_ - p_)).starts_with(word)) bad("bad-json", "no JSON value");
  p_ += word.size();
}

void JsonReader::skip_value(int depth) {
  if (depth > max_depth) bad("bad-json", "nested deeper than " + std::to_string(max_depth) + " levels");
  const char c = next();
  double number;
  if (c == '"') {
    read_string();
  } else if (c == '[') {
    read_array([&] { skip_value(depth + 1); });
  } else if (c == '{') {
    ++p_;
    if (next() == '}') {
      ++p_;
      return;
    }
    while (true) {
      if (next() != '"') bad("bad-json", "a member needs a name in double quotes");
      read_string();
      expect(':', "a colon is missing after a member's name");
      skip_value(depth + 1);
      const char d = next();
      ++p_;
      if (d == '}') return;
      if (d != ',') bad("bad-json", "a comma or a closing brace is missing");
    }
  } else if (c == 't') {
    skip_word("true");
  } else if (c == 'f') {
    skip_word("false");
  } else if (c == 'n') {
    skip_word("null");
  } else {
    const char* after = parse_number(p_, end_, number);
    if (!after) bad("bad-json", "no JSON value");
    p_ = after;
  }
}

void JsonReader::check_indices() const {
  const auto count = static_cast<Index>(tin_.vertices.size());
  for (std::size_t f = 0; f < tin_.faces.size(); ++f)
    for (Index v : tin_.faces[f])
      if (v >= count)
        bad_input(
            options_, "index-out-of-range", "triangle " + std::to_string(f),
            "vertex " + std::to_string(v) + " does not exist; there are " + std::to_string(count) + ", counted from 0");
}

}  // namespace

Dataset read_terrane_json(Source source, const ReadOptions& options, Context& context) {
  return JsonReader(std::move(source), options, context).read();
}

}  // namespace terrane
