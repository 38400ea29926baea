// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/settings.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <set>
#include <sstream>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "ops/parameters.hpp"

namespace terrane {

namespace {

constexpr std::size_t kilo = 1024, mega = kilo * kilo, giga = mega * kilo, tera = giga * kilo;
constexpr int year = 366 * 86400;  // in seconds

/// A value that was not understood; the caller knows where it stood.
struct Misfit {
  std::string expected;
};

std::string size_text(std::size_t bytes) {
  for (const auto& [unit, letter] : {std::pair{tera, "T"}, {giga, "G"}, {mega, "M"}, {kilo, "K"}})
    if (bytes >= unit && bytes % unit == 0) return std::to_string(bytes / unit) + letter;
  return std::to_string(bytes);
}

/// "1G", "512M", "64k", "1000000": powers of 1024.
std::size_t read_size(std::string text, const Setting& setting) {
  double factor = 1;
  const std::size_t letter = text.empty() ? std::string::npos : std::string_view("kmgt").find(text.back() | ' ');
  if (letter != std::string::npos) {
    for (std::size_t i = 0; i <= letter; ++i) factor *= 1024;
    text.pop_back();
  }
  const auto value = parse_number(text);
  if (!value || *value * factor < static_cast<double>(setting.low) ||
      *value * factor > static_cast<double>(setting.high)) {
    throw Misfit{"a size such as 1G, 512M or 64K, from " + size_text(setting.low) + " to " + size_text(setting.high)};
  }
  return static_cast<std::size_t>(*value * factor);
}

int read_integer(const std::string& text, const Setting& setting) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < setting.low || value > setting.high) {
    throw Misfit{"a whole number from " + std::to_string(setting.low) + " to " + std::to_string(setting.high)};
  }
  return static_cast<int>(value);
}

bool read_truth(const std::string& text) {
  if (text == "true" || text == "1") return true;
  if (text == "false" || text == "0") return false;
  throw Misfit{"true or false"};
}

LogLevel read_level(const std::string& text) {
  if (const auto level = log_level(text)) return *level;
  throw Misfit{"info, warning or error"};
}

std::vector<std::string> read_list(const std::string& text) {
  std::vector<std::string> list;
  if (text == "none") return list;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    word.erase(0, word.find_first_not_of(' '));
    word.erase(word.find_last_not_of(' ') + 1);
    if (!word.empty()) list.push_back(word);
  }
  return list;
}

std::string joined(const std::vector<std::string>& list) {
  std::string text;
  for (const std::string& word : list) text += (text.empty() ? "" : ",") + word;
  return text;
}

/// `place` begins the sentence about a value that is not understood: "--port", "TERRANE_PORT".
void set(ServeOptions& options, const Setting& setting, const std::string& text, const std::string& place) {
  try {
    std::visit(
        [&](auto member) {
          auto& value = options.*member;
          using Value = std::remove_reference_t<decltype(value)>;
          if constexpr (std::is_same_v<Value, std::string>) value = text;
          if constexpr (std::is_same_v<Value, int>) value = read_integer(text, setting);
          if constexpr (std::is_same_v<Value, std::size_t>) value = read_size(text, setting);
          if constexpr (std::is_same_v<Value, bool>) value = read_truth(text);
          if constexpr (std::is_same_v<Value, std::vector<std::string>>) value = read_list(text);
          if constexpr (std::is_same_v<Value, LogLevel>) value = read_level(text);
        },
        setting.member);
  } catch (const Misfit& misfit) {
    throw Error(ErrorKind::usage, "bad-option", place + " is '" + text + "'; it takes " + misfit.expected + ".");
  }
}

const Setting* find_setting(std::string_view name) {
  const auto& all = settings();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Setting& s) { return s.name == name; });
  return found == all.end() ? nullptr : &*found;
}

/// Where a member's name stands; the parser does not say.
std::string line_of(const std::string& text, const std::string& name) {
  const std::size_t at = std::min(text.find(nlohmann::json(name).dump()), text.size());
  return "line " + std::to_string(1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

/// A member's value as a flag would have it.
std::string flag_text(const nlohmann::json& value, const std::string& place) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number() || value.is_boolean()) return value.dump();
  throw Error(ErrorKind::usage, "bad-option", place + " is neither text nor a number nor true or false.");
}

