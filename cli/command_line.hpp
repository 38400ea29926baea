// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ops/operation.hpp"

namespace terrane {

/// What stands on the command line after the operation's name.
struct CommandLine {
  std::vector<std::string> inputs;  // in the order given; "-" is standard input
  std::vector<std::pair<std::string, std::string>> parameters;  // kebab-case name, text
  std::string output, report, format;
  bool quiet = false, force = false, help = false;
};

/// A flag's value may stand behind '=' or in the next word, whatever that starts with; flags that are true or false
/// need
/// none. A negative number is an input; "--" ends the flags. Throws Error{usage}.
CommandLine parse_command_line(const Operation& operation, std::span<const std::string> words);

/// The options of `terrane serve`, parsed by the same rules: names and values; those among `flags` are true or false.
/// Throws Error{usage} listing `known`.
std::vector<std::pair<std::string, std::string>> parse_options(std::span<const std::string> words,
                                                               const std::vector<std::string>& known,
                                                               const std::vector<std::string>& flags);

}  // namespace terrane
