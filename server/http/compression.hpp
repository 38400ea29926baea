// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "server/http/message.hpp"

// Answers in gzip and zstd for those who take them: RFC 9110, section 12.5.3.
namespace terrane {

/// "zstd", "gzip" or, for the bytes as they are, "": what Accept-Encoding wants most of what we have.
std::string wanted_coding(std::string_view accept_encoding);

/// True of text and files that get smaller: large enough, of a type that is not packed already, in no coding yet.
bool is_compressible(const Reply& reply);

/// The headers of an answer in a coding: Content-Encoding, and an ETag of its own. The body follows with `compress`, so
/// that conditions can be asked about the answer before anything is packed.
void announce_coding(Reply& reply, const std::string& coding);

/// Packs the body in the coding. Files, and texts beyond `whole`, are packed in blocks while they are sent.
void compress(Reply& reply, const std::string& coding, std::size_t whole = std::size_t{1} << 20);

}  // namespace terrane
