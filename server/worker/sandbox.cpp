// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/worker/sandbox.hpp"

#include <fcntl.h>
#include <grp.h>
#include <linux/landlock.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "core/error.hpp"

namespace terrane {

namespace {

[[noreturn]] void fail(const std::string& what) {
  throw Error(ErrorKind::internal, "sandbox-failed", what + ": " + std::strerror(errno));
}

void limit(int resource, std::uint64_t most) {
  rlimit now;
  if (getrlimit(static_cast<__rlimit_resource>(resource), &now) != 0) fail("getrlimit");
  const rlimit wanted{std::min<rlim_t>(most, now.rlim_max), std::min<rlim_t>(most, now.rlim_max)};
  if (setrlimit(static_cast<__rlimit_resource>(resource), &wanted) != 0) fail("setrlimit");
}

constexpr std::uint64_t reading = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
constexpr std::uint64_t writing = LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_FILE |
                                  LANDLOCK_ACCESS_FS_REMOVE_DIR | LANDLOCK_ACCESS_FS_MAKE_REG |
                                  LANDLOCK_ACCESS_FS_MAKE_DIR;
// All that the first version knows, so that links, devices and programs are refused everywhere.
constexpr std::uint64_t handled = reading | writing | LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_MAKE_CHAR |
                                  LANDLOCK_ACCESS_FS_MAKE_SOCK | LANDLOCK_ACCESS_FS_MAKE_FIFO |
                                  LANDLOCK_ACCESS_FS_MAKE_BLOCK | LANDLOCK_ACCESS_FS_MAKE_SYM;

/// A folder or file that is not there need not be allowed.
void allow(int rules, const std::string& path, std::uint64_t access) {
  const int place = open(path.c_str(), O_PATH | O_CLOEXEC);
  if (place < 0) return;
  landlock_path_beneath_attr rule{};
  rule.allowed_access = access;
  rule.parent_fd = place;
  const long error = syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &rule, 0);
  close(place);
  if (error) fail("landlock_add_rule " + path);
}

void confine_files(const std::filesystem::path& folder) {
  landlock_ruleset_attr attributes{};
  attributes.handled_access_fs = handled;
  const int rules = static_cast<int>(syscall(SYS_landlock_create_ruleset, &attributes, sizeof attributes, 0));
  if (rules < 0) fail("landlock_create_ruleset");
  for (const char* path : {"/usr", "/lib", "/lib64", "/opt"})
    allow(rules, path, reading | LANDLOCK_ACCESS_FS_EXECUTE);  // libraries are mapped to be executed
  for (const char* path : {"/etc/ld.so.cache", "/etc/localtime"}) allow(rules, path, LANDLOCK_ACCESS_FS_READ_FILE);
  // The number of cores and what memory there is, read by libraries.
  for (const char* path : {"/proc/self", "/sys/devices/system/cpu"}) allow(rules, path, reading);
  for (const char* path : {"/proc/meminfo", "/proc/cpuinfo"}) allow(rules, path, LANDLOCK_ACCESS_FS_READ_FILE);
  for (const char* path : {"/dev/null", "/dev/urandom"}) allow(rules, path, LANDLOCK_ACCESS_FS_READ_FILE);
  for (const char* name : {"PROJ_LIB", "PROJ_DATA", "GDAL_DATA"})
    if (const char* path = std::getenv(name)) allow(rules, path, reading);
  // What lies in the folder may be the very file of another job; only what comes out is ours.
  allow(rules, folder.string(), reading);
  allow(rules, (folder / "out").string(), reading | writing);
  const long error = syscall(SYS_landlock_restrict_self, rules, 0);
  close(rules);
  if (error) fail("landlock_restrict_self");
}

constexpr int refused[] = {
    SCMP_SYS(socket), SCMP_SYS(socketpair), SCMP_SYS(connect), SCMP_SYS(bind), SCMP_SYS(listen), SCMP_SYS(accept),
    SCMP_SYS(accept4), SCMP_SYS(execve), SCMP_SYS(execveat), SCMP_SYS(fork), SCMP_SYS(vfork), SCMP_SYS(ptrace),
    SCMP_SYS(process_vm_readv), SCMP_SYS(process_vm_writev), SCMP_SYS(kill), SCMP_SYS(tkill), SCMP_SYS(pidfd_open),
    SCMP_SYS(pidfd_getfd), SCMP_SYS(pidfd_send_signal), SCMP_SYS(mount), SCMP_SYS(umount2), SCMP_SYS(chroot),
    SCMP_SYS(pivot_root), SCMP_SYS(unshare), SCMP_SYS(setns), SCMP_SYS(keyctl), SCMP_SYS(add_key),
    SCMP_SYS(request_key), SCMP_SYS(bpf), SCMP_SYS(perf_event_open), SCMP_SYS(userfaultfd), SCMP_SYS(io_uring_setup),
    SCMP_SYS(open_by_handle_at), SCMP_SYS(memfd_create), SCMP_SYS(truncate), SCMP_SYS(chmod), SCMP_SYS(fchmod),
    SCMP_SYS(fchmodat), SCMP_SYS(chown), SCMP_SYS(fchown), SCMP_SYS(lchown), SCMP_SYS(fchownat), SCMP_SYS(setxattr),
    SCMP_SYS(lsetxattr), SCMP_SYS(fsetxattr), SCMP_SYS(removexattr), SCMP_SYS(lremovexattr), SCMP_SYS(fremovexattr),
    SCMP_SYS(rt_sigqueueinfo), SCMP_SYS(rt_tgsigqueueinfo),
    // What outlives a worker, or reaches others of its user.
    SCMP_SYS(shmget), SCMP_SYS(shmat), SCMP_SYS(msgget), SCMP_SYS(semget), SCMP_SYS(mq_open), SCMP_SYS(setpriority),
    SCMP_SYS(ioprio_set), SCMP_SYS(migrate_pages), SCMP_SYS(move_pages), SCMP_SYS(process_madvise), SCMP_SYS(kcmp),
    SCMP_SYS(open_tree), SCMP_SYS(move_mount), SCMP_SYS(fsopen), SCMP_SYS(fspick), SCMP_SYS(mount_setattr)};

void confine_calls() {
  const scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
  if (!filter) fail("seccomp_init");
  const auto add = [&](std::uint32_t action, int call, std::vector<scmp_arg_cmp> conditions) {
    if (seccomp_rule_add_array(filter, action, call, static_cast<unsigned>(conditions.size()), conditions.data()) == 0)
      return;
    seccomp_release(filter);
    fail("seccomp_rule_add");
  };
  for (const int call : refused) add(SCMP_ACT_ERRNO(EPERM), call, {});
  // Threads, but no processes; signals and limits of our own alone; and the leash stays on.
  add(SCMP_ACT_ERRNO(EPERM), SCMP_SYS(clone), {SCMP_A0(SCMP_CMP_MASKED_EQ, CLONE_THREAD, 0)});
  add(SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), {});  // its flags cannot be seen; libraries then use clone
  add(SCMP_ACT_ERRNO(EPERM), SCMP_SYS(tgkill), {SCMP_A0(SCMP_CMP_NE, static_cast<scmp_datum_t>(getpid()))});
  add(SCMP_ACT_ERRNO(EPERM), SCMP_SYS(prlimit64), {SCMP_A0(SCMP_CMP_NE, 0)});
  for (const int command : {F_SETFL, F_SETOWN, F_SETSIG, F_SETOWN_EX})
    add(SCMP_ACT_ERRNO(EPERM), SCMP_SYS(fcntl), {SCMP_A1(SCMP_CMP_EQ, static_cast<scmp_datum_t>(command))});
  const int error = seccomp_load(filter);
  seccomp_release(filter);
  if (error) errno = -error, fail("seccomp_load");
}

}  // namespace

void give_up_root() {
  if (geteuid() != 0) return;
  if (setgroups(0, nullptr) != 0 || setresgid(worker_user, worker_user, worker_user) != 0 ||
      setresuid(worker_user, worker_user, worker_user) != 0)
    fail("becoming nobody");
}

std::span<const int> refused_calls() { return refused; }

bool can_confine_files() {
  return syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION) >= 1;
}

void confine(const std::filesystem::path& folder, const WorkerLimits& limits) {
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) fail("no new privileges");
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_NOFILE, 256);
  limit(RLIMIT_AS, limits.memory);
  limit(RLIMIT_CPU, limits.cpu_seconds);
  limit(RLIMIT_FSIZE, limits.file_bytes);
  if (can_confine_files()) confine_files(folder);
  confine_calls();
}

}  // namespace terrane
