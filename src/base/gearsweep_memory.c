/* Checks whether the memory that a stage needs is available, before it is allocated: hundreds of allocations follow,
   of which none could be refused with a message. Checked are the limits on address space and data of the process
   (ulimit -v, -d) and, for large claims, the memory of the machine and of the control groups. On systems other than
   Linux only the results of getrlimit and /proc count.

   Each thread's latest claim counts for the others until it is released, so that simultaneous calls do not use the
   same memory. If the process has a limit, one thread at a time computes with BLAS: OpenBLAS allocates a buffer for
   each simultaneous thread, and has no option for a single one. */
#define _GNU_SOURCE
#include <ctype.h>
#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

/* Reserve (bytes) for small allocations: growth of the stack, messages, buffers of files, gaps in the heap. */
static const double reserve = 32*1024.0*1024.0;
/* Claims below this (bytes) always fit into the reserve. */
static const double small = 64*1024.0;
/* Claims below this (bytes) do not check the machine's memory, which takes about 50 us: it has this much. */
static const double large = 64*1024.0*1024.0;
/* First buffer of OpenBLAS (bytes): if it is not available at the first product, OpenBLAS tries forever. */
static const double blas_buffer = 129*1024.0*1024.0;

extern void dtrsm_(const char *side, const char *uplo, const char *trans, const char *diag, const int *m, const int *n,
                   const double *alpha, const double *a, const int *lda, double *b, const int *ldb,
                   size_t, size_t, size_t, size_t);

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static pthread_mutex_t turn = PTHREAD_MUTEX_INITIALIZER;
static double promised;                 /* latest claims of all threads */
static int has_buffer;                  /* OpenBLAS has its first buffer */
static _Thread_local double mine;
static _Thread_local int has_turn;

static long read_file(const char *path, char *text, size_t size)
{
  int file = open(path, O_RDONLY | O_CLOEXEC);
  long length;
  if (file < 0) return -1;
  length = read(file, text, size - 1);
  close(file);
  text[length < 0 ? 0 : length] = 0;
  return length;
}

/* Number after `name` in a text, or `otherwise`. */
static double number_behind(const char *text, const char *name, double otherwise)
{
  const char *at = strstr(text, name);
  return at ? strtod(at + strlen(name), 0) : otherwise;
}

static int is_unlimited(void)
{
  struct rlimit space, data;
  return getrlimit(RLIMIT_AS, &space) != 0 || getrlimit(RLIMIT_DATA, &data) != 0 ||
         (space.rlim_cur == RLIM_INFINITY && data.rlim_cur == RLIM_INFINITY);
}

/* Memory available within the limits of the process, in bytes. */
static double left_by_limits(void)
{
  struct rlimit space, data;
  double left = HUGE_VAL, total = 0, private = 0, page = (double)sysconf(_SC_PAGESIZE);
  char text[256];
  if (is_unlimited() || getrlimit(RLIMIT_AS, &space) != 0 || getrlimit(RLIMIT_DATA, &data) != 0) return left;
  if (read_file("/proc/self/statm", text, sizeof text) < 0) return left;
  sscanf(text, "%lf %*s %*s %*s %*s %lf", &total, &private);
  if (space.rlim_cur != RLIM_INFINITY) left = (double)space.rlim_cur - page*total;
  if (data.rlim_cur != RLIM_INFINITY) left = fmin(left, (double)data.rlim_cur - page*private);
  return left;
}

/* Memory available in one control group, in bytes; file pages count as free. */
static double left_by_group(const char *folder, const char *most, const char *now)
{
  char path[4400], text[4096];
  double limit, used;
  snprintf(path, sizeof path, "%s/%s", folder, most);
  if (read_file(path, text, sizeof text) <= 0 || !isdigit((unsigned char)text[0])) return HUGE_VAL;
  limit = strtod(text, 0);
  snprintf(path, sizeof path, "%s/%s", folder, now);
  if (read_file(path, text, sizeof text) <= 0) return HUGE_VAL;
  used = strtod(text, 0);
  snprintf(path, sizeof path, "%s/memory.stat", folder);
  if (read_file(path, text, sizeof text) > 0)
    used -= number_behind(text, "\ninactive_file ", 0) + number_behind(text, "\nactive_file ", 0);
  return limit - used;
}

