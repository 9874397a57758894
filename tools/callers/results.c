/* Prints every number and word of every table that a case gives, a line each with its table and column, then the report; for
   run times their table and column alone, as they differ from run to run. Then it runs the case again, with another title,
   from the first study, prints the log, writes files into `written`, and runs
   two rows of values, of which the second is refused, as is a run from a file of an interrupted one. What results.f and
   results.py print, line by line.

     cc results.c $(pkg-config --cflags --libs gearsweep) */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <gearsweep.h>

static char text[40000], other[50000], message[200];
#define M message, sizeof message

static void check(int info)
{
  if (info == GSC_OK) return;
  printf("info%2d: %s\n", info, message);
  exit(1);
}

/* One of a study's texts, in room of its own. */
static char *text_of(const gsc_study *study, const char *what)
{
  size_t length;
  char *words;
  gsc_text(study, what, NULL, 0, &length, M);
  if (!(words = malloc(length + 1))) exit(1);
  check(gsc_text(study, what, words, length + 1, &length, M));
  return words;
}

/* In the width and with the exponent of Fortran. */
static void show(const char *table, const char *column, double value)
{
  char digits[40], *power;
  sprintf(digits, "%.16E", value);
  if ((power = strchr(digits, 'E'))) {
    int exponent = atoi(power + 1);
    sprintf(power, "E%c%03d", exponent < 0 ? '-' : '+', abs(exponent));
  }
  printf("%s.%s,%25s\n", table, column, isnan(value) ? "NaN" : digits);
}

static void show_column(const gsc_study *study, const char *table, const char *column, int reproducible)
{
  int rows, kind, width, row;
  if (!reproducible) { printf("%s.%s\n", table, column); return; }
  check(gsc_size(study, table, column, &rows, &kind, &width, M));
  if (kind == GSC_TEXT) {
    char *word = malloc((size_t)width + 1);
    for (row = 0; word && row < rows; row++) {
      check(gsc_words(study, table, column, row, word, (size_t)width + 1, M));
      printf("%s.%s,%s\n", table, column, word);
    }
    free(word);
  } else {
    double *values = malloc(sizeof *values * (size_t)(rows + 1));
    if (!values) exit(1);
    check(gsc_column(study, table, column, rows, values, M));
    for (row = 0; row < rows; row++) show(table, column, values[row]);
    free(values);
  }
}

int main(int count, char **argument)
{
  size_t n = fread(text, 1, sizeof text - 1, stdin), length;
  gsc_study *study = NULL, *again = NULL, *none = NULL;
  double values[] = {5, 0.25, -1, 0.25};
  char *list, *report, *line, table[64] = "", column[64];
  check(gsc_run(text, n, NULL, 2, NULL, NULL, NULL, NULL, &study, M));
  /* Each table and each column has a line of its own. */
  list = text_of(study, "tables");
  for (line = strtok(list, "\n"); line; line = strtok(NULL, "\n")) {
    if (sscanf(line, "{\"name\": \"%63[^\"]", table) != 1 && sscanf(line, "  {\"name\": \"%63[^\"]", column) == 1)
      show_column(study, table, column, strstr(line, "\"reproducible\": false") == NULL);
  }
  report = text_of(study, "report");
  fputs(report, stdout);
  free(report), free(list);
  check(gsc_edit("change", text, n, "case", "title", "'again'", other, sizeof other, &length, M));
  check(gsc_run(other, length, NULL, 1, study, NULL, NULL, NULL, &again, M));
  if (gsc_run(other, length, NULL, 1, study, NULL, "x", NULL, &none, M) != GSC_INPUT || none) exit(1);
  puts(message);
  fputs(report = text_of(again, "log"), stdout);
  check(gsc_write(again, "written", count > 1 ? argument[1] : "case", other, sizeof other, &length, M));
  fputs(other, stdout);
  free(report);
  gsc_free(&again);
  check(gsc_edit("change", text, n, "case", "tasks", "'mesh'", other, sizeof other, &length, M));
  if (gsc_rows(other, length, NULL, 1, study, NULL, "relief.amount_um dynamics.damping_ratio", 2, values,
               "motion.natural_frequency_hz", &again, M) != GSC_PARTIAL)
    exit(1);
  puts(message);
  check(gsc_words(again, "rows", "message", 1, other, sizeof other, M));
  puts(other);
  check(gsc_column(again, "motion", "natural_frequency_hz", 2, values, M));
  show("rows of motion", "natural_frequency_hz", values[0]);
  show("rows of motion", "natural_frequency_hz", values[1]);
  gsc_free(&again), gsc_free(&study);
  return study != NULL;
}
