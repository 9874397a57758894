/* Files as Fortran's own input and output cannot handle them: gfortran's run-time library drops the error of a
   disk that becomes full, and can neither open a file exclusively nor tell what kind of file it opens.

   Files that belong together are written whole into a folder of their own beside their place, and only then
   renamed, all under a lock on the folder. Nobody reads half a file or files of two writers.

   Nothing here keeps state or prints. What can fail gives 0, a descriptor or a count, or a negative code whose
   meaning gearsweep_reason tells. */
#define _POSIX_C_SOURCE 200809L /* strerror_r of POSIX */
#define _DEFAULT_SOURCE         /* flock */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { no_regular_file = 1 << 20, locked = no_regular_file + 1 };

/* The reason behind a negative code, as text that ends with its NUL. */
void gearsweep_reason(int code, char *words, size_t size)
{
  const char *own = code == -no_regular_file ? "it is no regular file" : "another program holds its lock";
  if (code == -no_regular_file || code == -locked)
    snprintf(words, size, "%s", own);
  else if (strerror_r(-code, words, size) != 0)
    snprintf(words, size, "error %d", -code);
}

/* Keeps 0 to 2 free where the caller has closed them: what someone prints must not end up in a table. */
static int above_standard(int file)
{
  if (file < 0 || file > 2) return file;
  int other = fcntl(file, F_DUPFD_CLOEXEC, 3), reason = errno;
  close(file);
  errno = reason;
  return other;
}

/* Opens a file for reading. Unless `stream`, it must be a regular file, and nothing is waited for. */
int gearsweep_open(const char *path, int stream)
{
  int file = above_standard(open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY | (stream ? 0 : O_NONBLOCK)));
  if (file < 0) return -errno;
  struct stat about;
  int code = fstat(file, &about) != 0 ? -errno : S_ISDIR(about.st_mode) ? -EISDIR
             : !stream && !S_ISREG(about.st_mode) ? -no_regular_file : 0;
  if (code == 0) return file;
  close(file);
  return code;
}

/* After an error: can the call be made again? A pipe that does not wait is waited for. */
static int again(int file, short event)
{
  struct pollfd wanted = {file, event, 0};
  if (errno == EAGAIN) return poll(&wanted, 1, -1) >= 0 || errno == EINTR;
  return errno == EINTR;
}

/* Reads at most `room` bytes, below 2**31; 0 at the end. Where `gearsweep_open` waits for nothing, this neither. */
int gearsweep_read(int file, char *to, int room)
{
  ssize_t n;
  do n = read(file, to, (size_t)room);
  while (n < 0 && errno == EINTR);
  return n < 0 ? -errno : (int)n;
}

void gearsweep_close(int file) { close(file); }

/* Writes all bytes. A limit of the size of files is an error like others, not the end of the process. */
static int put(int file, const char *text, int64_t length)
{
  sigset_t limit, before, pending;
  int code = 0, raised, old;
  sigemptyset(&limit);
  sigaddset(&limit, SIGXFSZ);
  pthread_sigmask(SIG_BLOCK, &limit, &before);
  sigpending(&pending);
  old = sigismember(&pending, SIGXFSZ);
  while (length > 0 && code == 0) {
    ssize_t n = write(file, text, length < 1 << 30 ? (size_t)length : 1u << 30);
    if (n < 0 && !again(file, POLLOUT)) code = -errno;
    if (n > 0) text += n, length -= n;
  }
  sigpending(&pending);
  if (!old && sigismember(&pending, SIGXFSZ)) sigwait(&limit, &raised);
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  return code;
}

/* Prints to the standard output, for programs. Where nobody reads any more, the rest is dropped. */
int gearsweep_print(const char *text, int64_t length)
{
  int code = put(STDOUT_FILENO, text, length);
  return code == -EPIPE ? 0 : code;
}

/* Makes a folder, unless it is there. 1: it was missing. Fails where something else is in the way. */
int gearsweep_make_folder(const char *path)
{
  if (mkdir(path, 0777) == 0) return 1;
  struct stat about;
  if (errno != EEXIST || stat(path, &about) != 0) return -errno;
  return S_ISDIR(about.st_mode) ? 0 : -ENOTDIR;
}

