// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/worker/sandbox.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <functional>
#include <thread>

#include "unit/server/postgresql_server.hpp"

namespace terrane {
namespace {

namespace fs = std::filesystem;

/// What is said by a process that did `what`, confined to a folder or not; "" is best.
std::string said_by(const fs::path* folder, const std::function<std::string()>& what) {
  int ends[2];
  if (pipe(ends) != 0) return "no pipe";
  const pid_t child = fork();
  if (child == 0) {
    std::string said;
    try {
      if (folder) confine(*folder, {std::uint64_t{8} << 30, 60, 1 << 20});
      said = what();
    } catch (const std::exception& exception) {
      said = exception.what();
    }
    _exit(write(ends[1], said.data(), said.size()) == static_cast<ssize_t>(said.size()) ? 0 : 1);
  }
  close(ends[1]);
  std::string said;
  char block[4096];
  for (ssize_t n; (n = read(ends[0], block, sizeof block)) > 0;) said.append(block, n);
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return status == 0 ? said : said + " (and ended with status " + std::to_string(status) + ")";
}

/// The error of a call with nonsense in every argument, which does no harm where it is not refused.
int error_of(int call) {
  const pid_t me = getpid();
  errno = 0;
  const long result = syscall(call, -1L, -1L, -1L, -1L, -1L, -1L);
  if (getpid() != me) _exit(0);  // a fork takes no arguments
  return result < 0 ? errno : 0;
}

std::string name_of(int call) {
  char* const name = seccomp_syscall_resolve_num_arch(SCMP_ARCH_NATIVE, call);
  const std::string text = name ? name : std::to_string(call);
  free(name);
  return text;
}

class Sandbox : public testing::Test {
 protected:
  Sandbox() { fs::create_directory(folder_.path / "out"); }
  std::string confined(const std::function<std::string()>& what) { return said_by(&folder_.path, what); }

  TemporaryFolder folder_;
};

TEST_F(Sandbox, EveryCallOfTheListIsRefused) {
  EXPECT_GT(refused_calls().size(), 40u);
  EXPECT_EQ(confined([] {
              std::string allowed;
              for (const int call : refused_calls())
                if (error_of(call) != EPERM) allowed += name_of(call) + " ";
              return allowed;
            }),
            "");
}

TEST_F(Sandbox, WithoutItMostOfThemAreNot) {
  const std::string refused = said_by(nullptr, [] {
    std::string refused;
    for (const int call : refused_calls())
      // A vfork would return on our stack, a queue of messages would stay.
      if (call != SCMP_SYS(vfork) && call != SCMP_SYS(msgget) && error_of(call) == EPERM) refused += 'x';
    return refused;
  });
  EXPECT_LT(refused.size(), refused_calls().size() / 2) << "else the other test shows little";
}

TEST_F(Sandbox, SomeCallsAreRefusedForWhatTheyAsk) {
  EXPECT_EQ(confined([]() -> std::string {
              std::string allowed;
              const auto expect = [&](const char* what, long result, int error) {
                if (result != -1 || errno != error) allowed += std::string(what) + " ";
              };
              rlimit none{};
              expect("clone", syscall(SYS_clone, SIGCHLD, 0, 0, 0, 0), EPERM);
              expect("clone3", syscall(SYS_clone3, nullptr, 0), ENOSYS);
              expect("tgkill", syscall(SYS_tgkill, getppid(), getppid(), 0), EPERM);
              expect("prlimit", prlimit(getppid(), RLIMIT_CORE, nullptr, &none), EPERM);
              expect("F_SETFL", fcntl(0, F_SETFL, 0), EPERM);
              expect("F_SETOWN", fcntl(0, F_SETOWN, getpid()), EPERM);
              expect("F_SETSIG", fcntl(0, F_SETSIG, SIGKILL), EPERM);
              expect("F_SETOWN_EX", syscall(SYS_fcntl, 0, F_SETOWN_EX, nullptr), EPERM);
              return allowed;
            }),
            "");
}

TEST_F(Sandbox, ItsWorkIsAllowed) {
  EXPECT_EQ(confined([this]() -> std::string {
              int sum = 0;
              std::thread([&] { sum = 1; }).join();
              if (sum != 1) return "no thread";
              const int file = open((folder_.path / "out" / "result").c_str(), O_CREAT | O_RDWR, 0600);
              if (file < 0 || write(file, "x", 1) != 1) return std::strerror(errno);
              if (open("/proc/self/status", O_RDONLY) < 0) return "not even itself";
              rlimit most{};
              getrlimit(RLIMIT_FSIZE, &most);
              return most.rlim_max == 1 << 20 ? "" : "files may be large";
            }),
            "");
}

TEST_F(Sandbox, OtherFilesAreOutOfReach) {
  if (!can_confine_files()) GTEST_SKIP() << "this kernel confines nobody to folders";
  const TemporaryFolder other;
  const fs::path secret = other.path / "secret", own = folder_.path / "body";
  for (const fs::path& path : {secret, own}) close(open(path.c_str(), O_CREAT | O_WRONLY, 0666));
  ASSERT_EQ(said_by(nullptr, [&] { return std::string(open(secret.c_str(), O_RDWR) < 0 ? "no" : ""); }), "");
  EXPECT_EQ(confined([&]() -> std::string {
              std::string allowed;
              const auto expect = [&](const std::string& what, long result) {
                if (result >= 0 || (errno != EACCES && errno != EXDEV && errno != EPERM)) allowed += what + " ";
              };
              for (const std::string& path : {secret.string(), std::string("/etc/passwd"), std::string("/proc/1/maps"),
                                              (folder_.path / ".." / other.path.filename() / "secret").string()})
                expect(path, open(path.c_str(), O_RDONLY));
              expect("list", open(other.path.c_str(), O_RDONLY | O_DIRECTORY));
              expect("write its order", open(own.c_str(), O_WRONLY));
              expect("make beside", open((folder_.path / "new").c_str(), O_CREAT | O_WRONLY, 0600));
              expect("make elsewhere", open((other.path / "new").c_str(), O_CREAT | O_WRONLY, 0600));
              expect("remove", unlink(secret.c_str()));
              expect("rename", rename(own.c_str(), (folder_.path / "out" / "body").c_str()));
              expect("link", link(secret.c_str(), (folder_.path / "out" / "secret").c_str()));
              expect("symlink", symlink(secret.c_str(), (folder_.path / "out" / "way").c_str()));
              expect("fifo", mkfifo((folder_.path / "out" / "fifo").c_str(), 0600));
              return allowed;
            }),
            "");
}

}  // namespace
}  // namespace terrane
