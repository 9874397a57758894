/* How many threads a parallel region may have. libgomp ends the process where it
   cannot start one, so they are tried first. */
#define _GNU_SOURCE
#include <ctype.h>
#include <pthread.h>
#include <stdlib.h>

enum { most = 1024 };
/* What the library's procedures need, several times. */
static const double least_stack = 256*1024.0;
/* Beside its stack: address space that the C library sets aside for a thread's heap while it
   aligns it, and what a thread needs to solve operating points. */
static const double heap = 132*1024.0*1024.0;

double gearsweep_left(void);  /* gearsweep_memory.c */

/* Threads of the last region that this thread led: libgomp keeps them. */
static _Thread_local int kept = 1;

/* OMP_STACKSIZE as libgomp reads it: kilobytes, or with a unit B, K, M or G. */
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

/* How many threads of `wanted` can be there at once. */
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

/* Of `wanted` threads those that there can be; at least the caller's own. */
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
