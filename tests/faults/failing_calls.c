// SPDX-License-Identifier: GPL-3.0-or-later
// Preloaded into a tool: makes one of its system calls on the files of a trial fail, or sends a signal just before it.
//   FAULT_UNDER   only calls on files below this folder count
//   FAULT_CALLS   write: calls that change a file or a folder; name: those among them that give a file its name; read: open for reading, read
//   FAULT_AT      the number of the call, from 1; 0 for none
//   FAULT_ACTION  an error number; -N: signal N just before the call; short: half of the bytes; again: EINTR
//   FAULT_STICKY  1: every later call fails as well, as on a disk that stays full
//   FAULT_LOG     a file to which "calls bytes" is written at the end of the run
//   FAULT_CLOCK   seconds that are added to the clock; ~N: that are added and subtracted, in turn
//   FAULT_SPEED   how many times faster the clock of durations runs
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

enum { kShort = -1000, kAgain = -1001 };

static atomic_long calls, bytes;
static const char *under;
static long fault_at;
static int action, sticky, want_reads, want_names;

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

__attribute__((constructor)) static void start(void) {
  const char *kind = getenv("FAULT_CALLS"), *what = getenv("FAULT_ACTION"), *at = getenv("FAULT_AT");
  const char *stays = getenv("FAULT_STICKY");
  under = getenv("FAULT_UNDER");
  want_reads = kind && strcmp(kind, "read") == 0;
  want_names = kind && strcmp(kind, "name") == 0;
  fault_at = at ? atol(at) : 0;
  sticky = stays && *stays == '1';
  if (what) action = strcmp(what, "short") == 0 ? kShort : strcmp(what, "again") == 0 ? kAgain : atoi(what);
}

__attribute__((destructor)) static void finish(void) {
  const char *log = getenv("FAULT_LOG");
  if (calls == 0 && log && access(log, F_OK) == 0) return;  // a child that made the calls has written them
  FILE *file = log ? REAL(fopen64)(log, "w") : NULL;
  if (!file) return;
  fprintf(file, "%ld %ld\n", (long)calls, (long)bytes);
  REAL(fclose)(file);
}

static int is_ours(const char *path) { return under && path && strncmp(path, under, strlen(under)) == 0; }

static int is_our_descriptor(int fd) {
  char link[64], path[4096];
  snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t size = readlink(link, path, sizeof path - 1);
  if (size < 0) return 0;
  path[size] = 0;
  return is_ours(path);
}

// Returns 0 if the call is made, kShort if it is made with half of the bytes; otherwise errno is set and the call must fail.
static int hit(void) {
  const long number = ++calls;
  if (fault_at == 0 || !action || !(number == fault_at || (sticky && number > fault_at))) return 0;
  if (action == kShort) return kShort;
  if (action < 0 && action != kAgain) {
    if (number == fault_at) raise(-action);
    return 0;
  }
  errno = action == kAgain ? EINTR : action;
  return 1;
}

static int disturbed(int ours, int reads) { return ours && !want_names && reads == want_reads ? hit() : 0; }
static int naming_disturbed(int ours) { return ours && !want_reads && action != kShort ? hit() : 0; }

static size_t part(int fault, size_t size) { return fault == kShort && size > 1 ? size / 2 : size; }
static ssize_t counted(ssize_t done) {
  if (done > 0) bytes += done;
  return done;
}

#define TRANSFER(name, reads, parameters, early, call)           \
  ssize_t name parameters {                                      \
    const int ours = is_our_descriptor(fd);                      \
    const int fault = disturbed(ours, reads);                    \
    if (fault > 0) return early;                                 \
    size = part(fault, size);                                    \
    const ssize_t done = REAL(name) call;                        \
    return ours && reads == want_reads ? counted(done) : done;   \
  }
TRANSFER(write, 0, (int fd, const void *data, size_t size), -1, (fd, data, size))
TRANSFER(pwrite, 0, (int fd, const void *data, size_t size, off_t at), -1, (fd, data, size, at))
TRANSFER(pwrite64, 0, (int fd, const void *data, size_t size, off64_t at), -1, (fd, data, size, at))
TRANSFER(read, 1, (int fd, void *data, size_t size), -1, (fd, data, size))
TRANSFER(pread, 1, (int fd, void *data, size_t size, off_t at), -1, (fd, data, size, at))
TRANSFER(pread64, 1, (int fd, void *data, size_t size, off64_t at), -1, (fd, data, size, at))

// The fortified variants of read and pread call the plain ones.
ssize_t __read_chk(int fd, void *data, size_t size, size_t room) { return (void)room, read(fd, data, size); }
ssize_t __pread_chk(int fd, void *data, size_t size, off_t at, size_t room) { return (void)room, pread(fd, data, size, at); }
ssize_t __pread64_chk(int fd, void *data, size_t size, off64_t at, size_t room) { return (void)room, pread64(fd, data, size, at); }

