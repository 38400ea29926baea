// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/command_line.hpp"

#include <algorithm>
#include <set>

#include "core/error.hpp"
#include "ops/parameters.hpp"

namespace terrane {
namespace {

bool is_boolean(const Operation& operation, const std::string& name) {
  const auto says_so = [&](const Parameter& p) { return p.name == name && p.type == Parameter::Type::boolean; };
  return std::any_of(operation.parameters.begin(), operation.parameters.end(), says_so) ||
         std::any_of(common_parameters().begin(), common_parameters().end(), says_so);
}

/// A word that starts a flag: "-o", "--seam", "--seam=wall", but not "-", "-5" or "-5ft".
bool is_flag(const std::string& word) { return word.size() > 1 && word[0] == '-' && !Length::read(word); }

/// Reads flags one by one, with their values.
class Words {
 public:
  explicit Words(std::span<const std::string> words) : words_(words) {}
  bool empty() const { return next_ == words_.size(); }
  std::string take() { return words_[next_++]; }

  /// Splits "--name=value" off the flag just taken; the value stays for `value`.
  std::string name(const std::string& flag) {
    const std::size_t equals = flag.starts_with("--") ? flag.find('=') : std::string::npos;
    has_value_ = equals != std::string::npos;
    if (has_value_) value_ = flag.substr(equals + 1);
    return flag.substr(0, equals);
  }
  std::string value(const std::string& flag) {
    if (has_value_) return value_;
    if (empty()) throw Error(ErrorKind::usage, "missing-value", "'" + flag + "' needs a value");
    return take();
  }
  std::string truth() {
    if (has_value_) return value_;
    if (!empty() && (words_[next_] == "true" || words_[next_] == "false")) return take();
    return "true";
  }

 private:
  std::span<const std::string> words_;
  std::size_t next_ = 0;
  bool has_value_ = false;
  std::string value_;
};

}  // namespace

CommandLine parse_command_line(const Operation& operation, std::span<const std::string> words) {
  CommandLine line;
  Words rest(words);
  bool flags = true;
  std::set<std::string> given;
  const auto once = [&](const std::string& name, std::string value) {
    if (!given.insert(name).second) throw Error(ErrorKind::usage, "repeated-flag", "'" + name + "' is given twice");
    return value;
  };
  while (!rest.empty()) {
    const std::string word = rest.take();
    if (flags && word == "--") {
      flags = false;
      continue;
    }
    if (!flags || !is_flag(word)) {
      line.inputs.push_back(word);
      continue;
    }
    const std::string flag = rest.name(word);
    if (flag == "-o" || flag == "--output")
      line.output = once("--output", rest.value(flag));
    else if (flag == "--report")
      line.report = once("--report", rest.value(flag));
    else if (flag == "--format" || flag == "-f")
      line.format = once("--format", rest.value(flag));
    else if (flag == "--quiet" || flag == "-q")
      line.quiet = rest.truth() == "true";
    else if (flag == "--force")
      line.force = rest.truth() == "true";
    else if (flag == "--help" || flag == "-h")
      line.help = true;
    else if (!flag.starts_with("--"))
      throw Error(ErrorKind::usage, "unknown-flag",
                  "there is no flag '" + flag + "'; see terrane " + operation.id + " --help");
    else if (const std::string name = flag.substr(2); is_boolean(operation, name))
      line.parameters.emplace_back(name, rest.truth());
    else
      line.parameters.emplace_back(name, rest.value(flag));
  }
  return line;
}

std::vector<std::pair<std::string, std::string>> parse_options(std::span<const std::string> words,
                                                               const std::vector<std::string>& known,
                                                               const std::vector<std::string>& flags) {
  std::vector<std::pair<std::string, std::string>> options;
  Words rest(words);
  while (!rest.empty()) {
    const std::string flag = rest.name(rest.take());
    if (!flag.starts_with("--") || std::find(known.begin(), known.end(), flag.substr(2)) == known.end()) {
      std::string list;
      for (const std::string& name : known) list += (list.empty() ? "--" : ", --") + name;
      throw Error(ErrorKind::usage, "unknown-flag", "'" + flag + "' is not understood; there are " + list);
    }
    const bool is_boolean = std::find(flags.begin(), flags.end(), flag.substr(2)) != flags.end();
    options.emplace_back(flag.substr(2), is_boolean ? rest.truth() : rest.value(flag));
  }
  return options;
}

}  // namespace terrane
