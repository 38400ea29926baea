// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <limits>
#include <set>
#include <sstream>
#include <thread>

#include "unit/server/job_stores.hpp"

// What a store of jobs does when processes are killed, disks are full, or what it finds is not its own.
namespace terrane {
namespace {

class StoreFaults : public Stores {};

INSTANTIATE_TEST_SUITE_P(JobStore, StoreFaults, testing::Values("sqlite", "postgresql"),
                         [](const auto& info) { return std::string(info.param); });

constexpr Instant far_away = std::numeric_limits<Instant>::max();

/// Adds, takes and finishes until it is killed, and says to a pipe what was acknowledged.
[[noreturn]] void work(JobStore& store, int round, int pipe) {
  const auto say = [&](char what, const std::string& id) {
    const std::string line = what + (' ' + id + '\n');
    if (write(pipe, line.data(), line.size()) != static_cast<ssize_t>(line.size())) _exit(1);
  };
  const std::string owner = "server " + std::to_string(round);
  for (int i = 0;; ++i) {
    const std::string id = std::to_string(round) + "-" + std::to_string(i);
    store.add(job(id, i, "key " + id));
    say('A', id);
    if (i % 3 == 0) continue;  // the line grows
    const std::string taken = store.take(owner, i)->id;
    say('T', taken);
    store.progress(taken, owner, 50, "half", i);
    if (i % 5 == 0) continue;  // it is never finished
    store.finish(taken, owner, JobStatus::successful, "done", {{"of", taken}}, i, far_away);
    say('F', taken);
  }
}

TEST_P(StoreFaults, AKillLosesNothingThatWasAcknowledged) {
  std::set<std::string> added, finished;
  std::size_t recovered = 0;
  for (int round = 0; round < 20; ++round) {
    int pipes[2];
    ASSERT_EQ(pipe2(pipes, O_CLOEXEC), 0);
    const pid_t child = fork();
    if (child == 0) {
      try {
        work(*open(), round, pipes[1]);
      } catch (...) {
        _exit(1);
      }
    }
    close(pipes[1]);
    std::thread killer([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(100 + 7 * round));
      kill(child, SIGKILL);
    });
    std::string text, taken;
    char block[4096];
    for (ssize_t n; (n = read(pipes[0], block, sizeof block)) > 0;) text.append(block, n);
    killer.join();
    close(pipes[0]);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the child failed by itself";
    std::istringstream lines(text);
    std::set<std::string> running;
    for (std::string what, id; lines >> what >> id;) {
      if (what == "A") added.insert(id);
      if (what == "T") running.insert(id);
      if (what == "F") finished.insert(id), running.erase(id);
    }
    const auto store = open();
    for (const std::string& id : running) {
      const auto found = store->find(id);
      ASSERT_TRUE(found) << id;
      EXPECT_TRUE(found->status == JobStatus::running || found->status == JobStatus::successful) << id;
    }
    for (const Job& job : store->recover("", far_away, 1000, "", {}, 1, 1)) {
      EXPECT_EQ(job.status, JobStatus::accepted);
      EXPECT_FALSE(finished.contains(job.id));
      ++recovered;
    }
  }
  const auto store = open();
  JobFilter all;
  all.limit = far_away;
  std::set<std::string> found, successful;
  for (const Job& job : store->list(all, 1).jobs) {
    found.insert(job.id);
    if (job.status != JobStatus::successful) continue;
    successful.insert(job.id);
    EXPECT_EQ(job.outcome["of"], job.id);
  }
  EXPECT_GT(finished.size(), 20u);
  EXPECT_GT(recovered, 0u);
  EXPECT_TRUE(std::includes(found.begin(), found.end(), added.begin(), added.end()));
  EXPECT_TRUE(std::includes(successful.begin(), successful.end(), finished.begin(), finished.end()));
  EXPECT_LE(found.size(), added.size() + 20);  // each round at most one that it had no time to say
  // A server that outlives the child may do what it was asked last after the recovery.
  if (is_sqlite()) {
    EXPECT_EQ(store->count()[1], 0u);
  }
}

/// Adds jobs until there is no room left; how many there was room for.
int fill(JobStore& store, const std::string& name) {
  Job next = job("");
  next.message = std::string(4000, 'x');
  for (int i = 0; i < 100'000; ++i) {
    next.id = name + std::to_string(i);
    std::string message;
    const std::string code = complaint([&] { store.add(next); }, &message);
    if (code.empty()) continue;
    EXPECT_EQ(code, "storage-full") << message;
    return i;
  }
  ADD_FAILURE() << "it is never full";
  return 0;
}

void expect_works(JobStore& store, int before) {
  for (int i = 0; i < before; ++i) EXPECT_TRUE(store.find("first " + std::to_string(i))) << i;
  EXPECT_EQ(store.list({}, 1).matched, static_cast<std::size_t>(before));
  EXPECT_FALSE(store.add(job("afterwards")));
  EXPECT_EQ(store.take("one", 1)->id, "first 0");
  EXPECT_TRUE(store.finish("first 0", "one", JobStatus::successful, "done", {}, 2, 3));
  store.remove("first 0");
  EXPECT_EQ(store.list({}, 1).matched, static_cast<std::size_t>(before));
}

/// A file system of two megabytes in which only our own processes take part.
class SmallDisk {
 public:
  explicit SmallDisk(const std::string& folder) : folder_(folder) {
    is_mounted_ = mount("none", folder.c_str(), "tmpfs", 0, "size=2m") == 0;
  }
  ~SmallDisk() {
    if (is_mounted_) umount2(folder_.c_str(), MNT_DETACH);
  }
  explicit operator bool() const { return is_mounted_; }

