// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/message.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "ops/errors.hpp"

namespace terrane {

namespace {

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

/// Splits at every separator; quotes are not special, no media type we serve needs them.
std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.push_back(trimmed(text.substr(0, end)));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

/// q of an Accept element; 1 when absent, 0 when it is no number.
double quality(const std::vector<std::string_view>& element) {
  for (std::size_t i = 1; i < element.size(); ++i) {
    const std::string parameter = lower(element[i]);
    if (!parameter.starts_with("q=")) continue;
    double q = 0;
    const auto [end, error] = std::from_chars(parameter.data() + 2, parameter.data() + parameter.size(), q);
    return error == std::errc() && q >= 0 ? std::min(q, 1.0) : 0;
  }
  return 1;
}

nlohmann::json http_problem(const HttpError& error) {
  // The house's own problem types, with the status that only HTTP has.
  nlohmann::json value = problem(Error(ErrorKind::usage, error.code, error.what()));
  value["title"] = status_title(error.status);
  value["status"] = error.status;
  return value;
}

}  // namespace

std::string_view status_title(int status) {
  switch (status) {
    case 400: return "Bad Request";
    case 404: return "Not Found";
    case 405: return "Method Not Allowed";
    case 406: return "Not Acceptable";
    case 408: return "Request Timeout";
    case 411: return "Length Required";
    case 413: return "Payload Too Large";
    case 414: return "URI Too Long";
    case 415: return "Unsupported Media Type";
    case 416: return "Range Not Satisfiable";
    case 417: return "Expectation Failed";
    case 422: return "Unprocessable Content";
    case 431: return "Request Header Fields Too Large";
    case 499: return "Client Closed Request";
    case 503: return "Service Unavailable";
    default: return status < 500 ? "Bad Request" : "Internal Server Error";
  }
}

Reply json_reply(const nlohmann::json& value) {
  Reply reply;
  reply.media_type = "application/json";
  reply.body = value.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
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
  reply.body = value.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  return reply;
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
  if (trimmed(accept).empty()) return {};
  std::vector<std::pair<double, std::string>> wanted;
  for (const std::string_view element : split(accept, ',')) {
    if (element.empty()) continue;
    const auto parts = split(element, ';');
    const double q = quality(parts);
    if (q > 0) wanted.emplace_back(q, lower(parts[0]));
  }
  if (wanted.empty()) throw HttpError(406, "not-acceptable", "The Accept header refuses every media type.");
  std::stable_sort(wanted.begin(), wanted.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  if (wanted.front().second == "*/*") return {};
  std::vector<std::string> types;
  for (auto& [q, type] : wanted) types.push_back(std::move(type));
  return types;
}

bool is_accepted(const std::vector<std::string>& accepted, std::string_view media_type) {
  if (accepted.empty()) return true;
  const std::string_view plain = trimmed(media_type.substr(0, media_type.find(';')));
  return std::any_of(accepted.begin(), accepted.end(), [&](const std::string& range) {
    if (range == "*/*" || range == plain) return true;
    return range.ends_with("/*") && plain.starts_with(std::string_view(range).substr(0, range.size() - 1));
  });
}

std::string media_type(std::string_view content_type) {
  return lower(trimmed(content_type.substr(0, content_type.find(';'))));
}

std::string header_text(std::string_view text) {
  std::string result;
  for (const char c : text) result += c < ' ' || c > '~' || c == '"' || c == '\\' ? '_' : c;
  return result;
}

}  // namespace terrane
