// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "fuzz/plan_check.hpp"
#include "ops/base64.hpp"

// libFuzzer on base64: any bytes come back from their text, and text that is read is that of its bytes.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace terrane;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  fuzz::require(decode_base64(encode_base64(bytes), "bytes") == bytes, "the same bytes after a round trip");
  try {
    const std::string read = decode_base64(bytes, "text"), again = encode_base64(read);
    fuzz::require(decode_base64(again, "text") == read, "the same text after a round trip");
    const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
    const std::size_t blanks = std::count_if(bytes.begin(), bytes.end(), blank);
    fuzz::require(again.size() + blanks == size, "text as long as its bytes make it");
  } catch (const Error& error) {
    fuzz::require(error.kind == ErrorKind::usage, error.what());
  }
  return 0;
}
