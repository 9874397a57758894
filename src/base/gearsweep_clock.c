/* Processor time of the calling thread: unlike elapsed time, other work on the machine hardly changes it. */
#define _POSIX_C_SOURCE 200809L
#include <time.h>

double gearsweep_thread_seconds(void)
{
  struct timespec now;

  if (clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now) != 0) return 0;
  return (double)now.tv_sec + 1e-9*(double)now.tv_nsec;
}
