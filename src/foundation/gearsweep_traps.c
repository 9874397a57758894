/* Hosts may have floating-point exceptions end the process (feenableexcept,
   -ffpe-trap). Inside a call an overflow is a value that is found and told, so
   the host's floating-point environment is set aside until the call ends. */
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

/* The environment that this thread has set aside; none outside a call. */
const void *gearsweep_leader_traps(void)
{
  return depth > 0 ? &host : NULL;
}

/* For the other threads of a parallel region, which libgomp keeps from one region to the
   next: as in the call that leads the region, and as its host has it again. */
void gearsweep_share_traps(const void *leader, int inside)
{
  fenv_t aside;
  if (!leader || depth > 0) return;
  if (inside) feholdexcept(&aside);
  else fesetenv(leader);
}
