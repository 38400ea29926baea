// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/compression.hpp"

#include <gtest/gtest.h>
#include <zlib.h>
#include <zstd.h>

#include "server/http/header_fields.hpp"
#include "unit/server/replies.hpp"

namespace terrane {
namespace {

std::string gunzip(const std::string& packed) {
  z_stream state{};
  inflateInit2(&state, 15 + 16);
  std::string out, piece(65536, '\0');
  state.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  state.avail_in = static_cast<uInt>(packed.size());
  int result = Z_OK;
  while (result == Z_OK) {
    state.next_out = reinterpret_cast<Bytef*>(piece.data());
    state.avail_out = static_cast<uInt>(piece.size());
    result = inflate(&state, Z_NO_FLUSH);
    out.append(piece, 0, piece.size() - state.avail_out);
  }
  inflateEnd(&state);
  return result == Z_STREAM_END && state.avail_in == 0 ? out : "broken";
}

std::string unzstd(const std::string& packed) {
  ZSTD_DCtx* state = ZSTD_createDCtx();
  std::string out, piece(65536, '\0');
  ZSTD_inBuffer in{packed.data(), packed.size(), 0};
  std::size_t left = 1;
  while (left != 0 && !ZSTD_isError(left)) {
    ZSTD_outBuffer to{piece.data(), piece.size(), 0};
    left = ZSTD_decompressStream(state, &to, &in);
    out.append(piece, 0, to.pos);
    if (to.pos == 0 && in.pos == in.size && left != 0) break;
  }
  ZSTD_freeDCtx(state);
  return left == 0 && in.pos == in.size ? out : "broken";
}

std::string unpack(const std::string& coding, const std::string& packed) {
  return coding == "gzip" ? gunzip(packed) : unzstd(packed);
}

/// Lines of vertices: what is sent most.
std::string lines(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += "v " + std::to_string(i * 7919L % 1000003) + " " + std::to_string(i) + " 1\n";
  return text;
}

TEST(Coding, IsTheOneWantedMost) {
  const std::vector<std::pair<const char*, const char*>> cases = {{"", ""},
                                                                  {"gzip", "gzip"},
                                                                  {"x-gzip", "gzip"},
                                                                  {"zstd", "zstd"},
                                                                  {"gzip, deflate, br, zstd", "zstd"},
                                                                  {"gzip;q=1, zstd;q=0.9", "gzip"},
                                                                  {"br", ""},
                                                                  {"*", "zstd"},
                                                                  {"*;q=0", ""},
                                                                  {"zstd;q=0, *", "gzip"},
                                                                  {"gzip;q=0", ""},
                                                                  {"gzip;q=0, *;q=0.1, zstd;q=0", ""},
                                                                  {"identity, gzip;q=0.5", ""},
                                                                  {"identity;q=0.5, gzip", "gzip"},
                                                                  {"GZIP;q=0.3", "gzip"},
                                                                  {"gzip;q=nonsense", ""}};
  for (const auto& [accept, coding] : cases) EXPECT_EQ(wanted_coding(accept), coding) << accept;
}

TEST(Coding, IsForTextThatIsLargeEnough) {
  const std::string text(1024, 'a');
  for (const char* type :
       {"text/plain", "application/json", "application/geo+json", "model/obj", "text/csv; header=yes",
        "application/problem+json", "application/vnd.oai.openapi+json;version=3.1"}) {
    EXPECT_TRUE(is_compressible(text_reply(text, type))) << type;
    EXPECT_TRUE(is_compressible(file_reply(text, type))) << type;
  }
  for (const char* type : {"image/png", "image/tiff", "application/zip", "application/geopackage+sqlite3", "",
                           "text/event-stream", "multipart/related"}) {
    EXPECT_FALSE(is_compressible(text_reply(text, type))) << type;
  }
  EXPECT_FALSE(is_compressible(text_reply(text.substr(1))));
  Reply reply = text_reply(text);
  reply.status = 206;
  EXPECT_FALSE(is_compressible(reply)) << "a part";
  reply = text_reply(text);
  reply.headers = {{"content-encoding", "br"}};
  EXPECT_FALSE(is_compressible(reply)) << "packed already";
  reply.headers = {{"Cache-Control", "no-transform"}};
  EXPECT_FALSE(is_compressible(reply));
  reply.headers.clear();
  reply.body = StreamBody([](const auto&) {});
  EXPECT_FALSE(is_compressible(reply));
}

TEST(Coding, HasAnEtagOfItsOwn) {
  Reply reply = text_reply("a");
  reply.headers = {{"ETag", "\"x\""}};
  announce_coding(reply, "zstd");
  EXPECT_EQ(reply_header(reply, "ETag"), "\"x-zstd\"");
  EXPECT_EQ(reply_header(reply, "Content-Encoding"), "zstd");
}

TEST(Packing, GivesBackTheSameBytes) {
  for (const char* coding : {"gzip", "zstd"}) {
    for (const std::string& text : {std::string(), std::string("a"), lines(100), lines(60'000)}) {
      for (Reply reply : {text_reply(text), file_reply(text)}) {
        compress(reply, coding, 100'000);
        const std::string packed = bytes_of(reply);
        EXPECT_EQ(unpack(coding, packed), text) << coding << " " << text.size();
        if (text.size() > 1000) {
          EXPECT_LT(packed.size(), text.size() / 2);
        }
      }
    }
  }
}

TEST(Packing, HappensWhileLargeBodiesAreSent) {
  Reply reply = text_reply(lines(60'000));
  compress(reply, "gzip", 100'000);
  EXPECT_TRUE(std::holds_alternative<StreamBody>(reply.body));
  std::size_t largest = 0, pieces = 0;
  std::get<StreamBody>(reply.body)([&](std::string_view piece) {
    largest = std::max(largest, piece.size());
    ++pieces;
    return true;
  });
  EXPECT_GT(pieces, 1u);
  EXPECT_LE(largest, 128u * 1024);
  reply = text_reply(lines(1000));
  compress(reply, "gzip", 100'000);
  EXPECT_TRUE(std::holds_alternative<std::string>(reply.body));
}

TEST(Packing, StopsWhenNobodyListens) {
  for (const char* coding : {"gzip", "zstd"}) {
    Reply reply = file_reply(lines(300'000));
    compress(reply, coding);
    int pieces = 0;
    std::get<StreamBody>(reply.body)([&](std::string_view) { return ++pieces < 2; });
    EXPECT_EQ(pieces, 2) << coding;
  }
}

TEST(Packing, AFileThatBecameShorterIsNoWholeAnswer) {
  Reply reply = file_reply("abc");
  std::get<FileBody>(reply.body).size = 1000;
  compress(reply, "gzip");
  EXPECT_THROW(bytes_of(reply), std::exception);
}

}  // namespace
}  // namespace terrane
