/* A caller's flag that another thread or a signal may set while the library computes. */
void gearsweep_look(const int *flag, int *value)
{
  *value = flag ? __atomic_load_n(flag, __ATOMIC_RELAXED) : 0;
}
