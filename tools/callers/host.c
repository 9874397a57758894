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

#define M message, sizeof message
enum { longest = 200000 };
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

/* Every number of every table, as the caller's own threads would read them. */
static void read_all(const gsc_study *study)
{
  static const char *const place[][2] = {{"mesh", "load_share"}, {"sweep", "dynamic_factor"}, {"sweep", "status"},
    {"modal", "frequency_hz"}, {"mode_shapes", "x"}, {"root_stress", "sigma_mpa"}, {"load", "pair_load_n"}};
  for (size_t i = 0; i < sizeof place / sizeof *place; i++) {
    int rows, kind, width;
    double *values;
    if (gsc_size(study, place[i][0], place[i][1], &rows, &kind, &width, M)) continue;
    if (kind == GSC_TEXT) note("words", gsc_words(study, place[i][0], place[i][1], 0, words, sizeof words, M));
    else if ((values = malloc(sizeof *values * (size_t)rows))) {
      note("column", gsc_column(study, place[i][0], place[i][1], rows, values, M));
      free(values);
    }
  }
}

static void *call_all(void *name)
{
  static const char *const changes[][3] = {{"relief", "amount_um", "3"}, {"dynamics", "damping_ratio", "0.1"}};
  size_t n = strlen(text), length;
  gsc_study *study = NULL, *later;
  int info;
  note("version", gsc_version(words, sizeof words, M));
  note("complete", gsc_edit("complete", text, n, NULL, NULL, NULL, words, sizeof words, &length, M));
  note("unused", gsc_edit("unused", text, n, NULL, NULL, NULL, words, sizeof words, &length, M));
  note("tasks", gsc_describe("tasks", words, sizeof words, &length, M));
  info = gsc_run(text, n, "", 2, NULL, NULL, NULL, NULL, &study, M);
  note("run", info);
  if (study) {
    read_all(study);
    note("report", gsc_text(study, "report", words, sizeof words, &length, M));
    note("tables", gsc_text(study, "tables", words, sizeof words, &length, M));
    note("write", gsc_write(study, "host.out", name, words, sizeof words, &length, M));
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
      later = NULL;
      info = gsc_edit("change", text, n, changes[i][0], changes[i][1], changes[i][2], words, sizeof words, &length, M);
      note("change", info);
      if (info == GSC_OK) note("again", gsc_run(words, length, "", 2, study, NULL, NULL, NULL, &later, M));
      gsc_free(&later);
    }
  }
  gsc_free(&study);
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
