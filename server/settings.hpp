// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "server/serve.hpp"

// The one description of how the service can be set up: from it come the flags of `terrane serve`, its --help, the
// environment variables, the members of the file, and docs/settings.md.
namespace terrane {

struct Setting {
  using Member = std::variant<std::string ServeOptions::*, int ServeOptions::*, std::size_t ServeOptions::*,
                              bool ServeOptions::*, std::vector<std::string> ServeOptions::*, LogLevel ServeOptions::*>;

  std::string_view name;         // "max-body": --max-body, TERRANE_MAX_BODY, "max-body" in the file
  Member member;                 // its type is how the text is read; its default is the struct's
  std::string_view placeholder;  // "SIZE"; none for what is true or false
  std::size_t low, high;         // of numbers, both included
  std::string_view sentence;

  bool is_flag() const { return std::holds_alternative<bool ServeOptions::*>(member); }
};

const std::vector<Setting>& settings();

/// As it could be written: "1G", "8080", "*"; empty for an empty text or list.
std::string default_text(const Setting& setting);

using Flags = std::vector<std::pair<std::string, std::string>>;
/// The value of a variable, or null.
using Environment = std::function<const char*(const char*)>;

/// Flags win over the environment, that over the file, that over the defaults; an empty variable is none. The last of
/// several flags of one name counts. Throws Error{usage} that says where the value stands: the flag, the variable, the
/// line of the file.
ServeOptions read_settings(const Flags& flags, const Environment& environment);

/// The members of the file's JSON text on top of `options`; `path` is for messages.
void read_settings_file(ServeOptions& options, const std::string& text, const std::string& path);

/// docs/settings.md.
std::string settings_page();

}  // namespace terrane
