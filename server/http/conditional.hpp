// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "server/http/message.hpp"

// What a client has already, and what part of it it still wants: RFC 9110, sections 8.8, 13 and 14.
namespace terrane {

/// Gives a text that answers a GET with 200 a strong ETag, made of its bytes, where the route has set none; not where
/// Cache-Control says no-store. A file has one only when its hash is known: nobody reads it for that.
void add_etag(const Call& call, Reply& reply);

/// The ETag of the same content in another coding: "\"abc\"" and "gzip" give "\"abc-gzip\"".
std::string coded_etag(std::string_view etag, std::string_view coding);

/// True when the call asks for a part of this answer, and If-Range does not turn that into the whole.
bool asks_for_part(const Call& call, const Reply& reply);

/// Of an answer to a GET with 200: 304 without a body when If-None-Match has its ETag, 412 when If-Match has not, 206
/// with the part that Range names, 416 when there is no such part or several are wanted. Every other answer, and one
/// whose body is a stream, stays as it is; of content in a coding there are no parts.
Reply apply_conditions(const Call& call, Reply&& reply);

}  // namespace terrane
