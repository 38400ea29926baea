// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/settings.hpp"

#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.hpp"

namespace terrane {
namespace {

using Variables = std::map<std::string, std::string>;

ServeOptions read(const Flags& flags, const Variables& variables = {}) {
  return read_settings(flags, [&](const char* name) {
    const auto found = variables.find(name);
    return found == variables.end() ? nullptr : found->second.c_str();
  });
}

ServeOptions from_file(const std::string& text) {
  ServeOptions options;
  read_settings_file(options, text, "a.json");
  return options;
}

template <class Work>
std::string complaint(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::usage);
    return error.what();
  }
  return "none";
}

TEST(Settings, AreDescribedOnce) {
  std::set<std::string_view> names;
  for (const Setting& setting : settings()) {
    EXPECT_TRUE(names.insert(setting.name).second) << setting.name;
    EXPECT_TRUE(setting.sentence.ends_with(".")) << setting.name;
    EXPECT_EQ(setting.placeholder.empty(), setting.is_flag()) << setting.name;
    // What stands in the documents can be given back.
    const std::string value = default_text(setting);
    if (setting.name == "config" || value.empty()) continue;
    EXPECT_NO_THROW(read({{std::string(setting.name), value}})) << setting.name;
  }
}

TEST(Settings, ThePageIsFresh) {
  std::ifstream file(TERRANE_SOURCE_DIR "/docs/settings.md", std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), settings_page()) << "run: terrane docs settings > docs/settings.md";
}

TEST(Settings, FlagsWinOverVariablesOverTheFileOverDefaults) {
  char path[] = "/tmp/terrane-settings-XXXXXX";
  close(mkstemp(path));
  std::ofstream(path) << R"({"port": 1, "threads": 1, "max-jobs": 1, "host": "::1"})";
  const ServeOptions options =
      read({{"port", "3"}, {"config", path}}, {{"TERRANE_PORT", "2"}, {"TERRANE_THREADS", "2"}, {"TERRANE_HOST", ""}});
  EXPECT_EQ(options.port, 3);
  EXPECT_EQ(options.threads, 2);
  EXPECT_EQ(options.max_jobs, 1);
  EXPECT_EQ(options.host, "::1") << "an empty variable is none";
  EXPECT_EQ(options.job_time, 3600);
  EXPECT_EQ(read({}, {{"TERRANE_CONFIG", path}}).port, 1);
  EXPECT_EQ(read({{"port", "4"}, {"port", "5"}}).port, 5) << "the last one counts";
  unlink(path);
  EXPECT_NE(complaint([&] { read({{"config", path}}); }), "none");
}

TEST(Settings, EveryTypeIsRead) {
  const ServeOptions options = read({{"max-body", "1.5k"},
                                     {"sync-limit", "1T"},
                                     {"job-memory", "1g"},
                                     {"allow-anonymous", "true"},
                                     {"allow-hosts", "a.org, b.org,"},
                                     {"cors-origins", "none"},
                                     {"data", "/x y"},
                                     {"log-level", "warning"}});
  EXPECT_EQ(options.max_body, 1536u);
  EXPECT_EQ(options.job_memory, std::size_t{1} << 30);
  EXPECT_TRUE(options.allow_anonymous);
  EXPECT_EQ(options.allow_hosts, (std::vector<std::string>{"a.org", "b.org"}));
  EXPECT_TRUE(options.cors_origins.empty());
  EXPECT_EQ(options.data, "/x y");
  EXPECT_EQ(options.log_level, LogLevel::warning);
  const ServeOptions file = from_file(
      "{\"allow-hosts\": [\"a.org\"], // one\n \"allow-anonymous\": true, \"max-body\": 7, \"job-memory\": \"256M\"}");
  EXPECT_EQ(file.allow_hosts, std::vector<std::string>{"a.org"});
  EXPECT_TRUE(file.allow_anonymous);
  EXPECT_EQ(file.max_body, 7u);
  EXPECT_EQ(file.job_memory, std::size_t{256} << 20);
}

TEST(Settings, ComplaintsSayWhereTheValueStands) {
  EXPECT_EQ(complaint([] {
              read({{"port", "70000"}});
            }),
            "--port is '70000'; it takes a whole number from 0 to 65535.");
  EXPECT_EQ(complaint([] {
              read({{"log-level", "loud"}});
            }),
            "--log-level is 'loud'; it takes info, warning or error.");
  EXPECT_EQ(complaint([] {
              read({}, {{"TERRANE_MAX_BODY", "0"}});
            }),
            "TERRANE_MAX_BODY is '0'; it takes a size such as 1G, 512M or 64K, from 1 to 1T.");
  EXPECT_EQ(complaint([] { from_file("{\n\"host\": \"a\",\n\"port\": 1.5}"); }),
            "'port' in line 3 of a.json is '1.5'; it takes a whole number from 0 to 65535.");
  EXPECT_EQ(complaint([] { from_file("{\n\"prot\": 1}"); }),
            "'prot' in line 2 of a.json is no setting; terrane serve --help lists them.");
  EXPECT_EQ(complaint([] { from_file("{\"port\": 1, \"port\": 2}"); }), "a.json has 'port' twice.");
  EXPECT_NE(complaint([] { from_file("{\"config\": \"b.json\"}"); }), "none") << "one file is enough";
  EXPECT_NE(complaint([] { from_file("{\"port\":\n1,}"); }).find("line 2"), std::string::npos);
  EXPECT_NE(complaint([] { from_file("[]"); }), "none");
  EXPECT_NE(complaint([] { from_file("{\"host\": null}"); }), "none");
  EXPECT_NE(complaint([] { from_file("{\"port\": [1]}"); }), "none");
  for (const char* size : {"", "k", "1kk", "-1", "nan", "1e30", "inf"})
    EXPECT_NE(complaint([&] { read({{"max-body", size}}); }), "none") << size;
  for (const char* number : {"", "1 ", "+1", "-1", "0x1", "1e3", "99999999999999999999"})
    EXPECT_NE(complaint([&] { read({{"port", number}}); }), "none") << number;
}

}  // namespace
}  // namespace terrane
