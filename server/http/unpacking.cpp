// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/unpacking.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <new>
#include <string>

#include "server/http/header_fields.hpp"
#include "server/http/message.hpp"

namespace terrane {

namespace {

constexpr std::size_t block = 128 * 1024;
constexpr int zstd_window = 23;  // 8 MB, what RFC 9659 grants a sender

class Inflater : public Unpacker {
 public:
  /// The bits of the window say what is around the bytes: 15 zlib's format, which HTTP calls deflate; 16 more gzip's.
  explicit Inflater(int window_bits) : out_(block, '\0') {
    if (inflateInit2(&state_, window_bits) != Z_OK) throw std::bad_alloc();
  }
  ~Inflater() override { inflateEnd(&state_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  bool add(std::string_view bytes, const Sink& sink) override {
    state_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    state_.avail_in = static_cast<uInt>(bytes.size());  // a piece that was received
    bool is_full = false;
    while (state_.avail_in > 0 || is_full) {
      if (is_between_) inflateReset(&state_);
      state_.next_out = reinterpret_cast<Bytef*>(out_.data());
      state_.avail_out = static_cast<uInt>(out_.size());
      const int result = inflate(&state_, Z_NO_FLUSH);
      if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR) return false;
      sink({out_.data(), out_.size() - state_.avail_out});
      is_between_ = result == Z_STREAM_END;
      is_full = state_.avail_out == 0 && !is_between_;
    }
    return true;
  }

 private:
  z_stream state_{};
  std::string out_;
};

class ZstdUnpacker : public Unpacker {
 public:
  ZstdUnpacker() : state_(ZSTD_createDCtx()), out_(block, '\0') {
    if (!state_) throw std::bad_alloc();
    ZSTD_DCtx_setParameter(state_, ZSTD_d_windowLogMax, zstd_window);
  }
  ~ZstdUnpacker() override { ZSTD_freeDCtx(state_); }
  ZstdUnpacker(const ZstdUnpacker&) = delete;
  ZstdUnpacker& operator=(const ZstdUnpacker&) = delete;

  bool add(std::string_view bytes, const Sink& sink) override {
    ZSTD_inBuffer in{bytes.data(), 0, 0};
    bool is_full = false;
    while (in.pos < bytes.size() || is_full) {
      if (is_between_ && !begins_frame(bytes[in.pos])) return false;
      if (is_between_) head_.clear(), made_ = 0;
      // The library treats a frame that it gets whole otherwise than one in pieces, and other broken ones pass: with
      // its first byte by itself every frame comes in pieces.
      in.size = is_between_ ? in.pos + 1 : bytes.size();
      ZSTD_outBuffer out{out_.data(), out_.size(), 0};
      const std::size_t before = in.pos, left = ZSTD_decompressStream(state_, &out, &in);
      if (ZSTD_isError(left)) return false;
      head_ += bytes.substr(before, std::min(in.pos - before, longest_head - head_.size()));
      made_ += out.pos;
      sink({out_.data(), out.pos});
      is_between_ = left == 0;
      if (is_between_ && !has_size_announced()) return false;
      is_full = out.pos == out.size && !is_between_;
    }
    return true;
  }

 private:
  /// A frame of RFC 8878. The library also reads what versions before 0.8 wrote, each of which begins with a byte of
  /// its own, and passes over frames without content, without saying where these end.
  static bool begins_frame(char first) { return first == 0x28; }

  /// The library does not look where a frame that came in pieces ends in an empty block.
  bool has_size_announced() const {
    const unsigned long long size = ZSTD_getFrameContentSize(head_.data(), head_.size());
    return size == ZSTD_CONTENTSIZE_UNKNOWN || size == made_;
  }

  static constexpr std::size_t longest_head = 18;  // RFC 8878, magic number included
  ZSTD_DCtx* state_;
  std::string out_, head_;       // head_: the first bytes of the frame
  unsigned long long made_ = 0;  // bytes that came of the frame
};

}  // namespace

std::unique_ptr<Unpacker> unpacker(std::string_view content_encoding) {
  const std::string coding = small_letters(trimmed_field(content_encoding));
  if (coding.empty() || coding == "identity") return nullptr;
  if (coding == "gzip" || coding == "x-gzip") return std::make_unique<Inflater>(15 + 16);
  if (coding == "deflate") return std::make_unique<Inflater>(15);
  if (coding == "zstd") return std::make_unique<ZstdUnpacker>();
  throw HttpError(415, "unknown-content-coding", "The body may be encoded as gzip, deflate or zstd, once.",
                  {{"Accept-Encoding", "gzip, deflate, zstd"}});
}

}  // namespace terrane
