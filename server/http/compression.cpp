// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/compression.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "server/http/conditional.hpp"
#include "server/http/header_fields.hpp"

namespace terrane {

namespace {

constexpr std::size_t least = 1024;  // below, the headers are most of the answer
constexpr std::size_t block = 128 * 1024;
// Fast ones: the network is rarely so slow that better ones would pay for their time.
constexpr int gzip_level = 4, zstd_level = 3;

using Write = std::function<bool(std::string_view)>;

/// Takes bytes, writes packed ones. `add` and `finish` are false when nobody listens any more.
class Packer {
 public:
  virtual ~Packer() = default;
  virtual bool add(std::string_view bytes, const Write& write) = 0;
  virtual bool finish(const Write& write) = 0;
};

class Gzip : public Packer {
 public:
  Gzip() : out_(block, '\0') {
    // 15 bits of window; 16 more mean the header and trailer of gzip.
    if (deflateInit2(&state_, gzip_level, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
  }
  ~Gzip() override { deflateEnd(&state_); }
  Gzip(const Gzip&) = delete;
  Gzip& operator=(const Gzip&) = delete;
  bool add(std::string_view bytes, const Write& write) override { return run(bytes, Z_NO_FLUSH, write); }
  bool finish(const Write& write) override { return run({}, Z_FINISH, write); }

 private:
  bool run(std::string_view bytes, int flush, const Write& write) {
    state_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    state_.avail_in = static_cast<uInt>(bytes.size());  // a block at most
    do {
      state_.next_out = reinterpret_cast<Bytef*>(out_.data());
      state_.avail_out = static_cast<uInt>(out_.size());
      deflate(&state_, flush);
      const std::size_t count = out_.size() - state_.avail_out;
      if (count > 0 && !write({out_.data(), count})) return false;
    } while (state_.avail_out == 0);
    return true;
  }

  z_stream state_{};
  std::string out_;
};

class Zstd : public Packer {
 public:
  Zstd() : state_(ZSTD_createCCtx()), out_(block, '\0') {
    if (!state_) throw std::bad_alloc();
    ZSTD_CCtx_setParameter(state_, ZSTD_c_compressionLevel, zstd_level);
    ZSTD_CCtx_setParameter(state_, ZSTD_c_checksumFlag, 1);
  }
  ~Zstd() override { ZSTD_freeCCtx(state_); }
  Zstd(const Zstd&) = delete;
  Zstd& operator=(const Zstd&) = delete;
  bool add(std::string_view bytes, const Write& write) override { return run(bytes, ZSTD_e_continue, write); }
  bool finish(const Write& write) override { return run({}, ZSTD_e_end, write); }

 private:
  bool run(std::string_view bytes, ZSTD_EndDirective how, const Write& write) {
    ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
    for (;;) {
      ZSTD_outBuffer out{out_.data(), out_.size(), 0};
      const std::size_t left = ZSTD_compressStream2(state_, &out, &in, how);
      if (ZSTD_isError(left)) throw std::runtime_error(ZSTD_getErrorName(left));
      if (out.pos > 0 && !write({out_.data(), out.pos})) return false;
      if (how == ZSTD_e_end ? left == 0 : in.pos == in.size) return true;
    }
  }

  ZSTD_CCtx* state_;
  std::string out_;
};

std::unique_ptr<Packer> packer(std::string_view coding) {
  if (coding == "zstd") return std::make_unique<Zstd>();
  return std::make_unique<Gzip>();
}

void pack(std::string_view text, std::string_view coding, const Write& write) {
  const auto to = packer(coding);
  for (; !text.empty(); text.remove_prefix(std::min(text.size(), block))) {
    if (!to->add(text.substr(0, block), write)) return;
  }
  to->finish(write);
}

void pack(const FileBody& part, std::string_view coding, const Write& write) {
  const auto to = packer(coding);
  std::string bytes(block, '\0');
  for (std::uint64_t at = 0; at < part.size;) {
    const std::size_t count =
        part.file->read(part.offset + at, bytes.data(), std::min<std::uint64_t>(block, part.size - at));
    if (count == 0) throw std::runtime_error("a file became shorter while it was sent");
    if (!to->add({bytes.data(), count}, write)) return;
    at += count;
  }
  to->finish(write);
}

/// Types that are not packed inside; what is unknown stays as it is.
bool is_packable(std::string_view media_type) {
  const std::string type = small_letters(trimmed_field(media_type.substr(0, media_type.find(';'))));
  constexpr std::array others = {"application/json",     "application/xml",  "application/javascript",
                                 "application/yaml",     "application/wasm", "application/x-esri-ascii-grid",
                                 "application/x-ndjson", "image/svg+xml",    "image/vnd.dxf"};
  if (type == "text/event-stream") return false;  // its pieces must not wait for a block to fill
  return type.starts_with("text/") || type.starts_with("model/") || type.ends_with("+json") || type.ends_with("+xml") ||
         std::find(others.begin(), others.end(), type) != others.end();
}

}  // namespace

std::string wanted_coding(std::string_view accept_encoding) {
  const auto list = weighted_list(accept_encoding);
  const auto weight = [&](std::string_view coding) {
    for (const Weighted& element : list) {
      if (element.value == coding || (element.value == "x-gzip" && coding == "gzip")) return element.weight;
    }
    for (const Weighted& element : list)
      if (element.value == "*") return element.weight;
    return 0.0;
  };
  const double zstd = weight("zstd"), gzip = weight("gzip"), plain = weight("identity");
  // Unsaid, the bytes as they are come last. Where they are refused and nothing else is taken they are sent all the
  // same: an answer nobody expects explains more than none.
  if (zstd > 0 && zstd >= gzip && zstd >= plain) return "zstd";
  if (gzip > 0 && gzip >= plain) return "gzip";
  return "";
}

bool is_compressible(const Reply& reply) {
  const auto size = reply.size();
  if (!size || *size < least || reply.status == 206 || reply_header(reply, "Content-Encoding")) return false;
  if (reply_header(reply, "Cache-Control").value_or("").find("no-transform") != std::string::npos) return false;
  return is_packable(reply.media_type);
}

void announce_coding(Reply& reply, const std::string& coding) {
  set_reply_header(reply, "Content-Encoding", coding);
  if (const auto etag = reply_header(reply, "ETag")) set_reply_header(reply, "ETag", coded_etag(*etag, coding));
}

void compress(Reply& reply, const std::string& coding, std::size_t whole) {
  if (const auto* file = std::get_if<FileBody>(&reply.body)) {
    reply.body = StreamBody([part = *file, coding](const Write& write) { pack(part, coding, write); });
    return;
  }
  auto* text = std::get_if<std::string>(&reply.body);
  if (!text) return;
  if (text->size() > whole) {
    // Shared, since a std::function copies what it holds.
    const auto kept = std::make_shared<const std::string>(std::move(*text));
    reply.body = StreamBody([kept, coding](const Write& write) { pack(*kept, coding, write); });
    return;
  }
  std::string packed;
  pack(*text, coding, [&](std::string_view piece) {
    packed += piece;
    return true;
  });
  *text = std::move(packed);
}

}  // namespace terrane