#define VECTOR(name, reads)                                           \
  ssize_t name(int fd, const struct iovec *parts, int count) {        \
    const int ours = is_our_descriptor(fd);                           \
    const int fault = disturbed(ours, reads);                         \
    if (fault > 0) return -1;                                         \
    if (fault == kShort && count > 1) count = 1;                      \
    const ssize_t done = REAL(name)(fd, parts, count);                \
    return ours && reads == want_reads ? counted(done) : done;        \
  }
VECTOR(writev, 0)
VECTOR(readv, 1)

// Calls on a path or a descriptor as a whole.
#define PLAIN(name, parameters, ours, call)                        \
  int name parameters {                                            \
    const int fault = action == kShort ? 0 : disturbed(ours, 0);   \
    return fault > 0 ? -1 : REAL(name) call;                       \
  }
PLAIN(ftruncate, (int fd, off_t size), is_our_descriptor(fd), (fd, size))
PLAIN(ftruncate64, (int fd, off64_t size), is_our_descriptor(fd), (fd, size))
PLAIN(fsync, (int fd), is_our_descriptor(fd), (fd))
#define NAMING(name) \
  int name(const char *from, const char *to) { return naming_disturbed(is_ours(to)) > 0 ? -1 : REAL(name)(from, to); }
NAMING(link)
NAMING(rename)
PLAIN(mkdir, (const char *path, mode_t mode), is_ours(path), (path, mode))

static int is_writable(int fd) { return (fcntl(fd, F_GETFL) & O_ACCMODE) != O_RDONLY; }

// On Linux, a close that fails has closed the descriptor.
int close(int fd) {
  const int fault = action == kShort || action == kAgain ? 0 : disturbed(is_our_descriptor(fd) && is_writable(fd), 0);
  const int error = errno;
  const int result = REAL(close)(fd);
  if (fault <= 0) return result;
  errno = error;
  return -1;
}

static int open_fails(const char *path, int flags) {
  return action != kShort && disturbed(is_ours(path), (flags & O_ACCMODE) == O_RDONLY) > 0;
}
#define OPEN(name)                                                                \
  int name(const char *path, int flags, ...) {                                    \
    va_list rest;                                                                 \
    va_start(rest, flags);                                                        \
    const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, mode_t) : 0; \
    va_end(rest);                                                                 \
    return open_fails(path, flags) ? -1 : REAL(name)(path, flags, mode);          \
  }
OPEN(open)
OPEN(open64)

// C streams, whose internal system calls cannot be intercepted by a preloaded function.
#define FOPEN(name)                                                                                        \
  FILE *name(const char *path, const char *mode) {                                                         \
    return open_fails(path, strpbrk(mode, "wa+") ? O_RDWR : O_RDONLY) ? NULL : REAL(name)(path, mode);     \
  }
FOPEN(fopen)
FOPEN(fopen64)

size_t fwrite(const void *data, size_t size, size_t count, FILE *file) {
  const int ours = is_our_descriptor(fileno(file));
  if (action != kShort && action != kAgain && disturbed(ours, 0) > 0) return 0;
  const size_t done = REAL(fwrite)(data, size, count, file);
  if (ours && !want_reads) bytes += (long)(done * size);
  return done;
}
size_t fread(void *data, size_t size, size_t count, FILE *file) {
  const int ours = is_our_descriptor(fileno(file));
  if (action != kShort && action != kAgain && disturbed(ours, 1) > 0) return 0;
  const size_t done = REAL(fread)(data, size, count, file);
  if (ours && want_reads) bytes += (long)(done * size);
  return done;
}
int fflush(FILE *file) {
  if (file && action != kShort && action != kAgain &&
      disturbed(is_our_descriptor(fileno(file)) && is_writable(fileno(file)), 0) > 0)
    return EOF;
  return REAL(fflush)(file);
}
int fclose(FILE *file) {
  const int fault = action == kShort || action == kAgain
                        ? 0
                        : disturbed(is_our_descriptor(fileno(file)) && is_writable(fileno(file)), 0);
  const int error = errno;
  const int result = REAL(fclose)(file);
  if (fault <= 0) return result;
  errno = error;
  return EOF;
}

static time_t clock_error(void) {
  static atomic_int looks;
  const char *seconds = getenv("FAULT_CLOCK");
  if (!seconds) return 0;
  return *seconds != '~' ? atol(seconds) : atomic_fetch_add(&looks, 1) % 2 ? -atol(seconds + 1) : atol(seconds + 1);
}
int clock_gettime(clockid_t clock, struct timespec *now) {
  const int result = REAL(clock_gettime)(clock, now);
  if (clock == CLOCK_REALTIME) now->tv_sec += clock_error();
  const char *speed = getenv("FAULT_SPEED");
  if (speed && clock == CLOCK_MONOTONIC) {
    const long long time_ns = (now->tv_sec * 1000000000LL + now->tv_nsec) * atol(speed);
    now->tv_sec = time_ns / 1000000000;
    now->tv_nsec = time_ns % 1000000000;
  }
  return result;
}
int gettimeofday(struct timeval *restrict now, void *restrict zone) {
  const int result = REAL(gettimeofday)(now, zone);
  now->tv_sec += clock_error();
  return result;
}
time_t time(time_t *where) {
  const time_t now = REAL(time)(NULL) + clock_error();
  if (where) *where = now;
  return now;
}
