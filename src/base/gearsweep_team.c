/* Number of threads that a parallel region may have. libgomp ends the process if it cannot start a thread, so
   threads are tried first. */
#define _GNU_SOURCE
#include <ctype.h>
#include <pthread.h>
#include <stdlib.h>

enum { most = 1024 };
/* Smallest stack of a thread: several times what the library's procedures need. */
static const double least_stack = 256*1024.0;
/* Memory of a thread in addition to its stack: address space that the C library reserves while it aligns the thread's
   heap, and memory to solve operating points. */
static const double heap = 132*1024.0*1024.0;

double gearsweep_left(void);  /* gearsweep_memory.c */

/* Number of threads in the last region that this thread led: libgomp keeps them. */
static _Thread_local int kept = 1;

/* Stack size (bytes) in OMP_STACKSIZE, read as by libgomp: kilobytes, or with a unit B, K, M or G. */
static double stack_in(const char *text)
{
  char *end;
  double size;
  if (!text) return 0;
  size = strtod(text, &end);
  while (isspace((unsigned char)*end)) end++;
  switch (tolower((unsigned char)*end)) {
    case 'b': return size;
    case 'm': return 1024*1024*size;
    case 'g': return 1024*1024*1024*size;
    default: return 1024*size;
  }
}

static double stack_size(void)
{
  pthread_attr_t attributes;
  size_t usual = 0;
  double size = stack_in(getenv("OMP_STACKSIZE"));
  if (!(size > 0)) size = stack_in(getenv("GOMP_STACKSIZE"));
  if (size > 0) return size;
  pthread_attr_init(&attributes);
  pthread_attr_getstacksize(&attributes, &usual);
  pthread_attr_destroy(&attributes);
  return (double)usual;
}

static void *wait_for(void *gate)
{
  pthread_mutex_lock(gate);
  pthread_mutex_unlock(gate);
  return 0;
}

/* Number of threads, at most `wanted`, that can be started at the same time. */
static int startable(int wanted, double stack)
{
  pthread_t thread[most];
  pthread_attr_t attributes;
  pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
  int i, n = 0;
  pthread_attr_init(&attributes);
  if (pthread_attr_setstacksize(&attributes, (size_t)stack) == 0) {
    pthread_mutex_lock(&gate);
    while (n < wanted && pthread_create(&thread[n], &attributes, wait_for, &gate) == 0) n++;
    pthread_mutex_unlock(&gate);
  }
  for (i = 0; i < n; i++) pthread_join(thread[i], 0);
  pthread_attr_destroy(&attributes);
  return n;
}

/* Number of threads that can be started, at most `wanted`, at least the caller's own. */
int gearsweep_team(int wanted)
{
  double stack, left;
  if (wanted > most) wanted = most;
  if (wanted <= 1) return 1;
  if (wanted > kept) {
    stack = stack_size();
    if (stack < least_stack) return 1;
    left = gearsweep_left();
    if (left < wanted*(stack + heap)) wanted = 1 + (int)(left/(stack + heap));
    wanted = wanted > 1 ? 1 + startable(wanted - 1, stack) : 1;
  }
  if (wanted > 1) kept = wanted;
  return wanted;
}
