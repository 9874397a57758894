/* Limits OpenBLAS to one thread during a call of the library: its own threads would compete with the caller's and
   change the bits of sums. The last thread to leave the library restores the caller's number. */
#include <pthread.h>

/* Weak: another BLAS has no such functions, and is not limited. */
extern void openblas_set_num_threads(int) __attribute__((weak));
extern int openblas_get_num_threads(void) __attribute__((weak));

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static int inside, before;

void gearsweep_hold_blas(void)
{
  if (!openblas_set_num_threads || !openblas_get_num_threads) return;
  pthread_mutex_lock(&lock);
  if (inside++ == 0) {
    before = openblas_get_num_threads();
    if (before != 1) openblas_set_num_threads(1);
  }
  pthread_mutex_unlock(&lock);
}

void gearsweep_release_blas(void)
{
  if (!openblas_set_num_threads || !openblas_get_num_threads) return;
  pthread_mutex_lock(&lock);
  if (--inside == 0 && before != 1) openblas_set_num_threads(before);
  pthread_mutex_unlock(&lock);
}
