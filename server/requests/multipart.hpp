// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

// multipart/form-data (RFC 7578) as it arrives, in pieces of any size.
namespace terrane {

struct FormPart {
  std::string name;
  bool has_file_name = false;
  std::string file_name;   // without folders, "" when a browser sent none
  std::string media_type;  // as declared, or empty
  std::string content;
};

/// Throws Error{usage} "bad-multipart" naming the part, and Error{limit} when there are too many parts, or one is
/// larger than its limit. Holds the parts and at most one piece more.
class MultipartParser {
 public:
  static constexpr std::size_t max_parts = 4096;
  static constexpr std::size_t max_part_header = 8192;

  /// `limit` says how many bytes a part may hold, asked once its header is read.
  MultipartParser(std::string_view boundary, std::function<std::size_t(const FormPart&)> limit);

  void feed(std::string_view piece);
  /// All parts in the order sent. Call it once, after the last piece; throws when the closing boundary is missing.
  std::vector<FormPart> finish();

 private:
  enum class State { preamble, after_boundary, header, content, epilogue };
  bool step();
  void begin_part(std::string_view header);
  void append(std::string_view text);

  std::string delimiter_;  // CRLF -- boundary
  std::function<std::size_t(const FormPart&)> limit_;
  State state_ = State::preamble;
  std::string pending_;
  std::size_t part_limit_ = 0;
  std::vector<FormPart> parts_;
};

/// The boundary parameter of a multipart/form-data content type. Throws Error{usage} when there is none.
std::string multipart_boundary(std::string_view content_type);

}  // namespace terrane