void set_member(ServeOptions& options, const Setting& setting, const nlohmann::json& value, const std::string& place) {
  const auto* list = std::get_if<std::vector<std::string> ServeOptions::*>(&setting.member);
  if (!list || !value.is_array()) return set(options, setting, flag_text(value, place), place);
  std::vector<std::string> words;
  for (const nlohmann::json& word : value) words.push_back(flag_text(word, place));
  options.*(*list) = std::move(words);
}

std::string file_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  if (!file || !(text << file.rdbuf())) {
    throw Error(ErrorKind::usage, "bad-config", "The file of settings " + path + " cannot be read or is empty.");
  }
  return text.str();
}

nlohmann::json parse_object(const std::string& text, const std::string& path) {
  std::set<std::string> names;
  const auto once = [&](int depth, nlohmann::json::parse_event_t event, nlohmann::json& parsed) {
    if (event != nlohmann::json::parse_event_t::key || depth != 1) return true;
    if (names.insert(parsed.get<std::string>()).second) return true;
    throw Error(ErrorKind::usage, "bad-config", path + " has '" + parsed.get<std::string>() + "' twice.");
  };
  nlohmann::json object;
  try {
    object = nlohmann::json::parse(text, once, true, true);
  } catch (const nlohmann::json::exception& exception) {
    const std::string what = exception.what();
    throw Error(ErrorKind::usage, "bad-config", path + " is not JSON: " + what.substr(what.find(' ') + 1));
  }
  if (!object.is_object()) throw Error(ErrorKind::usage, "bad-config", path + " is not a JSON object.");
  return object;
}

/// "TERRANE_MAX_BODY".
std::string variable_name(const Setting& setting) {
  std::string name = "TERRANE_" + std::string(setting.name);
  for (char& c : name) c = c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return name;
}

}  // namespace

const std::vector<Setting>& settings() {
  using O = ServeOptions;
  static const std::vector<Setting> all = {
      {"config", &O::config, "FILE", 0, 0,
       "A JSON object of the settings on this page, by their names; `//` begins a comment there."},
      {"host", &O::host, "ADDRESS", 0, 0, "The address to listen on; beyond this machine only with tokens."},
      {"port", &O::port, "N", 0, 65535, "The port to listen on; 0: a free one, named on standard output."},
      {"data", &O::data, "FOLDER", 0, 0, "Where jobs and results are kept; the user's state directory otherwise."},
      {"store", &O::store, "URI", 0, 0,
       "Where jobs are recorded: sqlite, in the data folder, or postgresql://host/database, for several servers."},
      {"threads", &O::threads, "N", 0, 1024, "Executions at the same time; 0: one per core."},
      {"max-body", &O::max_body, "SIZE", 1, tera, "The largest body of a request, unpacked."},
      {"sync-limit", &O::sync_limit, "SIZE", 1, tera,
       "The largest body that is worked on while the client waits; larger ones need Prefer: respond-async."},
      {"sync-time", &O::sync_time, "SECONDS", 1, year, "How long an execution may take while the client waits."},
      {"job-memory", &O::job_memory, "SIZE", 180 * mega, 64 * tera,
       "The address space that one execution may take: some 170M by itself, and what docs/memory.md says of operations."},
      {"job-time", &O::job_time, "SECONDS", 1, year, "How long a job may run."},
      {"job-expiry", &O::job_expiry, "SECONDS", 1, 10 * year, "How long a job and its results are kept at its end."},
      {"max-jobs", &O::max_jobs, "N", 0, 1'000'000, "How many jobs may wait; more are refused."},
      {"allow-hosts", &O::allow_hosts, "LIST", 0, 0,
       "The hosts that inputs and callbacks by reference may name, with commas between; none otherwise."},
      {"token-file", &O::token_file, "FILE", 0, 0,
       "Bearer tokens, one per line and its owner's name behind it; with it all but /health and /ready needs one."},
      {"allow-anonymous", &O::allow_anonymous, "", 0, 0,
       "Listens beyond this machine without tokens: whoever reaches the port may use it."},
      {"cors-origins", &O::cors_origins, "LIST", 0, 0,
       "The origins whose pages may use the service, with commas between; * for all, `none` for none."},
      {"log-level", &O::log_level, "LEVEL", 0, 0,
       "How grave what is logged is at least: info (every request), warning or error."},
  };
  return all;
}

