/* A disk that fails on demand, for the files of one folder: loaded in front of the C library (LD_PRELOAD).
 *
 * Every call that opens for writing, reads, writes, truncates, syncs, links, renames or removes is counted; the call
 * number `at` (and for some kinds all after it) fails in the way `kind`. Syncs never reach the real disk. With a log, calls
 * that succeeded are written down, from which power_cut.py builds what a power cut would have left.
 */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

enum kind { NONE, EIO_ONCE, EIO_ON, ENOSPC_ONCE, FULL, SHORT, SHORT_THEN_FULL, HANG, KILL_BEFORE, KILL_AFTER, KILL_HALF,
            READ_ONLY };
enum call { OPEN = 1, WRITE, TRUNCATE, SYNC, LINK, RENAME, UNLINK, NOTE };

static char folder[4096];
static size_t folder_length;
static long at, count;
static int kind, log_file = -1, armed;
static char ours[4096]; /* by file descriptor */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

void fault_arm(const char *where, long number, int how, int log)
{
    snprintf(folder, sizeof folder, "%s/", where);
    folder_length = strlen(folder);
    at = number, kind = how, log_file = log, count = 0, armed = 1;
    memset(ours, 0, sizeof ours);
}

void fault_disarm(void) { armed = 0; }
long fault_count(void) { return count; }

static int within(const char *path)
{
    size_t n = strlen(path);
    return armed && (!strncmp(path, folder, folder_length) || (n + 1 == folder_length && !strncmp(path, folder, n)));
}
static int is_ours(int file) { return armed && file >= 0 && file < (int)sizeof ours && ours[file]; }

static void put(int call, int64_t a, int64_t b, const void *one, int64_t one_length, const void *two)
{
    if (log_file < 0)
        return;
    int64_t head[6] = {call, a, b, one_length, two ? (int64_t)strlen(two) : 0, count};
    syscall(SYS_write, log_file, head, sizeof head);
    syscall(SYS_write, log_file, one, one_length);
    if (two)
        syscall(SYS_write, log_file, two, strlen(two));
}

void fault_note(const char *text)
{
    pthread_mutex_lock(&lock);
    put(NOTE, 0, 0, text, strlen(text), NULL);
    pthread_mutex_unlock(&lock);
}

static void die(void) { raise(SIGKILL); }

/* Called with the lock, before a call: 0 to go on, else the error of the call. `growing`: it needs space. */
static int before(int growing)
{
    long number = ++count;
    if (kind == READ_ONLY)
        return EROFS;
    if (kind == NONE || number < at)
        return 0;
    if (kind == HANG) {
        pthread_mutex_unlock(&lock);
        if (syscall(SYS_gettid) == getpid())
            _exit(77); /* the main thread hangs before anything is promised: somebody ends the process */
        for (;;)
            pause();
    }
    if (kind == EIO_ON)
        return EIO;
    if ((kind == FULL || kind == SHORT_THEN_FULL) && growing && !(kind == SHORT_THEN_FULL && number == at))
        return ENOSPC;
    if (number != at)
        return 0;
    if (kind == KILL_BEFORE)
        die();
    return kind == EIO_ONCE ? EIO : kind == ENOSPC_ONCE ? ENOSPC : 0;
}

static int after(int result)
{
    if (kind == KILL_AFTER && count == at)
        die();
    pthread_mutex_unlock(&lock);
    return result;
}

static int failed(int error)
{
    pthread_mutex_unlock(&lock);
    errno = error;
    return -1;
}

int access(const char *path, int mode)
{
    if (kind == READ_ONLY && mode & W_OK && within(path)) {
        errno = EROFS;
        return -1;
    }
    return syscall(SYS_faccessat, AT_FDCWD, path, mode);
}

static int opened(const char *path, int flags, mode_t mode)
{
    int writing = (flags & O_ACCMODE) != O_RDONLY;
    int exists = access(path, F_OK) == 0;
    pthread_mutex_lock(&lock);
    int error = writing ? before(!exists) : 0;
    if (error)
        return failed(error);
    int file = syscall(SYS_openat, AT_FDCWD, path, flags, mode);
    if (file >= 0 && file < (int)sizeof ours)
        ours[file] = 1;
    if (file >= 0)
        put(OPEN, file, (exists ? 0 : 1) | (flags & O_TRUNC ? 2 : 0), path, strlen(path), NULL);
    if (writing)
        return after(file);
    pthread_mutex_unlock(&lock);
    return file;
}

#define OPENER(name)                                              \
    int name(const char *path, int flags, ...)                    \
    {                                                             \
        va_list rest;                                             \
        va_start(rest, flags);                                    \
        mode_t mode = flags & O_CREAT ? va_arg(rest, mode_t) : 0; \
        va_end(rest);                                             \
        if (within(path))                                         \
            return opened(path, flags, mode);                     \
        return syscall(SYS_openat, AT_FDCWD, path, flags, mode);  \
    }
OPENER(open)
OPENER(open64)

