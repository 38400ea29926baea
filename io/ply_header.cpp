// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/ply_header.hpp"

#include "io/bad_input.hpp"
#include "io/text.hpp"

namespace terrane {

namespace {

constexpr std::size_t max_elements = 64, max_properties = 256;

class HeaderReader {
 public:
  HeaderReader(Source& source, const ReadOptions& options) : source_(source), options_(options) {}

  PlyHeader read() {
    if (next_line() != "ply") bad_input(options_, "wrong-magic", "line 1", "a PLY file begins with the line ply");
    bool format = false;
    while (true) {
      const std::string_view line = next_line();
      if (line == "end_header") break;
      rest_ = line;
      const std::string_view word = next_word();
      if (word == "format")
        format = read_format(format);
      else if (word == "comment")
        read_comment();
      else if (word == "element")
        read_element();
      else if (word == "property")
        read_property();
      else if (word != "obj_info" && !word.empty())
        bad("no statement of a PLY header");
    }
    if (!format) bad("the format line is missing");
    check_counts();
    return std::move(header_);
  }

 private:
  [[noreturn]] void bad(const std::string& what) const {
    bad_input(options_, "bad-header", "line " + std::to_string(line_), what);
  }

  std::string_view next_line() {
    ++line_;
    // The header is short: should a line of it be long, then look for its end in ever more.
    std::string_view bytes = source_.peek(4096);
    std::size_t newline = bytes.find('\n');
    while (newline == std::string_view::npos && bytes.size() < source_.left()) {
      const std::size_t before = bytes.size();
      bytes = source_.peek(2 * before);
      if (bytes.size() == before) break;
      newline = bytes.find('\n', before);
    }
    if (newline == std::string_view::npos)
      bad_input(options_, line_ == 1 ? "wrong-magic" : "truncated", "line " + std::to_string(line_),
                line_ == 1 ? "no PLY header" : "the PLY header has no end; send the file again");
    std::string_view line = bytes.substr(0, newline);
    source_.take(newline + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    while (line.ends_with(' ')) line.remove_suffix(1);
    return line;
  }

  std::string_view next_word() {
    rest_ = trimmed(rest_);
    const std::string_view word = rest_.substr(0, rest_.find_first_of(" \t"));
    rest_.remove_prefix(word.size());
    return word;
  }

  bool read_format(bool seen) {
    if (seen) bad("a second format line");
    const std::string_view word = next_word();
    if (word == "ascii")
      header_.encoding = PlyHeader::ascii;
    else if (word == "binary_little_endian")
      header_.encoding = PlyHeader::little;
    else if (word == "binary_big_endian")
      header_.encoding = PlyHeader::big;
    else
      bad("the format is neither ascii nor binary_little_endian nor binary_big_endian");
    if (next_word() != "1.0") bad("only PLY 1.0 is known");
    return true;
  }

  void read_comment() {
    const std::string_view text = trimmed(rest_);
    if (header_.crs.empty() && text.starts_with("crs:")) header_.crs = trimmed(text.substr(4));
  }

  void read_element() {
    if (header_.elements.size() == max_elements) bad("more than " + std::to_string(max_elements) + " elements");
    PlyElement element;
    element.name = next_word();
    const std::string_view count = next_word();
    const auto [p, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (error != std::errc() || p != count.data() + count.size()) bad("an element needs a name and a count");
    header_.elements.push_back(std::move(element));
  }

  PlyScalar scalar(std::string_view word) const {
    static constexpr std::pair<std::string_view, PlyScalar> words[] = {
        {"char", PlyScalar::i8},    {"int8", PlyScalar::i8},     {"uchar", PlyScalar::u8},
        {"uint8", PlyScalar::u8},   {"short", PlyScalar::i16},   {"int16", PlyScalar::i16},
        {"ushort", PlyScalar::u16}, {"uint16", PlyScalar::u16},  {"int", PlyScalar::i32},
        {"int32", PlyScalar::i32},  {"uint", PlyScalar::u32},    {"uint32", PlyScalar::u32},
        {"float", PlyScalar::f32},  {"float32", PlyScalar::f32}, {"double", PlyScalar::f64},
        {"float64", PlyScalar::f64}};
    for (const auto& [name, type] : words)
      if (name == word) return type;
    bad("an unknown type of property");
  }

  void read_property() {
    if (header_.elements.empty()) bad("a property before the first element");
    PlyProperty property;
    std::string_view word = next_word();
    if (word == "list") {
      property.list = true;
      property.count_type = scalar(next_word());
      if (property.count_type == PlyScalar::f32 || property.count_type == PlyScalar::f64)
        bad("the length of a list must be a whole number");
      word = next_word();
    }
    property.type = scalar(word);
    property.name = next_word();
    if (property.name.empty()) bad("a property needs a name");
    auto& properties = header_.elements.back().properties;
    if (properties.size() == max_properties) bad("more than " + std::to_string(max_properties) + " properties");
    properties.push_back(std::move(property));
  }

  void check_counts() const {
    // The last row of an ASCII file may lack its newline, so one byte more than there is may be asked for.
    std::size_t left = source_.left() + 1;
    for (const PlyElement& element : header_.elements) {
      const std::size_t row = element.least_row(header_.encoding == PlyHeader::ascii);
      if (row == 0) continue;
      if (element.count > left / row)
        bad_input(options_, "truncated", "",
                  "the header announces " + std::to_string(element.count) + " rows of one element, more than the " +
                      std::to_string(source_.left()) + " bytes after it can hold; send the file again");
      left -= element.count * row;
    }
  }

  Source& source_;
  std::string_view rest_;
  const ReadOptions& options_;
  PlyHeader header_;
  std::size_t line_ = 0;
};

}  // namespace

std::size_t ply_size(PlyScalar type) {
  switch (type) {
    case PlyScalar::i8:
    case PlyScalar::u8: return 1;
    case PlyScalar::i16:
    case PlyScalar::u16: return 2;
    case PlyScalar::i32:
    case PlyScalar::u32:
    case PlyScalar::f32: return 4;
    case PlyScalar::f64: return 8;
  }
  return 8;
}

std::size_t PlyElement::least_row(bool ascii) const {
  std::size_t bytes = 0;
  for (const PlyProperty& property : properties)
    bytes += ascii ? 2 : ply_size(property.list ? property.count_type : property.type);
  return bytes;
}

PlyHeader read_ply_header(Source& source, const ReadOptions& options) {
  return HeaderReader(source, options).read();
}

}  // namespace terrane