std::string default_text(const Setting& setting) {
  static const ServeOptions defaults;
  return std::visit(
      [](auto member) -> std::string {
        const auto& value = defaults.*member;
        using Value = std::remove_cvref_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, std::string>) return value;
        if constexpr (std::is_same_v<Value, int>) return std::to_string(value);
        if constexpr (std::is_same_v<Value, std::size_t>) return size_text(value);
        if constexpr (std::is_same_v<Value, bool>) return value ? "true" : "false";
        if constexpr (std::is_same_v<Value, std::vector<std::string>>) return joined(value);
        if constexpr (std::is_same_v<Value, LogLevel>) return std::string(word(value));
      },
      setting.member);
}

void read_settings_file(ServeOptions& options, const std::string& text, const std::string& path) {
  const nlohmann::json object = parse_object(text, path);
  for (const auto& [name, value] : object.items()) {
    const std::string place = "'" + name + "' in " + line_of(text, name) + " of " + path;
    const Setting* setting = find_setting(name);
    if (!setting || name == "config") {
      throw Error(ErrorKind::usage, "unknown-setting", place + " is no setting; terrane serve --help lists them.");
    }
    set_member(options, *setting, value, place);
  }
}

ServeOptions read_settings(const Flags& flags, const Environment& environment) {
  const auto value_of = [&](const Setting& setting) -> std::pair<const std::string*, const char*> {
    const std::string* flag = nullptr;
    for (const auto& [name, text] : flags)
      if (name == setting.name) flag = &text;
    const char* variable = environment(variable_name(setting).c_str());
    return {flag, variable && *variable ? variable : nullptr};
  };
  ServeOptions options;
  const auto [config_flag, config_variable] = value_of(*find_setting("config"));
  const std::string config = config_flag ? *config_flag : config_variable ? config_variable : "";
  if (!config.empty()) read_settings_file(options, file_text(config), config);
  for (const Setting& setting : settings()) {
    const auto [flag, variable] = value_of(setting);
    if (flag) {
      set(options, setting, *flag, "--" + std::string(setting.name));
    } else if (variable) {
      set(options, setting, variable, variable_name(setting));
    }
  }
  return options;
}

std::string settings_page() {
  std::string page =
      "<!-- Generated by `terrane docs settings`; a test fails when it is stale. -->\n"
      "# Settings of the service\n\n"
      "Each can be a flag of `terrane serve`, an environment variable, or a member of the JSON object in the file\n"
      "that `--config` names. A flag wins over the environment, that over the file, that over the default; an empty\n"
      "variable counts as none. Sizes are bytes, or carry K, M, G or T, powers of 1024. Lists have commas between\n"
      "their words, or are arrays in the file.\n\n"
      "```json\n{\n  \"port\": 8081,\n  \"max-body\": \"512M\",\n  \"allow-hosts\": [\"data.example.org\"]\n}\n```\n\n"
      "| flag | environment | default | bounds | |\n|---|---|---|---|---|\n";
  for (const Setting& setting : settings()) {
    const std::string value = default_text(setting);
    const bool is_size = std::holds_alternative<std::size_t ServeOptions::*>(setting.member);
    const auto bound = [&](std::size_t n) { return is_size ? size_text(n) : std::to_string(n); };
    const std::string placeholder(setting.placeholder);
    page += "| `--" + std::string(setting.name) + (placeholder.empty() ? "" : " " + placeholder) + "` | `" +
            variable_name(setting) + "` | " + (value.empty() ? "" : "`" + value + "`") + " | " +
            (setting.high > 0 ? bound(setting.low) + " to " + bound(setting.high) : "") + " | " +
            std::string(setting.sentence) + " |\n";
  }
  return page;
}

}  // namespace terrane