#define OPENER_AT(name)                                           \
    int name(int base, const char *path, int flags, ...)          \
    {                                                             \
        va_list rest;                                             \
        va_start(rest, flags);                                    \
        mode_t mode = flags & O_CREAT ? va_arg(rest, mode_t) : 0; \
        va_end(rest);                                             \
        if (within(path))                                         \
            return opened(path, flags, mode);                     \
        return syscall(SYS_openat, base, path, flags, mode);      \
    }
OPENER_AT(openat)
OPENER_AT(openat64)

int close(int file)
{
    if (file >= 0 && file < (int)sizeof ours)
        ours[file] = 0;
    return syscall(SYS_close, file);
}

static ssize_t written(int file, const void *data, size_t size, off_t offset)
{
    struct stat is;
    pthread_mutex_lock(&lock);
    fstat(file, &is);
    int error = before(offset + (off_t)size > is.st_size);
    if (error)
        return failed(error);
    int half = (kind == SHORT || kind == SHORT_THEN_FULL || kind == KILL_HALF) && count == at && size > 1;
    ssize_t result = syscall(SYS_pwrite64, file, data, half ? size / 2 : size, offset);
    if (result > 0)
        put(WRITE, file, offset, data, result, NULL);
    if (half && kind == KILL_HALF)
        die();
    return after(result);
}

ssize_t pwrite(int file, const void *data, size_t size, off_t offset)
{
    return is_ours(file) ? written(file, data, size, offset) : syscall(SYS_pwrite64, file, data, size, offset);
}
ssize_t pwrite64(int file, const void *data, size_t size, off64_t offset)
{
    return pwrite(file, data, size, offset);
}
ssize_t write(int file, const void *data, size_t size)
{
    if (!is_ours(file))
        return syscall(SYS_write, file, data, size);
    off_t offset = lseek(file, 0, SEEK_CUR);
    ssize_t result = written(file, data, size, offset);
    if (result > 0)
        lseek(file, offset + result, SEEK_SET);
    return result;
}

ssize_t pread(int file, void *data, size_t size, off_t offset)
{
    if (is_ours(file) && kind != READ_ONLY) {
        pthread_mutex_lock(&lock);
        int error = before(0);
        if (error == EIO)
            return failed(error);
        after(0);
    }
    return syscall(SYS_pread64, file, data, size, offset);
}
ssize_t pread64(int file, void *data, size_t size, off64_t offset) { return pread(file, data, size, offset); }

int ftruncate(int file, off_t size)
{
    if (!is_ours(file))
        return syscall(SYS_ftruncate, file, size);
    struct stat is;
    pthread_mutex_lock(&lock);
    fstat(file, &is);
    int error = before(size > is.st_size);
    if (error)
        return failed(error);
    int result = syscall(SYS_ftruncate, file, size);
    if (!result)
        put(TRUNCATE, file, size, "", 0, NULL);
    return after(result);
}
int ftruncate64(int file, off64_t size) { return ftruncate(file, size); }

static int synced(int file)
{
    pthread_mutex_lock(&lock);
    int error = before(0);
    put(SYNC, file, error, "", 0, NULL);
    if (error)
        return failed(error);
    return after(0);
}
int fsync(int file) { return is_ours(file) ? synced(file) : syscall(SYS_fsync, file); }
int fdatasync(int file) { return is_ours(file) ? synced(file) : syscall(SYS_fdatasync, file); }

static int renamed(int call, const char *from, const char *to)
{
    pthread_mutex_lock(&lock);
    int error = before(call == LINK);
    if (error)
        return failed(error);
    int result = call == LINK ? syscall(SYS_linkat, AT_FDCWD, from, AT_FDCWD, to, 0)
                              : syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0);
    if (!result)
        put(call, 0, 0, from, strlen(from), to);
    int saved = errno;
    after(0);
    errno = saved;
    return result;
}
int link(const char *from, const char *to)
{
    return within(to) ? renamed(LINK, from, to) : syscall(SYS_linkat, AT_FDCWD, from, AT_FDCWD, to, 0);
}
int linkat(int a, const char *from, int b, const char *to, int flags)
{
    return within(to) ? renamed(LINK, from, to) : syscall(SYS_linkat, a, from, b, to, flags);
}
int rename(const char *from, const char *to)
{
    return within(to) ? renamed(RENAME, from, to) : syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0);
}
int renameat(int a, const char *from, int b, const char *to)
{
    return within(to) ? renamed(RENAME, from, to) : syscall(SYS_renameat2, a, from, b, to, 0);
}

static int removed(const char *path)
{
    pthread_mutex_lock(&lock);
    int error = before(0);
    if (error)
        return failed(error);
    int result = syscall(SYS_unlinkat, AT_FDCWD, path, 0);
    int saved = errno;
    if (!result)
        put(UNLINK, 0, 0, path, strlen(path), NULL);
    after(0);
    errno = saved;
    return result;
}
int unlink(const char *path) { return within(path) ? removed(path) : syscall(SYS_unlinkat, AT_FDCWD, path, 0); }
int unlinkat(int base, const char *path, int flags)
{
    return within(path) && !(flags & AT_REMOVEDIR) ? removed(path) : syscall(SYS_unlinkat, base, path, flags);
}
