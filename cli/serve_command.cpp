// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/serve_command.hpp"

#include <cstdlib>

#include "cli/command_line.hpp"
#include "server/serve.hpp"
#include "server/settings.hpp"

namespace terrane {

int serve_command(std::span<const std::string> words) {
  std::vector<std::string> known, flags;
  for (const Setting& setting : settings()) {
    known.emplace_back(setting.name);
    if (setting.is_flag()) flags.emplace_back(setting.name);
  }
  return serve(read_settings(parse_options(words, known, flags), std::getenv));
}

}  // namespace terrane
