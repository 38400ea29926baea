// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/incoming.hpp"

#include <algorithm>
#include <limits>

namespace terrane {

std::size_t Incoming::take(std::string_view bytes) {
  if (head.framing == Framing::none) return 0;
  const auto keep = [&](std::string_view piece) {
    if (body.size() + piece.size() > max_body_) {
      throw HttpError(413, "body-too-large",
                      "The body is larger than " + std::to_string(max_body_) + " bytes (--max-body).");
    }
    body.append(piece);
  };
  if (head.framing == Framing::length) {
    bytes = bytes.substr(0, static_cast<std::size_t>(std::min<std::uint64_t>(bytes.size(), missing())));
    keep(bytes);
    return bytes.size();
  }
  const auto taken = chunks_.take(bytes, keep);
  if (!taken) throw HttpError(400, "broken-body", "The chunks of the body are broken.");
  return *taken;
}

bool Incoming::is_complete() const { return head.framing == Framing::chunks ? chunks_.is_complete() : missing() == 0; }

std::uint64_t Incoming::missing() const {
  if (head.framing == Framing::chunks) return std::numeric_limits<std::uint64_t>::max();
  return head.framing == Framing::none ? 0 : head.length - body.size();
}

}  // namespace terrane
