/* A host that must live on whatever the library is asked: for each case named it makes many calls, with
   floating-point traps on where the first argument is `traps`, by four threads at once where it is `threads`.
   Prints each call's code, and message where it is not 0; ends with 1 where a call changes the traps, the
   exceptions noted or the rounding. */
#define _GNU_SOURCE
#include <fenv.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <gearsweep.h>

enum { speeds = 3, keep = 20, room = 50, longest = 200000 };
static const int all = FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW;
static char text[longest];
static _Thread_local char words[longest], message[300];
static int traps, noted, bad;

static void note(const char *name, int info)
{
  printf("%s: %d %s\n", name, info, info ? message : "");
  if (fegetexcept() == traps && fetestexcept(FE_ALL_EXCEPT) == noted && fegetround() == FE_TONEAREST) return;
  printf("%s: left the floating-point environment changed\n", name);
  bad = 1;
}

static void *call_all(void *name)
{
  static const char *folder = "";
  size_t n = strlen(text), length;
  int size[10], info, changes, status[room], sense[room], more[room], periods[room], pair[2*room], other[2*room];
  double rpm[speeds] = {2000, 5000, 9000}, damping[2] = {0.01, 0.2}, a[room], b[room], c[room], d[room], e[room];
  double x[speeds*keep], v[speeds*keep], *work;
#define M message, sizeof message
  note("complete", gsc_complete(text, n, words, sizeof words, &length, M));
  note("unused", gsc_unused(text, n, words, sizeof words, &length, M));
  note("change", gsc_change(text, n, "pair", "module_mm", "2.5", words, sizeof words, &length, M));
  note("report", gsc_report(text, n, folder, 0, NULL, 2, words, sizeof words, &length, M));
  note("write", gsc_files(text, n, folder, 0, NULL, 2, "host.out", name, words, sizeof words, &length, NULL, 0,
                          NULL, 0, M));
  info = gsc_sizes(text, n, folder, size, size + 1, size + 2, size + 3, size + 4, size + 5, size + 6, size + 7, size + 8,
                   size + 9, M);
  note("sizes", info);
  if (info || size[9] <= 0 || !(work = malloc(sizeof *work * (size_t)size[9]))) return 0;
  info = gsc_prepare(text, n, folder, size[9], work, M);
  note("prepare", info);
  if (!info) {
    note("stability", gsc_stability(text, n, size[9], work, speeds, rpm, 2, damping, 2, a, sense, b, c, d, M));
    note("follow", gsc_follow(text, n, size[9], work, 1, speeds, rpm, 0.02, 1e-6, room, &changes, x, v, pair, other, a, b,
                              status, sense, c, more, d, e, M));
    note("strobe", gsc_strobe(text, n, size[9], work, 1, speeds, rpm, 0.0/1.0, 0.0, 50, keep, x, v, a, status, periods, M));
  }
  free(work);
  return 0;
}

static void call_at_once(void)
{
  static char name[4][6] = {"one", "two", "three", "four"};
  pthread_t thread[4];
  int i, n = 0;
  while (n < 4 && pthread_create(&thread[n], NULL, call_all, name[n]) == 0) n++;
  for (i = 0; i < n; i++) pthread_join(thread[i], NULL);
}

int main(int count, char **argument)
{
  int i = 1, at_once = 0;
  setvbuf(stdout, NULL, _IOLBF, 0);
  if (count > 1 && strcmp(argument[1], "traps") == 0) {
    i = 2;
    feclearexcept(FE_ALL_EXCEPT);
    feenableexcept(all);
  }
  if (count > 1 && strcmp(argument[1], "threads") == 0) at_once = i++;
  traps = fegetexcept();
  noted = fetestexcept(FE_ALL_EXCEPT);
  for (; i < count; i++) {
    FILE *file = fopen(argument[i], "r");
    if (!file) return 2;
    text[fread(text, 1, longest - 1, file)] = 0;
    fclose(file);
    printf("%s\n", argument[i]);
    if (at_once) call_at_once();
    else call_all("case");
  }
  return bad;
}
