// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "server/http/message.hpp"

// Calls and answers for tests.
namespace terrane {

inline Call get(const std::string& path, TextPairs headers = {}) {
  Call call;
  call.method = "GET";
  call.version = "HTTP/1.1";
  call.path = path;
  call.headers = std::move(headers);
  return call;
}

inline Reply text_reply(const std::string& text, const std::string& media_type = "text/plain") {
  return {200, media_type, {}, text};
}

/// The bytes as a part of a file that is gone from its folder already; 3 others stand before and behind them.
inline Reply file_reply(const std::string& bytes, const std::string& media_type = "text/plain") {
  char path[] = "/tmp/terrane-test-XXXXXX";
  const int file = mkstemp(path);
  close(file);
  std::ofstream(path, std::ios::binary) << "<<<" << bytes << ">>>";
  Reply reply{200, media_type, {}, FileBody{std::make_shared<const OpenFile>(path), 3, bytes.size()}};
  unlink(path);
  return reply;
}

/// What a client would receive.
inline std::string bytes_of(const Reply& reply) {
  if (const auto* text = std::get_if<std::string>(&reply.body)) return *text;
  std::string bytes;
  if (const auto* part = std::get_if<FileBody>(&reply.body)) {
    bytes.resize(part->size);
    bytes.resize(part->file->read(part->offset, bytes.data(), bytes.size()));
    return bytes;
  }
  std::get<StreamBody>(reply.body)([&](std::string_view piece) {
    bytes += piece;
    return true;
  });
  return bytes;
}

}  // namespace terrane