void gearsweep_remove_folder(const char *path) { rmdir(path); }

/* Removes all files in a folder. */
static void empty(int folder)
{
  int copy = openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  DIR *list = copy < 0 ? NULL : fdopendir(copy);
  if (!list) {
    if (copy >= 0) close(copy);
    return;
  }
  for (struct dirent *entry; (entry = readdir(list));)
    if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0) unlinkat(folder, entry->d_name, 0);
  closedir(list);
}

/* Takes the folder `name`, which nobody else may use: a new one, or what a killed process left, whose lock has
   gone with it. Gives its descriptor; 0 if it is somebody else's. */
static int take(int place, const char *name)
{
  int made = mkdirat(place, name, 0700) == 0;
  if (!made && errno != EEXIST) return -errno;
  int own = above_standard(openat(place, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  if (own < 0) {
    int reason = errno;
    if (made) unlinkat(place, name, AT_REMOVEDIR);
    return (made && reason != ENOENT) || reason == EMFILE || reason == ENFILE ? -reason : 0;
  }
  struct stat mine, there;
  int held = flock(own, LOCK_EX | LOCK_NB) == 0;
  /* Some file systems of networks know no locks: there, what is new is ours. */
  if (!held && errno != EWOULDBLOCK) held = made;
  if (held && fstat(own, &mine) == 0 && fstatat(place, name, &there, AT_SYMLINK_NOFOLLOW) == 0 &&
      mine.st_uid == geteuid() && mine.st_dev == there.st_dev && mine.st_ino == there.st_ino) {
    if (!made) empty(own);
    return own;
  }
  close(own);
  return 0;
}

/* Begins a set of files in the folder `path`: where[0] is the folder, where[1] the folder of the set's own, where[2]
   the number in its name. The lock of the own folder tells others that it is in use. */
int gearsweep_begin_set(const char *path, int where[3])
{
  enum { most = 1000 };
  char name[32];
  where[0] = above_standard(open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (where[0] < 0) return -errno;
  int own = 0;
  for (where[2] = 1; where[2] <= most; where[2]++) {
    snprintf(name, sizeof name, ".gearsweep-%d", where[2]);
    own = take(where[0], name);
    if (own != 0) break;
  }
  where[1] = own;
  if (own > 0) return 0;
  close(where[0]);
  return own == 0 ? -EEXIST : own;
}

/* Writes file number `i` of the set, not yet under its name; with `more`, at the end of what it has. */
int gearsweep_add_file(const int where[3], int i, const char *text, int64_t length, int more)
{
  char name[32];
  snprintf(name, sizeof name, "new-%d", i);
  int how = O_WRONLY | O_NOFOLLOW | O_CLOEXEC | (more ? O_APPEND : O_CREAT | O_EXCL);
  int file = above_standard(openat(where[1], name, how, 0666));
  if (file < 0) return -errno;
  int code = put(file, text, length);
  /* Network folders tell only here that they are full. */
  if (close(file) != 0 && code == 0 && errno != EINTR) code = -errno;
  return code;
}

/* Ends a set; what was not shown is gone. */
void gearsweep_end_set(const int where[3])
{
  char name[32];
  snprintf(name, sizeof name, ".gearsweep-%d", where[2]);
  empty(where[1]);
  unlinkat(where[0], name, AT_REMOVEDIR);
  close(where[1]);
  close(where[0]);
}

/* Waits for the lock on a folder, at most half a minute: it is held for a few renames. Without locks, as on some
   file systems of networks, nothing is waited for. */
static int lock(int folder)
{
  const struct timespec pause = {0, 10 * 1000 * 1000};
  for (int tries = 0; tries < 3000; tries++) {
    if (flock(folder, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return 0;
    nanosleep(&pause, NULL);
  }
  return -locked;
}

/* Keeps what now has this name as old-i. 1: there was something. */
static int keep(const int where[3], const char *name, int i)
{
  char old[32];
  struct stat about;
  snprintf(old, sizeof old, "old-%d", i);
  if (fstatat(where[0], name, &about, AT_SYMLINK_NOFOLLOW) != 0) return errno == ENOENT ? 0 : -errno;
  if (S_ISDIR(about.st_mode)) return -EISDIR;
  /* A second name, so that the first is never missing; not every file system has such. */
  if (linkat(where[0], name, where[1], old, 0) == 0) return 1;
  return renameat(where[0], name, where[1], old) == 0 ? 1 : -errno;
}

/* Puts back what had this name before; where nothing had, the new file goes. */
static void restore(const int where[3], const char *name, int i)
{
  char old[32];
  snprintf(old, sizeof old, "old-%d", i);
  if (renameat(where[1], old, where[0], name) != 0 && errno == ENOENT) unlinkat(where[0], name, 0);
}

/* Renames file number `i` of the set; where that fails, all is as before. */
static int show(const int where[3], const char *name, int i)
{
  char new[32];
  int kept = keep(where, name, i);
  if (kept < 0) return kept;
  snprintf(new, sizeof new, "new-%d", i);
  if (renameat(where[1], new, where[0], name) == 0) return 0;
  int code = -errno;
  if (kept) restore(where, name, i);
  return code;
}

/* Does the file begin with these words? */
static int begins_with(int folder, const char *name, const char *words)
{
  char start[256];
  size_t length = strlen(words);
  int file = openat(folder, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return 0;
  ssize_t n = length <= sizeof start ? read(file, start, length) : -1;
  close(file);
  return n == (ssize_t)length && memcmp(start, words, length) == 0;
}

/* Gives a file the name `name`.old in the folder of the set. */
static int set_aside(const int where[3], int folder, const char *file, const char *name)
{
  char old[300];
  if (snprintf(old, sizeof old, "%s.old", name) >= (int)sizeof old) return -ENAMETOOLONG;
  return renameat(folder, file, where[0], old) == 0 ? 0 : -errno;
}

/* What had the name of file number `i` before, unless it is of our kind: it is somebody's, and not lost. */
static int spare(const int where[3], const char *name, const char *words, int i)
{
  char old[32];
  struct stat about;
  snprintf(old, sizeof old, "old-%d", i);
  if (fstatat(where[1], old, &about, AT_SYMLINK_NOFOLLOW) != 0 || begins_with(where[1], old, words)) return 0;
  return set_aside(where, where[1], old, name);
}

/* The name behind this one and its words. */
static const char *next(const char *name)
{
  name += strlen(name) + 1;
  return name + strlen(name) + 1;
}

/* Shows the n files of a set under their names: all, or none and the folder is as it was. `names` has these names, and m
   that this set lacks; each with its NUL, and behind it the words, with theirs, that such a file begins with. A file of a
   name that the set lacks, if it does begin so, is of a set before and gets the ending .old; so does a file of a name
   that it has, if it does not. `failed` is the number of the file that could not be shown. */
int gearsweep_show_set(const int where[3], int n, int m, const char *names, int *failed)
{
  const char *name = names;
  int shown = 0, i, code = lock(where[0]);
  *failed = 1;
  if (code != 0) return code;
  for (i = 1; i <= n && code == 0; i++, name = next(name)) {
    *failed = i;
    code = show(where, name, i);
    if (code == 0) shown = i;
  }
  name = names;
  for (i = 1; i <= n && code == 0; i++, name = next(name)) {
    *failed = i;
    code = spare(where, name, name + strlen(name) + 1, i);
  }
  for (; m > 0 && code == 0; m--, name = next(name))
    if (begins_with(where[0], name, name + strlen(name) + 1)) set_aside(where, where[0], name, name);
  name = names;
  for (i = 1; i <= shown && code != 0; i++, name = next(name)) restore(where, name, i);
  flock(where[0], LOCK_UN);
  return code;
}

/* Removes a file if it begins with these words; no other, no link, and nothing is waited for. */
void gearsweep_drop_file(const char *path, const char *words)
{
  if (begins_with(AT_FDCWD, path, words)) unlink(path);
}