/* Smallest memory available in the group of this process and its parents, in bytes. */
static double left_by_groups(void)
{
  char text[4096], folder[4200], *line, *path, *end;
  double left = HUGE_VAL;
  int first;
  size_t root;
  if (read_file("/proc/self/cgroup", text, sizeof text) <= 0) return left;
  first = (line = strstr(text, ":memory:")) != 0;
  if (!first && !(line = strstr(text, "0::"))) return left;
  path = strchr(line, '/');
  if (!path) return left;
  if ((end = strchr(path, '\n'))) *end = 0;
  root = (size_t)snprintf(folder, sizeof folder, first ? "/sys/fs/cgroup/memory" : "/sys/fs/cgroup");
  snprintf(folder + root, sizeof folder - root, "%s", path);
  for (;;) {
    left = fmin(left, first ? left_by_group(folder, "memory.limit_in_bytes", "memory.usage_in_bytes")
                            : left_by_group(folder, "memory.max", "memory.current"));
    if (strlen(folder) <= root) return left;
    *strrchr(folder, '/') = 0;
  }
}

/* Memory available on the machine, in bytes, also with its limit on committed memory. */
static double left_by_machine(void)
{
  char text[4096], mode[8];
  double left;
  if (read_file("/proc/meminfo", text, sizeof text) <= 0) return HUGE_VAL;
  left = 1024*(number_behind(text, "MemAvailable:", HUGE_VAL) + number_behind(text, "SwapFree:", 0));
  if (read_file("/proc/sys/vm/overcommit_memory", mode, sizeof mode) > 0 && mode[0] == '2')
    left = fmin(left, 1024*(number_behind(text, "CommitLimit:", HUGE_VAL) - number_behind(text, "Committed_AS:", 0)));
  return fmin(left, left_by_groups());
}

/* Memory available for a claim of this thread, in bytes. */
double gearsweep_left(void)
{
  double left;
  pthread_mutex_lock(&lock);
  left = left_by_limits() - (promised - mine) - reserve;
  pthread_mutex_unlock(&lock);
  return left;
}

/* Computes the smallest possible product, after which OpenBLAS has a buffer, even after this claim. */
static void take_buffer(void)
{
  const int one = 1;
  const double factor = 1, matrix = 1;
  double vector = 1;
  dtrsm_("L", "L", "N", "N", &one, &one, &factor, &matrix, &one, &vector, &one, 1, 1, 1, 1);
}

/* Claims `bytes` of address space, `used` of them to be written to; `blas`: products follow. If `lacks` is 1, only
   `left` bytes of the `need` are available, and nothing is claimed. */
void gearsweep_claim(double bytes, double used, int blas, int *lacks, double *need, double *left)
{
  double others;
  *need = *left = *lacks = 0;
  if (!blas && ((bytes > 0 && bytes < small) || (used < large && is_unlimited()))) return;
  pthread_mutex_lock(&lock);
  if (blas && !has_buffer) bytes += blas_buffer;
  others = promised - mine + reserve;
  *left = left_by_limits() - others;
  *lacks = bytes > *left;
  *need = bytes;
  if (!*lacks && used >= large) {
    *left = left_by_machine() - others;
    *lacks = used > *left;
    if (*lacks) *need = used;
  }
  if (!*lacks) {
    promised += bytes - mine;
    mine = bytes;
    if (blas && !has_buffer) {
      take_buffer();
      has_buffer = 1;
    }
  }
  *left = fmax(0, *left);
  pthread_mutex_unlock(&lock);
}

/* Ends this thread's claim: its memory is allocated, or no longer needed. */
void gearsweep_release_claim(void)
{
  if (!(mine > 0)) return;
  pthread_mutex_lock(&lock);
  promised -= mine;
  mine = 0;
  pthread_mutex_unlock(&lock);
}

/* Prepares calls of BLAS and LAPACK, which end with gearsweep_end_products; not nested. */
void gearsweep_begin_products(void)
{
  if (is_unlimited()) return;
  pthread_mutex_lock(&turn);
  has_turn = 1;
}

void gearsweep_end_products(void)
{
  if (!has_turn) return;
  has_turn = 0;
  pthread_mutex_unlock(&turn);
}
