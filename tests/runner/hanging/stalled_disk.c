/* A disk that stops answering, for one process: LD_PRELOAD. From the first call HANG_CALL of HANG_THREAD (main, other)
 * on a path that matches the pattern HANG_PATH, every call on a path below HANG_ROOT sleeps in the kernel as if it
 * waited for that disk: in state D, where no signal interrupts it. A parent of vfork sleeps like that until its child
 * has ended, and this child never ends.
 * HANG_MARK is a file that appears when the first call hangs; HANG_LOG collects all calls below HANG_ROOT. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <fnmatch.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/syscall.h>
#include <unistd.h>

static atomic_int stalled;

static void sleep_in_the_kernel(void) {
    if (vfork() == 0) { /* shares the memory, so it must not touch it: system calls only */
        unsigned long all = ~0UL;
        syscall(SYS_rt_sigprocmask, SIG_BLOCK, &all, 0, 8);
        syscall(SYS_prctl, PR_SET_PDEATHSIG, SIGKILL, 0, 0, 0);
        syscall(SYS_close_range, 0, ~0U, 0);
        for (;;) syscall(SYS_pause);
    }
}

static void append(const char *file, const char *text) {
    int f = syscall(SYS_openat, AT_FDCWD, file, O_WRONLY | O_CREAT | O_APPEND, 0600);
    if (f >= 0) { syscall(SYS_write, f, text, strlen(text)); syscall(SYS_close, f); }
}

static void asked(const char *call, const char *path) {
    const char *root = getenv("HANG_ROOT"), *pattern = getenv("HANG_PATH"), *hang = getenv("HANG_CALL");
    const char *thread = syscall(SYS_gettid) == getpid() ? "main" : "other";
    if (!root || !path || strncmp(path, root, strlen(root))) return;
    if (getenv("HANG_LOG")) {
        char line[PATH_MAX + 64];
        snprintf(line, sizeof line, "%s\t%s\t%s\n", call, path, thread);
        append(getenv("HANG_LOG"), line);
    }
    if (hang && !strcmp(hang, call) && !strcmp(getenv("HANG_THREAD"), thread) && !fnmatch(pattern, path, 0) &&
        !atomic_exchange(&stalled, 1))
        append(getenv("HANG_MARK"), thread);
    if (stalled) sleep_in_the_kernel();
}

static void asked_at(const char *call, int folder, const char *path) {
    char whole[2 * PATH_MAX], link[64];
    if (path && *path != '/') {
        ssize_t n = -1;
        if (folder == AT_FDCWD) { if (getcwd(whole, PATH_MAX)) n = strlen(whole); }
        else { snprintf(link, sizeof link, "/proc/self/fd/%d", folder); n = readlink(link, whole, PATH_MAX); }
        if (n < 0) return;
        snprintf(whole + n, sizeof whole - n, *path ? "/%s" : "", path);
        path = whole;
    }
    asked(call, path);
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))
#define ON_FILE(type, name, declared, ...) \
    type name declared { asked_at(#name, file, ""); return REAL(name)(__VA_ARGS__); }
#define ON_PATH(type, name, declared, ...) \
    type name declared { asked_at(#name, AT_FDCWD, path); return REAL(name)(__VA_ARGS__); }
#define OPENING(name) \
    int name(const char *path, int flags, ...) { \
        va_list rest; va_start(rest, flags); mode_t mode = va_arg(rest, mode_t); va_end(rest); \
        asked_at("open", AT_FDCWD, path); return REAL(name)(path, flags, mode); }

OPENING(open)
OPENING(open64)
ON_FILE(int, fsync, (int file), file)
ON_FILE(int, fdatasync, (int file), file)
ON_FILE(int, ftruncate, (int file, off_t n), file, n)
ON_FILE(int, ftruncate64, (int file, off64_t n), file, n)
ON_FILE(int, flock, (int file, int how), file, how)
ON_FILE(int, posix_fallocate, (int file, off_t at, off_t n), file, at, n)
ON_FILE(int, posix_fallocate64, (int file, off64_t at, off64_t n), file, at, n)
ON_FILE(int, fstat, (int file, struct stat *s), file, s)
ON_FILE(int, fstat64, (int file, struct stat64 *s), file, s)
ON_FILE(int, close, (int file), file)
ON_FILE(ssize_t, read, (int file, void *b, size_t n), file, b, n)
ON_FILE(ssize_t, write, (int file, const void *b, size_t n), file, b, n)
ON_FILE(ssize_t, pread64, (int file, void *b, size_t n, off64_t at), file, b, n, at)
ON_FILE(ssize_t, pwrite64, (int file, const void *b, size_t n, off64_t at), file, b, n, at)
ON_FILE(ssize_t, pread, (int file, void *b, size_t n, off_t at), file, b, n, at)
ON_FILE(ssize_t, pwrite, (int file, const void *b, size_t n, off_t at), file, b, n, at)
ON_PATH(int, stat, (const char *path, struct stat *s), path, s)
ON_PATH(int, lstat, (const char *path, struct stat *s), path, s)
ON_PATH(int, stat64, (const char *path, struct stat64 *s), path, s)
ON_PATH(int, lstat64, (const char *path, struct stat64 *s), path, s)
ON_PATH(int, access, (const char *path, int how), path, how)
ON_PATH(int, mkdir, (const char *path, mode_t mode), path, mode)
ON_PATH(int, unlink, (const char *path), path)
ON_PATH(int, rename, (const char *path, const char *to), path, to)
ON_PATH(int, link, (const char *path, const char *to), path, to)
ON_PATH(int, statvfs, (const char *path, struct statvfs *s), path, s)
ON_PATH(int, statvfs64, (const char *path, struct statvfs64 *s), path, s)
ON_PATH(ssize_t, readlink, (const char *path, char *b, size_t n), path, b, n)
ON_PATH(void *, opendir, (const char *path), path)
int unlinkat(int folder, const char *path, int flags) {
    asked_at("unlink", folder, path);
    return REAL(unlinkat)(folder, path, flags);
}
int linkat(int from, const char *path, int to, const char *name, int flags) {
    asked_at("link", from, path);
    return REAL(linkat)(from, path, to, name, flags);
}
int fstatat(int folder, const char *path, struct stat *s, int flags) {
    asked_at("stat", folder, path);
    return REAL(fstatat)(folder, path, s, flags);
}
int fstatat64(int folder, const char *path, struct stat64 *s, int flags) {
    asked_at("stat", folder, path);
    return REAL(fstatat64)(folder, path, s, flags);
}
