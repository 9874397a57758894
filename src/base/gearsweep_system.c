/* Files beyond Fortran's own input and output: gfortran's run-time library drops the error of a disk that becomes full,
   and can neither open a file exclusively nor find the kind of a file that it opens.

   Files that belong together are written completely into a separate folder next to their place, and only then
   renamed, all under a lock on the folder. Nobody reads half a file or files of two writers.

   These functions keep no state and print nothing. A function that can fail returns 0, a descriptor or a count, or a
   negative code, whose meaning gearsweep_reason returns. */
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
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { no_regular_file = 1 << 20, locked = no_regular_file + 1 };

/* Reason of a negative code, as text that ends with NUL. */
void gearsweep_reason(int code, char *words, size_t size)
{
  const char *own = code == -no_regular_file ? "it is no regular file" : "another program holds its lock";
  if (code == -no_regular_file || code == -locked)
    snprintf(words, size, "%s", own);
  else if (strerror_r(-code, words, size) != 0)
    snprintf(words, size, "error %d", -code);
}

/* Keeps descriptors 0 to 2 free if the caller has closed them: printed text must not end up in a table. */
static int above_standard(int file)
{
  if (file < 0 || file > 2) return file;
  int other = fcntl(file, F_DUPFD_CLOEXEC, 3), reason = errno;
  close(file);
  errno = reason;
  return other;
}

/* Opens a file for reading. Without `stream`, it must be a regular file, and the call does not block. */
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

/* True if a failed call can be repeated. Waits for a pipe that does not block. */
static int again(int file, short event)
{
  struct pollfd wanted = {file, event, 0};
  if (errno == EAGAIN) return poll(&wanted, 1, -1) >= 0 || errno == EINTR;
  return errno == EINTR;
}

/* Reads at most `room` bytes, below 2**31; 0 at the end. It blocks only if `gearsweep_open` may. */
int gearsweep_read(int file, char *to, int room)
{
  ssize_t n;
  do n = read(file, to, (size_t)room);
  while (n < 0 && errno == EINTR);
  return n < 0 ? -errno : (int)n;
}

void gearsweep_close(int file) { close(file); }

/* Writes all bytes. A limit on the size of files is an error like others, and does not end the process. */
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

/* Prints to the standard output, for programs. If nobody reads any more, the remainder is dropped. */
int gearsweep_print(const char *text, int64_t length)
{
  int code = put(STDOUT_FILENO, text, length);
  return code == -EPIPE ? 0 : code;
}

/* Removes the last `depth` folders of a path, from the last on, as far as they are empty. */
void gearsweep_remove_folder(const char *path, int depth)
{
  char *part = strdup(path);
  if (!part) return;
  size_t end = strlen(part);
  while (depth > 0 && end > 0) {
    while (end > 1 && part[end - 1] == '/') end--;
    part[end] = 0;
    /* A part that could not be made does not exist. */
    if (rmdir(part) == 0) depth--;
    else if (errno != ENOENT && errno != ENOTDIR) break;
    while (end > 0 && part[end - 1] != '/') end--;
  }
  free(part);
}

/* Makes a folder and its missing parents. Returns how many were missing, or -errno after removing those it made. Fails
   if a file has the name of a folder. */
int gearsweep_make_folder(const char *path)
{
  char *part = strdup(path);
  if (!part) return -ENOMEM;
  int made = 0, code = 0;
  for (char *end = part; code == 0 && *end;) {
    end += strspn(end, "/");
    end += strcspn(end, "/");
    char after = *end;
    *end = 0;
    struct stat about;
    if (mkdir(part, 0777) == 0) {
      made++;
    } else {
      code = -errno;
      if (stat(part, &about) == 0) code = S_ISDIR(about.st_mode) ? 0 : -ENOTDIR;
    }
    *end = after;
  }
  free(part);
  if (code < 0) gearsweep_remove_folder(path, made);
  return code < 0 ? code : made;
}

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

/* Makes or reuses the folder `name` for this process alone: a new one, or that of a killed process, whose lock ended
   with it. Returns its descriptor; 0 if another process uses it. */
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
  /* Some network file systems have no locks: there, a new folder is ours. */
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

/* Writes file number `i` of the set under a temporary name. */
int gearsweep_add_file(const int where[3], int i, const char *text, int64_t length)
{
  char name[32];
  snprintf(name, sizeof name, "new-%d", i);
  int file = above_standard(openat(where[1], name, O_WRONLY | O_NOFOLLOW | O_CLOEXEC | O_CREAT | O_EXCL, 0666));
  if (file < 0) return -errno;
  int code = put(file, text, length);
  /* Network folders report only here that they are full. */
  if (close(file) != 0 && code == 0 && errno != EINTR) code = -errno;
  return code;
}

/* Closes the set and deletes files that were not published. */
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
   network file systems, it does not wait. */
static int lock(int folder)
{
  const struct timespec pause = {0, 10 * 1000 * 1000};
  for (int tries = 0; tries < 3000; tries++) {
    if (flock(folder, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return 0;
    nanosleep(&pause, NULL);
  }
  return -locked;
}

/* Keeps the present file of this name as old-i. Returns 1 if there was one. */
static int keep(const int where[3], const char *name, int i)
{
  char old[32];
  struct stat about;
  snprintf(old, sizeof old, "old-%d", i);
  if (fstatat(where[0], name, &about, AT_SYMLINK_NOFOLLOW) != 0) return errno == ENOENT ? 0 : -errno;
  if (S_ISDIR(about.st_mode)) return -EISDIR;
  /* A second name, so that the first is never missing; not every file system allows it. */
  if (linkat(where[0], name, where[1], old, 0) == 0) return 1;
  return renameat(where[0], name, where[1], old) == 0 ? 1 : -errno;
}

/* Restores the previous file of this name; if there was none, removes the new file. */
static void restore(const int where[3], const char *name, int i)
{
  char old[32];
  snprintf(old, sizeof old, "old-%d", i);
  if (renameat(where[1], old, where[0], name) != 0 && errno == ENOENT) unlinkat(where[0], name, 0);
}

/* Renames file number `i` of the set; after a failure, all is as before. */
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

/* True if the file begins with these words. */
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

/* Renames a file to `name`.old in the folder of the set. */
static int set_aside(const int where[3], int folder, const char *file, const char *name)
{
  char old[300];
  if (snprintf(old, sizeof old, "%s.old", name) >= (int)sizeof old) return -ENAMETOOLONG;
  return renameat(folder, file, where[0], old) == 0 ? 0 : -errno;
}

/* Renames the previous file with the name of file number `i` to .old unless it is of our kind: a user's file must not be
   lost. */
static int spare(const int where[3], const char *name, const char *words, int i)
{
  char old[32];
  struct stat about;
  snprintf(old, sizeof old, "old-%d", i);
  if (fstatat(where[1], old, &about, AT_SYMLINK_NOFOLLOW) != 0 || begins_with(where[1], old, words)) return 0;
  return set_aside(where, where[1], old, name);
}

/* Next name, after this one and its words. */
static const char *next(const char *name)
{
  name += strlen(name) + 1;
  return name + strlen(name) + 1;
}

/* Publishes the n files of a set under their names: all of them, or none, with the folder unchanged. `names` has these
   names, and m names that are not in this set; each ends with NUL, followed by the first words of such a file, also
   with NUL. A file with a name not in the set that begins with its words belongs to an earlier set and is renamed to
   .old; so is a file with a name of the set that does not begin with its words. `failed` is the number of the file
   that could not be published. */
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
