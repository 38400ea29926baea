// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "io/ply_header.hpp"
#include "io/source.hpp"
#include "io/text.hpp"

namespace terrane {

/// The values of a PLY file's body one after another, whatever the encoding.
class PlyBody {
 public:
  PlyBody(Source source, PlyHeader::Encoding encoding) : source_(std::move(source)), encoding_(encoding) {}

  std::size_t left() const {
    return encoding_ == PlyHeader::ascii ? source_.left() + static_cast<std::size_t>(end_ - p_)
                                         : source_.left() - static_cast<std::size_t>(p_ - begin_);
  }
  double fraction() const { return source_.fraction(); }
  PlyHeader::Encoding encoding() const { return encoding_; }

  /// False at the end of the bytes or where there is no finite number.
  bool read(PlyScalar type, double& value) {
    if (encoding_ == PlyHeader::ascii) return read_text(value);
    if (!has(ply_size(type))) return false;
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

  /// What comes next of a binary body: `least` bytes or more, fewer only at the end.
  std::string_view peek(std::size_t least) {
    has(least);
    return {p_, static_cast<std::size_t>(end_ - p_)};
  }

  /// Takes the next bytes of a binary body as they are; how many there were.
  std::size_t copy(char* to, std::size_t bytes) {
    source_.take(static_cast<std::size_t>(p_ - begin_));
    begin_ = p_ = end_ = nullptr;
    return source_.read(to, bytes);
  }

  bool skip(std::size_t bytes) {
    if (left() < bytes) return false;
    while (bytes != 0) {
      if (!has(1)) return false;
      const std::size_t step = std::min(bytes, static_cast<std::size_t>(end_ - p_));
      p_ += step;
      bytes -= step;
    }
    return true;
  }

  bool skip_word() {
    if (!has_word()) return false;
    while (p_ != end_ && !is_space(*p_)) ++p_;
    return true;
  }

 private:
  bool has(std::size_t bytes) {
    if (static_cast<std::size_t>(end_ - p_) >= bytes) return true;
    source_.take(static_cast<std::size_t>(p_ - begin_));
    const std::string_view view = source_.peek(bytes);
    begin_ = p_ = view.data();
    end_ = p_ + view.size();
    return view.size() >= bytes;
  }

  /// Text is taken by blocks that tear no word.
  bool has_word() {
    while ((p_ = skip_spaces(p_, end_)) == end_) {
      const std::string_view block = source_.block(" \t\r\n\v\f");
      if (block.empty()) return false;
      p_ = block.data();
      end_ = p_ + block.size();
    }
    return true;
  }

  bool read_text(double& value) {
    const char* after = has_word() ? parse_number(p_, end_, value) : nullptr;
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

  Source source_;
  const char *begin_ = nullptr, *p_ = nullptr, *end_ = nullptr;  // seen of a binary body, or taken of a text
  PlyHeader::Encoding encoding_;
};

}  // namespace terrane
