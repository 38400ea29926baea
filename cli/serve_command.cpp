// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/serve_command.hpp"

#include <charconv>
#include <cmath>
#include <limits>

#include "cli/command_line.hpp"
#include "core/error.hpp"
#include "ops/parameters.hpp"
#include "server/serve.hpp"

namespace terrane {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& text, const std::string& expected) {
  throw Error(ErrorKind::usage, "bad-option", "--" + name + " is '" + text + "'; it takes " + expected);
}

int whole_number(const std::string& name, const std::string& text, int low, int high) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < low || value > high)
    refuse(name, text, "a whole number from " + std::to_string(low) + " to " + std::to_string(high));
  return value;
}

/// "1G", "512M", "64k", "1000000": powers of 1024.
std::size_t size(const std::string& name, const std::string& text) {
  std::string number = text;
  double factor = 1;
  if (!number.empty()) switch (number.back()) {
      case 'k':
      case 'K': factor = 1024.0; break;
      case 'm':
      case 'M': factor = 1024.0 * 1024; break;
      case 'g':
      case 'G': factor = 1024.0 * 1024 * 1024; break;
      default: break;
    }
  if (factor > 1) number.pop_back();
  const auto value = parse_number(number);
  if (!value || *value * factor < 1 || *value * factor > 1e15) refuse(name, text, "a size such as 1G, 512M or 64K");
  return static_cast<std::size_t>(*value * factor);
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    if (end > at) words.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return words;
}

}  // namespace

int serve_command(std::span<const std::string> words) {
  ServeOptions options;
  for (const auto& [name, text] : parse_options(words, {"port", "host", "data", "store", "allow-hosts", "max-body", "threads"})) {
    if (name == "port") options.port = whole_number(name, text, 0, 65535);
    if (name == "host") options.host = text;
    if (name == "data") options.data = text;
    if (name == "store") options.store = text;
    if (name == "allow-hosts") options.allow_hosts = words_of(text);
    if (name == "max-body") options.max_body = size(name, text);
    if (name == "threads") options.threads = whole_number(name, text, 0, 1024);
  }
  return serve(options);
}

}  // namespace terrane
