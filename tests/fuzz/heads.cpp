// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdint>

#include "fuzz/require.hpp"
#include "server/http/http_limits.hpp"
#include "server/http/request_head.hpp"

// libFuzzer on request heads: found in pieces or whole they end at the same place, and what the library gets to see of
// one is the same request with the body that was received, however the original said it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace terrane;
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  try {
    const std::size_t end = head_size(input);
    if (end == 0) return 0;
    fuzz::require(end <= http_limits::header, "a head beyond its bound");
    fuzz::require(head_size(input.substr(0, end)) == end, "a head that needs what follows it");
    const RequestHead head = parse_head(input.substr(0, end));
    fuzz::require(head.headers.size() <= http_limits::header_lines, "more lines than there may be");
    const std::string shown = head_for_library(head, 5);
    fuzz::require(shown.find("\r\n\r\n") == shown.size() - 4, "a head with something behind it");
    const RequestHead again = parse_head(shown);
    fuzz::require(again.method == head.method && again.target == head.target, "another request");
    fuzz::require(again.framing != Framing::chunks && (again.framing == Framing::none || again.length == 5),
                  "another body");
  } catch (const HttpError&) {
  }
  return 0;
}
