// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/requests/multipart.hpp"

#include <algorithm>
#include <cctype>
#include <optional>
#include <utility>

#include "core/error.hpp"
#include "server/http/message.hpp"

namespace terrane {

namespace {

[[noreturn]] void fail(const std::string& message) {
  throw Error(ErrorKind::usage, "bad-multipart", message + " Send it as curl -F does.");
}

bool same_word(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

/// The value of a header parameter (name="…" or name=…). Only \" and \\ are escapes: old browsers send Windows paths.
std::optional<std::string> header_parameter(std::string_view value, std::string_view name) {
  std::size_t at = value.find(';');
  while (at < value.size()) {
    const std::size_t equals = value.find('=', ++at);
    if (equals == std::string_view::npos) return std::nullopt;
    const std::string_view key = trimmed(value.substr(at, equals - at));
    std::string text;
    at = equals + 1;
    if (at < value.size() && value[at] == '"') {
      for (++at; at < value.size() && value[at] != '"'; ++at) {
        if (value[at] == '\\' && at + 1 < value.size() && (value[at + 1] == '"' || value[at + 1] == '\\')) ++at;
        text += value[at];
      }
      at = value.find(';', at);
    } else {
      const std::size_t end = std::min(value.find(';', at), value.size());
      text = trimmed(value.substr(at, end - at));
      at = end;
    }
    if (same_word(key, name)) return text;
  }
  return std::nullopt;
}

}  // namespace

std::string multipart_boundary(std::string_view content_type) {
  const auto boundary = header_parameter(content_type, "boundary");
  if (!boundary || boundary->empty() || boundary->size() > 200) fail("The content type has no usable boundary.");
  return *boundary;
}

MultipartParser::MultipartParser(std::string_view boundary, std::function<std::size_t(const FormPart&)> limit)
    : delimiter_("\r\n--" + std::string(boundary)), limit_(std::move(limit)), pending_("\r\n") {}

void MultipartParser::feed(std::string_view piece) {
  if (state_ == State::epilogue) return;
  pending_ += piece;
  while (step()) {
  }
}

/// One move of the machine; false when more bytes are needed.
bool MultipartParser::step() {
  switch (state_) {
    case State::preamble:
    case State::content: {
      const std::size_t found = pending_.find(delimiter_);
      const bool complete = found != std::string::npos;
      // Without a delimiter, all but what could be its beginning is settled.
      const std::size_t settled = complete ? found : pending_.size() - std::min(pending_.size(), delimiter_.size() - 1);
      if (state_ == State::content) append(std::string_view(pending_).substr(0, settled));
      pending_.erase(0, complete ? settled + delimiter_.size() : settled);
      if (complete) state_ = State::after_boundary;
      return complete;
    }
    case State::after_boundary: {
      if (pending_.size() < 2) return false;
      if (pending_.starts_with("--")) {
        state_ = State::epilogue;
        pending_.clear();
        return false;
      }
      const std::size_t end = pending_.find("\r\n");
      if (end == std::string::npos && pending_.size() < 128) return false;
      if (end == std::string::npos || !trimmed(std::string_view(pending_).substr(0, end)).empty()) {
        fail("There is text behind the boundary of part " + std::to_string(parts_.size() + 1) + ".");
      }
      pending_.erase(0, end);  // the line's end stays, so that a header of no lines is found too
      state_ = State::header;
      return true;
    }
    case State::header: {
      const std::size_t end = pending_.find("\r\n\r\n");
      if (std::min(end, pending_.size()) > max_part_header) {
        fail("The header of part " + std::to_string(parts_.size() + 1) + " is longer than 8192 bytes.");
      }
      if (end == std::string::npos) return false;
      begin_part(std::string_view(pending_).substr(0, end));
      pending_.erase(0, end + 4);
      state_ = State::content;
      return true;
    }
    case State::epilogue:
      return false;
  }
  return false;
}

void MultipartParser::begin_part(std::string_view header) {
  if (parts_.size() == max_parts)
    throw Error(ErrorKind::limit, "too-many-parts", "More than 4096 parts in one request.");
  FormPart part;
  bool described = false;
  while (!header.empty()) {
    header.remove_prefix(2);  // every line still has the CRLF before it
    const std::string_view line = header.substr(0, header.find("\r\n"));
    header.remove_prefix(line.size());
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) continue;
    const std::string_view key = line.substr(0, colon), value = trimmed(line.substr(colon + 1));
    if (same_word(key, "content-type")) part.media_type = value;
    if (!same_word(key, "content-disposition")) continue;
    const auto name = header_parameter(value, "name");
    described = name && !name->empty();
    if (described) part.name = *name;
    if (const auto file = header_parameter(value, "filename")) {
      part.has_file_name = true;
      part.file_name = base_name(*file);
    }
  }
  if (!described) fail("Part " + std::to_string(parts_.size() + 1) + " has no name.");
  part_limit_ = limit_(part);
  parts_.push_back(std::move(part));
}

void MultipartParser::append(std::string_view text) {
  FormPart& part = parts_.back();
  if (part.content.size() + text.size() > part_limit_) {
    throw Error(ErrorKind::limit, "part-too-large",
                "The part " + part.name + " is larger than " + std::to_string(part_limit_) + " bytes.");
  }
  part.content += text;
}

std::vector<FormPart> MultipartParser::finish() {
  if (state_ != State::epilogue) fail("The form ends before its closing boundary.");
  return std::move(parts_);
}

}  // namespace terrane
