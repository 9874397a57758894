/* Disables floating-point traps during a call. Hosts may have exceptions end the process (feenableexcept, -ffpe-trap);
   inside a call an overflow is a value that is detected and reported, so the host's floating-point environment is
   saved at the start of the call and restored at its end. */
#include <fenv.h>
#include <stddef.h>

static _Thread_local fenv_t host;
static _Thread_local int depth;

void gearsweep_set_traps_aside(void)
{
  if (depth++ == 0) feholdexcept(&host);
}

void gearsweep_bring_traps_back(void)
{
  if (--depth == 0) fesetenv(&host);
}

/* Environment that this thread has saved; null outside a call. */
const void *gearsweep_leader_traps(void)
{
  return depth > 0 ? &host : NULL;
}

/* Disables traps in the other threads of a parallel region, and restores the host's environment at its end, as libgomp
   keeps these threads from one region to the next. */
void gearsweep_share_traps(const void *leader, int inside)
{
  fenv_t aside;
  if (!leader || depth > 0) return;
  if (inside) feholdexcept(&aside);
  else fesetenv(leader);
}
