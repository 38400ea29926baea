// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

// Bodies of requests in gzip, deflate and zstd: RFC 9110, section 8.4.
namespace terrane {

/// Takes packed bytes in pieces of any size, hands on what comes out in blocks.
class Unpacker {
 public:
  using Sink = std::function<void(std::string_view)>;
  virtual ~Unpacker() = default;
  /// False when the bytes are not of this coding.
  virtual bool add(std::string_view bytes, const Sink& sink) = 0;
  /// Whether the body may end here. One that is cut off gives bytes as any other does, only not all of them.
  bool is_complete() const { return is_between_; }

 protected:
  bool is_between_ = true;  // between two streams: several may follow each other, as `cat a.gz b.gz` makes them
};

/// For a Content-Encoding; nothing when the body is not packed. Throws HttpError 415 when the coding is another.
std::unique_ptr<Unpacker> unpacker(std::string_view content_encoding);

}  // namespace terrane