 private:
  const std::string folder_;
  bool is_mounted_ = false;
};

TEST_P(StoreFaults, AFullDiskIsSaidAndDoesNoHarm) {
  const auto folder = folder_.path / "small";
  std::filesystem::create_directory(folder);
  const SmallDisk disk(folder);
  if (!disk) GTEST_SKIP() << "a file system of our own may not be mounted here";
  const std::string ballast = folder / "ballast";
  const auto fill_up = [&] { std::ofstream(ballast) << std::string(1'000'000, 'x'); };
  std::string where = folder / "jobs.db";
  if (!is_sqlite()) {
    chmod(folder_.path.c_str(), 0755);
    server().give(folder);
    server().run("CREATE TABLESPACE small LOCATION '" + folder.string() + "'");
    where = server().uri() + "?options=-cdefault_tablespace%3Dsmall";
  }
  fill_up();
  {
    const auto store = open(where);
    const int before = fill(*store, "first ");
    EXPECT_GT(before, 10);
    EXPECT_TRUE(store->find("first 1"));  // who only looks is not troubled
    std::filesystem::remove(ballast);
    expect_works(*store, before);
  }
  EXPECT_TRUE(open(where)->find("afterwards"));
  if (!is_sqlite()) {
    server().run("DROP TABLE terrane_jobs");
    server().run("DROP TABLESPACE small");
  }
}

TEST(SqliteStore, AFileThatMayNotGrowIsFull) {
  const TemporaryFolder folder;
  const auto store = open_sqlite_store(folder.path / "jobs.db");
  rlimit limit;
  getrlimit(RLIMIT_FSIZE, &limit);
  const auto may_grow_to = [&](rlim_t bytes) {
    const rlimit changed{bytes, limit.rlim_max};
    setrlimit(RLIMIT_FSIZE, &changed);
  };
  const auto handler = signal(SIGXFSZ, SIG_IGN);
  may_grow_to(1'000'000);
  const int before = fill(*store, "first ");
  may_grow_to(limit.rlim_cur);
  signal(SIGXFSZ, handler);
  EXPECT_GT(before, 10);
  expect_works(*store, before);
}

TEST(SqliteStore, WithoutAFileItIsKeptInMemory) {
  const auto store = open_sqlite_store(""), other = open_sqlite_store("");
  store->add(job("a"));
  EXPECT_TRUE(store->find("a"));
  EXPECT_FALSE(other->find("a"));
}

TEST(SqliteStore, WhatItDoesNotKnowIsRefused) {
  const TemporaryFolder folder;
  const std::string file = folder.path / "jobs.db";
  open_sqlite_store(file)->add(job("a"));
  EXPECT_TRUE(open_sqlite_store(file)->find("a"));
  sqlite3* connection = nullptr;
  sqlite3_open(file.c_str(), &connection);
  sqlite3_exec(connection, "PRAGMA user_version = 7", nullptr, nullptr, nullptr);
  sqlite3_close(connection);
  std::string message;
  EXPECT_EQ(complaint([&] { open_sqlite_store(file); }, &message), "store-failed");
  EXPECT_NE(message.find("another Terrane (schema 7"), std::string::npos) << message;

  std::ofstream(folder.path / "letter") << std::string(10'000, 'x');
  EXPECT_EQ(complaint([&] { open_sqlite_store(folder.path / "letter"); }), "store-failed");
  EXPECT_EQ(complaint([&] { open_sqlite_store(folder.path / "no" / "jobs.db"); }), "store-failed");
}

TEST(SqliteStore, AFileOfAnEarlierVersionKeepsItsJobs) {
  const TemporaryFolder folder;
  const std::string file = folder.path / "jobs.db";
  open_sqlite_store(file)->add(job("a"));
  sqlite3* connection = nullptr;
  sqlite3_open(file.c_str(), &connection);
  EXPECT_EQ(sqlite3_exec(connection,
                         "DROP INDEX terrane_jobs_tell; ALTER TABLE terrane_jobs DROP COLUMN tell_at;"
                         "ALTER TABLE terrane_jobs DROP COLUMN tellings; PRAGMA user_version = 1",
                         nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(connection);
  const auto store = open_sqlite_store(file);
  EXPECT_TRUE(store->find("a"));
  EXPECT_TRUE(store->take("server", 5));
}

TEST_P(StoreFaults, ManyMayOpenItForTheFirstTimeAtOnce) {
  for (int round = 0; round < 5; ++round) {
    if (!is_sqlite()) server().run("DROP TABLE IF EXISTS terrane_jobs");
    const std::string where = is_sqlite() ? (folder_.path / std::to_string(round)).string() : place();
    std::vector<std::thread> openers;
    for (int i = 0; i < 4; ++i) {
      openers.emplace_back([&, i] {
        std::string message;
        EXPECT_EQ(complaint([&] { open(where)->add(job(std::to_string(i))); }, &message), "") << message;
      });
    }
    for (auto& opener : openers) opener.join();
    EXPECT_EQ(open(where)->list({}, 1).matched, 4u);
  }
}

}  // namespace
}  // namespace terrane
