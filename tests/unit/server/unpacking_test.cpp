// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/unpacking.hpp"

#include <gtest/gtest.h>
#include <zlib.h>
#include <zstd.h>

#include <optional>

#include "server/http/compression.hpp"
#include "server/http/message.hpp"

namespace terrane {
namespace {

std::string packed(const std::string& text, const std::string& coding) {
  if (coding == "deflate") {
    std::string out(compressBound(text.size()), '\0');
    uLongf size = out.size();
    ::compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(text.data()), text.size());
    return out.substr(0, size);
  }
  Reply reply;
  reply.body = text;
  compress(reply, coding, text.size());
  return std::get<std::string>(reply.body);
}

/// Nothing when the body is broken.
std::optional<std::string> unpacked(const std::string& coding, std::string_view body, std::size_t piece) {
  const auto unpack = unpacker(coding);
  std::string out;
  for (; !body.empty(); body.remove_prefix(std::min(piece, body.size())))
    if (!unpack->add(body.substr(0, piece), [&](std::string_view text) { out += text; })) return std::nullopt;
  return unpack->is_complete() ? std::optional(out) : std::nullopt;
}

std::string long_text() {
  std::string text;
  for (long i = 0; i < 60000; ++i) text += std::to_string(i * i % 1009) + " ";
  return text + std::string(1 << 20, ' ');
}

TEST(Unpacking, WhatWasPackedComesOutInPiecesOfAnySize) {
  const std::string text = long_text();
  for (const std::string coding : {"gzip", "deflate", "zstd"}) {
    const std::string body = packed(text, coding);
    for (const std::size_t piece : {std::size_t{1}, std::size_t{4096}, body.size()})
      EXPECT_EQ(unpacked(coding, body, piece), text) << coding << " " << piece;
    EXPECT_EQ(unpacked(coding, body + body, 4096), text + text) << coding;
    EXPECT_EQ(unpacked(coding, "", 1), "") << coding;
  }
}

TEST(Unpacking, ZstdIsThatOfTheStandardNotOfItsOldVersions) {
  const std::string old("\x25\xb5\x2f\xfd\x04\xfd\x04\x58", 8), frame = packed(long_text(), "zstd");
  for (const std::size_t piece : {1, 3, 8}) {
    EXPECT_FALSE(unpacked("zstd", old, piece));
    EXPECT_FALSE(unpacked("zstd", frame + old, piece));
  }
}

TEST(Unpacking, WhatIsCutOffOrDamagedIsBroken) {
  const std::string text = long_text();
  for (const std::string coding : {"gzip", "deflate", "zstd"}) {
    const std::string body = packed(text, coding);
    for (const std::size_t size : {std::size_t{1}, std::size_t{10}, body.size() / 2, body.size() - 9, body.size() - 1})
      EXPECT_FALSE(unpacked(coding, body.substr(0, size), 4096)) << coding << " " << size;
    EXPECT_FALSE(unpacked(coding, body + "more", 4096)) << coding;
    EXPECT_FALSE(unpacked(coding, "no such thing", 4096)) << coding;
    std::string damaged = body;
    damaged[body.size() / 2] = static_cast<char>(~damaged[body.size() / 2]);
    EXPECT_FALSE(unpacked(coding, damaged, 4096)) << coding;
  }
}

TEST(Unpacking, AZstdFrameIsAsLongAsItSays) {
  const std::string frame("\x28\xb5\x2f\xfd\x41\x01\0\0\0\x01\0\0", 12);  // 256 bytes, and an empty block
  for (const std::size_t piece : {1u, 7u, 12u}) EXPECT_FALSE(unpacked("zstd", frame, piece));
}

TEST(Unpacking, AZstdWindowIsBounded) {
  ZSTD_CCtx* const state = ZSTD_createCCtx();
  ZSTD_CCtx_setParameter(state, ZSTD_c_windowLog, 27);
  ZSTD_CCtx_setParameter(state, ZSTD_c_contentSizeFlag, 0);
  const std::string text(16 << 20, ' ');
  std::string out(ZSTD_compressBound(text.size()), '\0');
  ZSTD_inBuffer in{text.data(), text.size(), 0};
  ZSTD_outBuffer to{out.data(), out.size(), 0};
  while (ZSTD_compressStream2(state, &to, &in, ZSTD_e_continue), in.pos < in.size) continue;
  while (ZSTD_compressStream2(state, &to, &in, ZSTD_e_end) > 0) continue;
  ZSTD_freeCCtx(state);
  EXPECT_FALSE(unpacked("zstd", out.substr(0, to.pos), 4096));
}

TEST(Unpacking, NamesOfCodings) {
  EXPECT_FALSE(unpacker(""));
  EXPECT_FALSE(unpacker("Identity"));
  for (const char* known : {"GZIP", "x-gzip", " deflate", "Zstd"}) EXPECT_TRUE(unpacker(known)) << known;
  for (const char* unknown : {"br", "gzip, gzip", "compress"}) EXPECT_THROW(unpacker(unknown), HttpError) << unknown;
}

}  // namespace
}  // namespace terrane
