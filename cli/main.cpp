// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "cli/files.hpp"
#include "cli/help.hpp"
#include "cli/run_operation.hpp"
#include "cli/serve_command.hpp"
#include "core/error.hpp"
#include "ops/errors.hpp"
#include "server/settings.hpp"
#include "server/worker/worker_process.hpp"

// The command-line door: it walks the catalogue.
namespace {

using namespace terrane;

int print(const std::string& text) {
  OutputFile("-", false).write(text);
  return 0;
}

int docs(const std::vector<std::string>& words) {
  if (words.size() == 2 && words[1] == "openapi") return print(openapi_yaml());
  if (words.size() == 2 && words[1] == "openapi-3.0") return print(openapi_30().dump(2) + "\n");
  if (words.size() == 2 && words[1] == "reference") return print(reference_page());
  if (words.size() == 2 && words[1] == "settings") return print(settings_page());
  throw Error(ErrorKind::usage, "usage", "terrane docs openapi, openapi-3.0, reference, or settings");
}

int run(const std::vector<std::string>& words) {
  const auto asks_for_help = [](const std::string& word) { return word == "--help" || word == "-h"; };
  if (words.empty()) {
    std::fputs(general_help().c_str(), stderr);
    return exit_code(ErrorKind::usage);
  }
  if (asks_for_help(words[0]) || (words[0] == "help" && words.size() == 1)) return print(general_help());
  if (words[0] == "help") return print(words[1] == "serve" ? serve_help() : operation_help(find_operation(words[1])));
  if (words[0] == "--version") return print(std::string("terrane ") + TERRANE_VERSION + "\n");
  if (words[0] == "docs") return docs(words);
  const std::span rest(words.begin() + 1, words.end());
  if (words[0] == "serve") {
    if (std::any_of(rest.begin(), rest.end(), asks_for_help)) return print(serve_help());
    return serve_command(rest);
  }
  // Not for people: what `serve` starts to do its work in.
  if (words[0] == "workers" && words.size() == 2) return make_workers(std::atoi(words[1].c_str()));
  const Operation& operation = find_operation(words[0]);
  const CommandLine line = parse_command_line(operation, rest);
  if (line.help) return print(operation_help(operation));
  run_operation(operation, line);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // a reader that goes away is an error we report
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& exception) {
    const Error error = as_error(exception);
    std::fprintf(stderr, "terrane: %s\n", error.what());
    return exit_code(error.kind);
  }
}
