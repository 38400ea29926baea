// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/request_head.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>

#include "server/http/http_limits.hpp"

namespace terrane {

namespace {

[[noreturn]] void refuse(const char* what) { throw HttpError(400, "bad-request", what); }

bool is_token(std::string_view text) {
  constexpr std::string_view marks = "!#$%&'*+-.^_`|~";
  return !text.empty() && std::all_of(text.begin(), text.end(), [&](unsigned char c) {
    return std::isalnum(c) || marks.find(static_cast<char>(c)) != std::string_view::npos;
  });
}

/// No control characters; what is beyond ASCII passes, as everywhere.
bool is_plain(std::string_view text) {
  return std::none_of(text.begin(), text.end(), [](unsigned char c) { return (c < ' ' && c != '\t') || c == 127; });
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::string small(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

/// Takes one line off the head, which ends with one.
std::string_view next_line(std::string_view& head) {
  const std::size_t end = head.find('\n');
  if (end == std::string_view::npos || end == 0 || head[end - 1] != '\r') refuse("Lines of the header end with CRLF.");
  const std::string_view line = head.substr(0, end - 1);
  head.remove_prefix(end + 1);
  return line;
}

/// What the library would take for no HTTP at all.
void require_method(const std::string& method) {
  constexpr std::array known = {"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS", "TRACE", "CONNECT"};
  if (std::find(known.begin(), known.end(), method) != known.end()) return;
  const std::string allowed = "GET, HEAD, POST, DELETE, OPTIONS";
  throw HttpError(405, "method-not-allowed", "This service takes " + allowed + ".", {{"Allow", allowed}});
}

void parse_request_line(std::string_view line, RequestHead& head) {
  const std::size_t first = line.find(' '), last = line.rfind(' ');
  constexpr const char* invalid = "The request line is not valid HTTP.";
  if (first == std::string_view::npos || first == last || !is_plain(line)) refuse(invalid);
  head.method = line.substr(0, first);
  head.target = line.substr(first + 1, last - first - 1);
  head.version = line.substr(last + 1);
  if (!is_token(head.method) || head.target.empty() || head.target.find_first_of(" \t") != std::string::npos ||
      (head.version != "HTTP/1.1" && head.version != "HTTP/1.0")) {
    refuse(invalid);
  }
  require_method(head.method);
  // The absolute form, which every server has to understand.
  if (small(head.target).starts_with("http://")) {
    const std::size_t path = head.target.find_first_of("/?", 7);
    const std::string rest = path == std::string::npos ? "" : head.target.substr(path);
    head.target = rest.starts_with("/") ? rest : "/" + rest;
  }
  if (head.target[0] != '/' && head.target != "*") refuse(invalid);
}

void parse_header_line(std::string_view line, RequestHead& head) {
  const std::size_t colon = line.find(':');
  // A blank before the colon or at the beginning of a line means different things to different programs.
  if (colon == std::string_view::npos || !is_token(line.substr(0, colon))) refuse("A header line has no name.");
  const std::string_view value = trimmed(line.substr(colon + 1));
  if (!is_plain(value)) refuse("A header line holds control characters.");
  if (head.headers.size() == http_limits::header_lines) {
    throw HttpError(431, "header-too-large", "The header has more than 100 lines.");
  }
  head.headers.emplace_back(small(line.substr(0, colon)), value);
}

void find_framing(RequestHead& head) {
  const std::size_t lengths = head.count("content-length"), codings = head.count("transfer-encoding");
  if (lengths + codings > 1) throw HttpError(400, "ambiguous-length", "The length of the body is said twice.");
  if (codings > 0) {
    if (small(head.value("transfer-encoding")) != "chunked" || head.version == "HTTP/1.0") {
      throw HttpError(400, "unknown-transfer-coding",
                      "The only transfer coding understood is chunked, and not in HTTP/1.0.");
    }
    head.framing = Framing::chunks;
  } else if (lengths > 0) {
    const std::string_view digits = head.value("content-length");
    if (digits.empty() || digits.find_first_not_of("0123456789") != std::string_view::npos) {
      throw HttpError(400, "bad-length", "The Content-Length is not a usable number.");
    }
    head.length = digits.size() > 18 ? std::numeric_limits<std::uint64_t>::max() : std::stoull(std::string(digits));
    head.framing = head.length > 0 ? Framing::length : Framing::none;
  } else {
    head.says_nothing_of_body = head.method == "POST" || head.method == "PUT" || head.method == "PATCH";
  }
}

}  // namespace

std::string_view RequestHead::value(std::string_view small_name) const {
  const auto found =
      std::find_if(headers.begin(), headers.end(), [&](const auto& header) { return header.first == small_name; });
  return found == headers.end() ? std::string_view() : found->second;
}

std::size_t RequestHead::count(std::string_view small_name) const {
  return static_cast<std::size_t>(
      std::count_if(headers.begin(), headers.end(), [&](const auto& header) { return header.first == small_name; }));
}

std::size_t head_size(std::string_view input) {
  std::size_t start = 0;
  while (input.substr(start).starts_with("\r\n")) start += 2;
  const std::size_t line = std::min(input.find('\n', start), input.size()) - start;
  if (line > http_limits::request_line) {
    throw HttpError(414, "path-too-long",
                    "The path with its query is longer than 8192 bytes; send parameters as form fields.");
  }
  const std::size_t end = input.find("\r\n\r\n", start);
  const std::size_t size = end == std::string_view::npos ? 0 : end + 4;
  if (std::max(size, size == 0 ? input.size() : 0) > http_limits::header) {
    throw HttpError(431, "header-too-large", "The header is larger than 16 KB.");
  }
  // Whoever ends lines with LF alone never ends a header; say so at once.
  if (size == 0 && input.find("\n\n", start) != std::string_view::npos) refuse("Lines of the header end with CRLF.");
  return size;
}

RequestHead parse_head(std::string_view text) {
  while (text.starts_with("\r\n")) text.remove_prefix(2);
  RequestHead head;
  parse_request_line(next_line(text), head);
  for (std::string_view line = next_line(text); !line.empty(); line = next_line(text)) parse_header_line(line, head);
  std::stable_sort(head.headers.begin(), head.headers.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  find_framing(head);
  const bool old = head.version == "HTTP/1.0";
  head.expects_continue = !old && small(head.value("expect")) == "100-continue";
  const std::string_view range = head.value("range");
  if (static_cast<std::size_t>(std::count(range.begin(), range.end(), ',')) >= http_limits::ranges) {
    throw HttpError(416, "too-many-ranges", "A Range may hold one range.");
  }
  return head;
}

std::string head_for_library(const RequestHead& head, std::uint64_t body_size) {
  std::string text = head.method + " " + head.target + " " + head.version + "\r\n";
  const auto pass = [&](const char* name, const char* small_name) {
    const std::string_view value = head.value(small_name);
    if (!value.empty() && value.find('%') == std::string_view::npos) {
      text.append(name).append(": ").append(value).append("\r\n");
    }
  };
  pass("Accept-Encoding", "accept-encoding");
  // It compares letter by letter.
  const std::string connection = small(head.value("connection"));
  if (connection.find("close") != std::string::npos)
    text += "Connection: close\r\n";
  else if (connection.find("keep-alive") != std::string::npos)
    text += "Connection: Keep-Alive\r\n";
  if (head.framing != Framing::none || !head.says_nothing_of_body) {
    text += "Content-Length: " + std::to_string(body_size) + "\r\n";
  }
  return text + "\r\n";
}

}  // namespace terrane
