// SPDX-License-Identifier: GPL-3.0-or-later
// Preloaded into a process: from the NO_SPACE_FROM-th call that would put something on a disk, NO_SPACE_CALLS of them fail
// as on a full one. NO_SPACE_IN: the second word of the command line of the processes that are meant, such as "serve".
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

static atomic_long calls;
static long from = -1, until = -1;

__attribute__((constructor)) static void begin(void) {
  const char *where = getenv("NO_SPACE_IN"), *first = getenv("NO_SPACE_FROM"), *count = getenv("NO_SPACE_CALLS");
  if (!where || !first || !count) return;
  char line[4096];
  const int file = open("/proc/self/cmdline", O_RDONLY);
  const ssize_t n = file < 0 ? -1 : read(file, line, sizeof line - 1);
  if (file >= 0) close(file);
  if (n <= 0) return;
  line[n] = 0;
  const char* second = line + strlen(line) + 1;
  if (second >= line + n || strcmp(second, where) != 0) return;
  from = atol(first), until = from + atol(count);
}

static int fails(void) {
  if (from < 0) return 0;
  const long now = ++calls;
  if (now < from || now >= until) return 0;
  errno = ENOSPC;
  return 1;
}

static int on_disk(int file) {
  struct stat status;
  const int before = errno;
  const int regular = fstat(file, &status) == 0 && S_ISREG(status.st_mode);
  errno = before;
  return regular;
}

#define REAL(name) static __typeof__(name)* real; if (!real) real = (__typeof__(name)*)dlsym(RTLD_NEXT, #name)

ssize_t write(int file, const void* bytes, size_t size) {
  REAL(write);
  return from >= 0 && on_disk(file) && fails() ? -1 : real(file, bytes, size);
}
ssize_t pwrite(int file, const void* bytes, size_t size, off_t at) {
  REAL(pwrite);
  return fails() ? -1 : real(file, bytes, size, at);
}
ssize_t pwrite64(int file, const void* bytes, size_t size, off64_t at) {
  REAL(pwrite64);
  return fails() ? -1 : real(file, bytes, size, at);
}
int fsync(int file) {
  REAL(fsync);
  return fails() ? -1 : real(file);
}
int fdatasync(int file) {
  REAL(fdatasync);
  return fails() ? -1 : real(file);
}
int ftruncate64(int file, off64_t size) {
  REAL(ftruncate64);
  return fails() ? -1 : real(file, size);
}
int rename(const char* a, const char* b) {
  REAL(rename);
  return fails() ? -1 : real(a, b);
}
int link(const char* a, const char* b) {
  REAL(link);
  return fails() ? -1 : real(a, b);
}
int mkdir(const char* path, mode_t mode) {
  REAL(mkdir);
  return fails() ? -1 : real(path, mode);
}
int posix_fallocate64(int file, off64_t at, off64_t size) {
  REAL(posix_fallocate64);
  return fails() ? ENOSPC : real(file, at, size);
}
