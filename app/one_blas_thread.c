/* Under a limit on address space OpenBLAS's own threads, which the program has no
   use for, cannot get their buffers: they try for ever or end the process as the
   library is loaded. So the program begins anew with one, before any library
   begins: a constructor would be too late, and what setenv does there is lost. */
#ifdef __linux__
#include <alloca.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

static void keep_one_blas_thread(int count, char **arguments, char **environment)
{
  static char one[] = "OPENBLAS_NUM_THREADS=1";
  struct rlimit space, data;
  char **with;
  int n;
  (void)count;
  if (getrlimit(RLIMIT_AS, &space) != 0 || getrlimit(RLIMIT_DATA, &data) != 0) return;
  if (space.rlim_cur == RLIM_INFINITY && data.rlim_cur == RLIM_INFINITY) return;
  for (n = 0; environment[n]; n++)
    if (strncmp(environment[n], one, strcspn(one, "1")) == 0) return;
  with = alloca((size_t)(n + 2)*sizeof *with);
  memcpy(with + 1, environment, (size_t)(n + 1)*sizeof *with);
  with[0] = one;
  execve("/proc/self/exe", arguments, with);
}

__attribute__((section(".preinit_array"), used)) static void (*before_libraries)(int, char **, char **) = keep_one_blas_thread;
#endif
