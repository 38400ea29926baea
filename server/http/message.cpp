// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/message.hpp"

#include <algorithm>
#include <cctype>

#include "ops/errors.hpp"
#include "ops/json_value.hpp"
#include "server/http/header_fields.hpp"

namespace terrane {

namespace {

nlohmann::json http_problem(const HttpError& error) {
  // The house's own problem types, with the status that only HTTP has.
  nlohmann::json value = problem(Error(ErrorKind::usage, error.code, error.what()));
  // Three that OGC API - Processes names itself.
  if (error.code == "no-such-job" || error.code == "result-not-ready" || error.code == "no-such-process")
    value["type"] = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/" + error.code;
  value["title"] = status_title(error.status);
  value["status"] = error.status;
  return value;
}

}  // namespace

std::string_view status_title(int status) {
  switch (status) {
    case 400:
      return "Bad Request";
    case 401:
      return "Unauthorized";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 406:
      return "Not Acceptable";
    case 408:
      return "Request Timeout";
    case 409:
      return "Conflict";
    case 410:
      return "Gone";
    case 411:
      return "Length Required";
    case 412:
      return "Precondition Failed";
    case 413:
      return "Payload Too Large";
    case 414:
      return "URI Too Long";
    case 415:
      return "Unsupported Media Type";
    case 416:
      return "Range Not Satisfiable";
    case 417:
      return "Expectation Failed";
    case 422:
      return "Unprocessable Content";
    case 429:
      return "Too Many Requests";
    case 431:
      return "Request Header Fields Too Large";
    case 499:
      return "Client Closed Request";
    case 503:
      return "Service Unavailable";
    case 507:
      return "Insufficient Storage";
    default:
      return status < 500 ? "Bad Request" : "Internal Server Error";
  }
}

Reply json_reply(const nlohmann::json& value) {
  Reply reply;
  reply.media_type = "application/json";
  reply.body = json_text(value, 2) + "\n";
  return reply;
}

Reply problem_reply(const std::exception& exception) {
  nlohmann::json value;
  Reply reply;
  if (const auto* http = dynamic_cast<const HttpError*>(&exception)) {
    value = http_problem(*http);
    reply.headers = http->headers;
  } else {
    const Error error = as_error(exception);
    value = problem(error);
    value["status"] = http_status(error.kind);
    if (error.kind == ErrorKind::busy) reply.headers.emplace_back("Retry-After", "5");
  }
  reply.status = value["status"].get<int>();
  reply.media_type = "application/problem+json";
  reply.body = json_text(value, 2) + "\n";
  return reply;
}

std::optional<std::uint64_t> Reply::size() const {
  if (const auto* text = std::get_if<std::string>(&body)) return text->size();
  if (const auto* file = std::get_if<FileBody>(&body)) return file->size;
  return std::nullopt;
}

std::string base_url(const Call& call) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) || c == '.' || c == '-' || c == ':' || c == '[' || c == ']';
  };
  if (call.host.empty() || call.host.size() > 255 || !std::all_of(call.host.begin(), call.host.end(), plain)) return "";
  return "http://" + call.host;
}

std::string header_value(const Call& call, std::string_view small_name) {
  std::string all;
  for (const auto& [name, value] : call.headers)
    if (name == small_name) all += (all.empty() ? "" : ", ") + value;
  return all;
}

std::optional<std::string> query_value(const Call& call, std::string_view name) {
  std::optional<std::string> value;
  for (const auto& [key, text] : call.query) {
    if (key != name) continue;
    if (value) throw HttpError(400, "repeated-parameter", "The parameter " + key + " is given more than once.");
    value = text;
  }
  return value;
}

std::vector<std::string> accepted_media_types(std::string_view accept) {
  if (trimmed_field(accept).empty()) return {};
  auto wanted = weighted_list(accept);
  std::erase_if(wanted, [](const Weighted& element) { return element.weight == 0; });
  if (wanted.empty()) throw HttpError(406, "not-acceptable", "The Accept header refuses every media type.");
  std::stable_sort(wanted.begin(), wanted.end(), [](const auto& a, const auto& b) { return a.weight > b.weight; });
  if (wanted.front().value == "*/*") return {};
  std::vector<std::string> types;
  for (Weighted& element : wanted) types.push_back(std::move(element.value));
  return types;
}

bool is_accepted(const std::vector<std::string>& accepted, std::string_view media_type) {
  if (accepted.empty()) return true;
  const std::string_view plain = trimmed_field(media_type.substr(0, media_type.find(';')));
  return std::any_of(accepted.begin(), accepted.end(), [&](const std::string& range) {
    if (range == "*/*" || range == plain) return true;
    return range.ends_with("/*") && plain.starts_with(std::string_view(range).substr(0, range.size() - 1));
  });
}

std::string media_type(std::string_view content_type) {
  return small_letters(trimmed_field(content_type.substr(0, content_type.find(';'))));
}

void require_media_type(std::string_view text) {
  if (std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; })) return;
  throw HttpError(400, "bad-media-type", "The media type " + header_text(text.substr(0, 80)) + " is none.");
}

std::string base_name(std::string_view path) {
  path = path.substr(path.find_last_of("/\\") + 1);
  std::string name;
  for (const char c : path.substr(0, 255)) name += static_cast<unsigned char>(c) < 32 || c == 127 ? '_' : c;
  return utf8_text(name);
}

std::string header_text(std::string_view text) {
  std::string result;
  for (const char c : text) result += c < ' ' || c > '~' || c == '"' || c == '\\' ? '_' : c;
  return result;
}

}  // namespace terrane
