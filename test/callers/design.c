/* Designs a spur-gear pair with gearsweep: runs a case, reads its results by name, tries more relief on the same study,
   and leaves its files in designed/. legacy.f does the same and prints the same lines.

     cc design.c $(pkg-config --cflags --libs gearsweep) */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <gearsweep.h>

static char message[200];
#define M message, sizeof message

static void check(int info)
{
  if (info == GSC_OK) return;
  printf("info%2d: %s\n", info, message);
  exit(1);
}

/* The largest number of a column. */
static double largest(const gsc_study *study, const char *table, const char *column)
{
  int rows, kind, width, i;
  double *values, most;
  check(gsc_size(study, table, column, &rows, &kind, &width, M));
  if (!(values = malloc(sizeof *values * (size_t)(rows + 1)))) exit(1);
  check(gsc_column(study, table, column, rows, values, M));
  most = values[0];
  for (i = 1; i < rows; i++) if (values[i] > most) most = values[i];
  free(values);
  return most;
}

int main(void)
{
  char text[1000], again[2000], status[20], files[3000];
  size_t length;
  gsc_study *study = NULL, *relieved = NULL;
  double natural;

  /* The case, from the variables of this program. */
  snprintf(text, sizeof text,
           "&case tasks = 'mesh', 'sweep' / &pair module_mm = %.3f face_width_mm = %.3f / "
           "&pinion teeth = %d effective_mass_kg = 0.8 / &gear teeth = %d effective_mass_kg = 1.1 / "
           "&load normal_force_n = %.2f / &mesh model = 'fe' / &section elements_across = 6 / "
           "&sweep rpm_first = 2000 rpm_last = 16000 rpm_step = 500 /", 3.18, 25.4, 25, 31, 7010.0);
  check(gsc_run(text, strlen(text), NULL, 0, NULL, NULL, NULL, NULL, &study, M));
  check(gsc_column(study, "motion", "natural_frequency_hz", 1, &natural, M));
  check(gsc_words(study, "sweep", "status", 0, status, sizeof status, M));
  printf("natural frequency,%24.16E\n", natural);
  printf("largest dynamic factor,%24.16E\n", largest(study, "sweep", "dynamic_factor"));
  printf("first point,%s\n", status);

  /* Another relief: the stiffness is taken over from the first study. */
  check(gsc_edit("change", text, strlen(text), "relief", "amount_um", "20", again, sizeof again, &length, M));
  check(gsc_run(again, length, NULL, 0, study, NULL, NULL, NULL, &relieved, M));
  printf("largest dynamic factor,%24.16E\n", largest(relieved, "sweep", "dynamic_factor"));
  check(gsc_write(relieved, "designed", "pair", files, sizeof files, &length, M));
  fputs(files, stdout);
  gsc_free(&relieved);
  gsc_free(&study);
  return 0;
}
