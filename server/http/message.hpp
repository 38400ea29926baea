// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/error.hpp"
#include "server/http/open_file.hpp"

// Requests and answers as plain values: what the rest of the room sees of HTTP. Only routes.cpp knows the library.
namespace terrane {

using TextPairs = std::vector<std::pair<std::string, std::string>>;

/// A request whose header is read and whose body is not.
struct Call {
  std::string method;   // "HEAD" arrives as "GET"
  std::string path;     // percent-decoded
  TextPairs query;      // percent-decoded, in the order of the names
  TextPairs headers;    // names in small letters, in the order of the names
  std::string client;   // its address
  std::string host;     // as the client wrote it
  std::string version;  // "HTTP/1.1"
  std::string user;     // the owner of its token; empty where nobody needs one
  std::string accept, content_type, content_encoding, content_length, transfer_encoding;
};

/// The body of an answer that is sent from a file: `size` bytes from `offset`. The file stays open until it is sent, so
/// that it may be removed meanwhile.
struct FileBody {
  std::shared_ptr<const OpenFile> file;
  std::uint64_t offset = 0, size = 0;
  std::string sha256 = {};  // of the whole file, where it is known
};

/// The body of an answer that is made while it is sent, such as events. Hands pieces to `write` until the end, or until
/// that says that nobody listens any more.
using StreamBody = std::function<void(const std::function<bool(std::string_view)>& write)>;

struct Reply {
  int status = 200;
  std::string media_type;
  TextPairs headers;
  std::variant<std::string, FileBody, StreamBody> body;

  /// Bytes of the body, none known of a stream.
  std::optional<std::uint64_t> size() const;
};

/// Hands the decoded body on piece by piece; the sink throws to stop. False: the transfer broke off or is malformed.
using BodySource = std::function<bool(const std::function<void(std::string_view)>& sink)>;

/// A refusal that belongs to HTTP alone (404 of a path, 405, 411, 415 ...), beside the Errors every door has.
class HttpError : public std::runtime_error {
 public:
  HttpError(int status, std::string code, const std::string& message, TextPairs headers = {})
      : std::runtime_error(message), status(status), code(std::move(code)), headers(std::move(headers)) {}
  int status;
  std::string code;
  TextPairs headers;
};

Reply json_reply(const nlohmann::json& value);
/// application/problem+json, RFC 7807. An exception that is neither HttpError nor Error says nothing of its text.
Reply problem_reply(const std::exception& exception);

/// "Not Found" for 404.
std::string_view status_title(int status);

/// "http://host" as the client addressed us, so that links work from where it stands; empty when the host is odd.
std::string base_url(const Call& call);

/// The value of a header, "" when it is not there; of several with that name all, with commas between.
std::string header_value(const Call& call, std::string_view small_name);

/// The one value of a query parameter or none; throws HttpError 400 when it is given twice.
std::optional<std::string> query_value(const Call& call, std::string_view name);

/// The media types of an Accept header, most wanted first, those with q=0 left out; empty when anything will do.
/// Throws HttpError 406 when the header refuses everything.
std::vector<std::string> accepted_media_types(std::string_view accept);
/// True when one of the ranges ("*/*", "image/*", "text/html") covers the media type, or there are none.
bool is_accepted(const std::vector<std::string>& accepted, std::string_view media_type);

/// A Content-Type without its parameters, in small letters: media types are the same however they are written.
std::string media_type(std::string_view content_type);

/// Throws HttpError 400 where a media type that a client gave is not printable ASCII.
void require_media_type(std::string_view text);

/// A file name as a client may have it kept: no folders, no control characters, UTF-8.
std::string base_name(std::string_view path);

/// Text for a quoted string in a header: printable ASCII, no quotes, no backslashes.
std::string header_text(std::string_view text);

}  // namespace terrane
