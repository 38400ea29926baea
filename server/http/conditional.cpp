// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/conditional.hpp"

#include <algorithm>
#include <charconv>

#include "ops/sha256.hpp"
#include "server/http/header_fields.hpp"

namespace terrane {

namespace {

bool is_found(const Call& call, const Reply& reply) { return call.method == "GET" && reply.status == 200; }

std::string_view without_weak(std::string_view tag) { return tag.starts_with("W/") ? tag.substr(2) : tag; }

/// One of the tags of an If-Match or If-None-Match; `weak`: W/"x" is as good as "x", else it is nothing.
bool matches(std::string_view list, const std::optional<std::string>& etag, bool weak) {
  if (trimmed_field(list) == "*") return true;
  if (!etag) return false;
  const auto tags = split_field(list, ',');
  return std::any_of(tags.begin(), tags.end(), [&](std::string_view tag) {
    return weak ? without_weak(tag) == without_weak(*etag) : tag == *etag && !tag.starts_with("W/");
  });
}

/// What a cache needs to know of the content that it has already, and no more.
Reply not_modified(const Reply& reply) {
  Reply answer;
  answer.status = 304;
  for (const char* name : {"ETag", "Cache-Control", "Content-Location", "Expires", "Vary"}) {
    if (const auto value = reply_header(reply, name)) answer.headers.emplace_back(name, *value);
  }
  return answer;
}

struct Part {
  std::uint64_t first = 0, size = 0;
};

std::optional<std::uint64_t> number(std::string_view digits) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (end != digits.data() + digits.size() || digits.empty()) return std::nullopt;
  if (error == std::errc::result_out_of_range) return UINT64_MAX;
  return error == std::errc() ? std::optional(value) : std::nullopt;
}

/// "0-99", "100-" or "-100" of a content of `size` bytes; nothing when no byte of it is meant.
std::optional<Part> part_of(std::string_view range, std::uint64_t size) {
  const std::size_t dash = range.find('-');
  if (dash == std::string_view::npos || size == 0) return std::nullopt;
  const std::string_view from = trimmed_field(range.substr(0, dash)), to = trimmed_field(range.substr(dash + 1));
  const auto first = number(from), last = number(to);
  if (from.empty()) {
    if (!last || *last == 0) return std::nullopt;
    const std::uint64_t count = std::min(*last, size);
    return Part{size - count, count};
  }
  if (!first || (!last && !to.empty()) || *first >= size) return std::nullopt;
  if (!last) return Part{*first, size - *first};
  if (*last < *first) return std::nullopt;
  return Part{*first, std::min(*last, size - 1) - *first + 1};
}

/// The ranges of a Range header in bytes; nothing when there is none or it counts in another unit, which is ignored.
std::optional<std::string> byte_ranges(const Call& call) {
  const std::string text = header_value(call, "range");
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || small_letters(trimmed_field(text.substr(0, equals))) != "bytes") {
    return std::nullopt;
  }
  return text.substr(equals + 1);
}

Reply partial(Reply&& reply, const std::string& ranges) {
  const std::uint64_t size = *reply.size();
  const auto part = ranges.find(',') == std::string::npos ? part_of(ranges, size) : std::nullopt;
  if (!part) {
    Reply refusal = problem_reply(
        HttpError(416, "no-such-range",
                  "One range of the " + std::to_string(size) + " bytes can be had at a time, such as bytes=0-99.",
                  {{"Content-Range", "bytes */" + std::to_string(size)}}));
    return refusal;
  }
  reply.status = 206;
  set_reply_header(reply, "Content-Range",
                   "bytes " + std::to_string(part->first) + "-" + std::to_string(part->first + part->size - 1) + "/" +
                       std::to_string(size));
  if (auto* text = std::get_if<std::string>(&reply.body)) {
    *text = text->substr(part->first, part->size);
  } else {
    auto& file = std::get<FileBody>(reply.body);
    file.offset += part->first;
    file.size = part->size;
  }
  return std::move(reply);
}

}  // namespace

void add_etag(const Call& call, Reply& reply) {
  if (!is_found(call, reply) || reply_header(reply, "ETag")) return;
  if (reply_header(reply, "Cache-Control").value_or("").find("no-store") != std::string::npos) return;
  if (const auto* file = std::get_if<FileBody>(&reply.body); file && !file->sha256.empty())
    reply.headers.emplace_back("ETag", "\"" + file->sha256 + "\"");
  const auto* text = std::get_if<std::string>(&reply.body);
  if (!text) return;
  // The media type too: JSON and a page of one resource differ even where their bytes would not.
  reply.headers.emplace_back("ETag", "\"" + sha256(reply.media_type + "\n" + *text).substr(0, 32) + "\"");
}

std::string coded_etag(std::string_view etag, std::string_view coding) {
  if (etag.size() < 2 || etag.back() != '"') return std::string(etag);
  return std::string(etag.substr(0, etag.size() - 1)) + "-" + std::string(coding) + "\"";
}

bool asks_for_part(const Call& call, const Reply& reply) {
  if (!is_found(call, reply) || !reply.size() || !byte_ranges(call)) return false;
  const std::string condition(trimmed_field(header_value(call, "if-range")));
  // A date is never known to be the same content; only a strong tag is.
  return condition.empty() || (!condition.starts_with("W/") && condition == reply_header(reply, "ETag"));
}

Reply apply_conditions(const Call& call, Reply&& reply) {
  if (!is_found(call, reply) || std::holds_alternative<StreamBody>(reply.body)) return std::move(reply);
  const auto etag = reply_header(reply, "ETag");
  const std::string wanted = header_value(call, "if-match"), known = header_value(call, "if-none-match");
  if (!wanted.empty() && !matches(wanted, etag, false)) {
    return problem_reply(HttpError(412, "content-differs", "The content is not the one that If-Match names."));
  }
  if (!known.empty() && matches(known, etag, true)) return not_modified(reply);
  set_reply_header(reply, "Accept-Ranges", "bytes");
  if (reply_header(reply, "Content-Encoding") || !asks_for_part(call, reply)) return std::move(reply);
  return partial(std::move(reply), *byte_ranges(call));
}

}  // namespace terrane
