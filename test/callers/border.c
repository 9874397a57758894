/* The border of the C functions: what they refuse, what they leave alone, and that any number of
   threads may call at once. Prints each check as `passed NAME` or `failed NAME`, what fails besides with its
   message, and `end`. */
#define _XOPEN_SOURCE 700
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <gearsweep.h>

static int failed;
static char message[300];
#define M message, sizeof message

static void check(const char *what, int holds)
{
  printf("%s %s\n", holds ? "passed" : "failed", what);
  if (holds) return;
  failed++;
  printf("FAILED: %s (message: %s)\n", what, message);
}

/* The call is refused with this code, and the message has this text. */
static void refused(const char *what, int info, int code, const char *text)
{
  check(what, info == code && strstr(message, text) != NULL);
  message[0] = '?', message[1] = 0;
}

static const char geared[] =
  "&case tasks = 'mesh', 'sweep', 'optimum', 'modal', 'static', 'load' / &pair module_mm = 3 face_width_mm = 20 /"
  "&pinion teeth = 21 effective_mass_kg = 0.5 / &gear teeth = 34 effective_mass_kg = 0.9 /"
  "&load normal_force_n = 4000 / &relief amount_um = 0, 10 / &mesh model = 'fe' /"
  "&section elements_across = 4 / &modal modes = 3 / &static positions = 5 /"
  "&sweep rpm_first = 3000 rpm_last = 9000 rpm_step = 1500 load_rpm = 4000 /";
static const char other[] =
  "&case tasks = 'sweep', 'modal' / &pair module_mm = 3 face_width_mm = 20 /"
  "&pinion teeth = 22 effective_mass_kg = 0.5 / &gear teeth = 34 effective_mass_kg = 0.9 /"
  "&load normal_force_n = 4000 / &relief amount_um = 0, 10 / &mesh model = 'fe' /"
  "&section elements_across = 5 / &modal modes = 3 /"
  "&sweep rpm_first = 3000 rpm_last = 9000 rpm_step = 1500 direction = 'each' /";
static const char prescribed[] =
  "&case tasks = 'sweep' / &pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.9 /"
  "&load normal_force_n = 6858 / &mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400, 0, -120 /"
  "&numerics steps_per_period = 20 / &sweep rpm_first = 1 rpm_last = 6001 rpm_step = 1000 /";
static const char idle[] =
  "&case tasks = 'geometry' / &pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 / &gear teeth = 34 /"
  "&modal modes = 3 /";

enum { MOST = 4000 };

typedef struct {
  int speeds, reliefs, rows, tried, positions, modes, nodes, elements, harmonics, nwork, info[8];
  double work[MOST], rpm[20], relief[4], factor[80], estimate[80];
  double modulus[80], motion_residual[80];
  int status[80], contact[80], steps[80], periods[80];
  double frequency[20], error[20], residual[20], rim[20];
  size_t length;
  char answer[8000];
} result_t;

/* Sizes, stiffness, sweep, modes and report of a case, and a refusal. */
static void run(const char *text, int threads, int reuse, result_t *r)
{
  char words[100];
  size_t n = strlen(text);
  memset(r, 0, sizeof *r);
  r->info[0] = gsc_sizes(text, n, NULL, &r->speeds, &r->reliefs, &r->rows, &r->tried, &r->positions, &r->modes,
                         &r->nodes, &r->elements, &r->harmonics, &r->nwork, words, sizeof words);
  r->info[1] = gsc_prepare(text, n, NULL, r->nwork, r->work, words, sizeof words);
  r->info[2] = gsc_sweep(text, n, reuse ? r->nwork : 0, reuse ? r->work : NULL, threads, r->speeds, r->reliefs, r->rpm,
                         r->relief, r->factor, r->estimate, r->status, r->contact, r->modulus, r->motion_residual,
                         r->steps, r->periods, words, sizeof words);
  r->info[3] = gsc_modes(text, n, r->modes, 0, r->frequency, r->error, r->residual, r->rim, NULL, words, sizeof words);
  r->info[4] = gsc_report(text, n, NULL, r->nwork, r->work, threads, r->answer, sizeof r->answer, &r->length,
                          words, sizeof words);
  r->info[5] = gsc_sizes("&pinion teeth = 3 /", 19, NULL, &r->info[6], &r->info[6], &r->info[6], &r->info[6],
                         &r->info[6], &r->info[6], &r->info[6], &r->info[6], &r->info[6], &r->info[6], words, sizeof words);
}

static int same(const result_t *a, const result_t *b) { return memcmp(a, b, sizeof *a) == 0; }

/* --- sizes and refusals --------------------------------------------------------- */

static double x[12][MOST];
static int k[4][MOST];

static void refusals(void)
{
  size_t n = strlen(geared);
  int speeds = -7, reliefs = -7, rows = -7, tried = -7, positions = -7, modes = -7, nodes = -7, elements = -7;
  int harmonics = -7, nwork = -7;
#define SIZES NULL, &speeds, &reliefs, &rows, &tried, &positions, &modes, &nodes, &elements, \
    &harmonics, &nwork
  refused("empty text", gsc_sizes("", 0, SIZES, M), GSC_INPUT, "&");
  char odd[sizeof geared + 20];
  sprintf(odd, "%s &colour red = 1 /", geared);
  refused("unknown group", gsc_sizes(odd, strlen(odd), SIZES, M), GSC_INPUT, "colour");
  refused("text is null", gsc_sizes(NULL, 10, SIZES, M), GSC_INPUT, "null pointer");
  refused("text too long", gsc_sizes(geared, (size_t)-1, SIZES, M), GSC_INPUT, "text_length");
  refused("result is null", gsc_sizes(geared, n, NULL, NULL, &reliefs, &rows, &tried, &positions, &modes, &nodes, &elements,
          &harmonics, &nwork, M),
          GSC_INPUT, "null pointer");
  check("refused calls leave the results", speeds == -7 && nwork == -7 && rows == -7);
  check("no message is wanted", gsc_sizes("&", 1, SIZES, NULL, 0) == GSC_INPUT && gsc_sizes("&", 1, SIZES, NULL, 9) == 1);

  char small[8];
  memset(small, '#', sizeof small);
  check("a long message is cut", gsc_sizes("&pair modul_mm = 3 /", 20, SIZES, small, 5) == 1 &&
        strlen(small) == 4 && small[5] == '#');
  check("room for the NUL alone", gsc_sizes("&", 1, SIZES, small, 1) == 1 && small[0] == 0 && small[5] == '#');

  char *bare = malloc(n);
  memcpy(bare, geared, n);
  check("text without NUL", gsc_sizes(bare, n, SIZES, M) == GSC_OK && message[0] == 0);
  free(bare);
  check("sizes", speeds == 5 && reliefs == 2 && modes == 3 && positions >= 5 && tried > 16 && rows > 600 && nwork > 100);
  char tail[sizeof geared + 20];
  memset(tail, '&', sizeof tail);
  memcpy(tail, geared, sizeof geared);
  check("text ends at the first NUL", gsc_sizes(tail, sizeof tail, SIZES, M) == GSC_OK);

#define SWEEP(text, nw, w, threads, n, m) gsc_sweep(text, strlen(text), nw, w, threads, n, m, x[1], x[2], x[3], x[4], \
                                                    k[0], k[1], x[5], x[6], k[2], k[3], M)
  x[3][0] = x[0][0] = -7;
  refused("too few speeds", SWEEP(geared, 0, NULL, 1, speeds - 1, reliefs), GSC_INPUT, "must be at least 5");
  refused("too few reliefs", SWEEP(geared, 0, NULL, 1, speeds, reliefs - 1), GSC_INPUT, "must be at least 2");
  refused("negative size", SWEEP(geared, 0, NULL, 1, -1, reliefs), GSC_INPUT, "must be at least 5");
  refused("threads below 0", SWEEP(geared, 0, NULL, -1, speeds, reliefs), GSC_INPUT, "threads");
  refused("too many threads", SWEEP(geared, 0, NULL, 100000, speeds, reliefs), GSC_INPUT, "threads");
  refused("work is null", SWEEP(geared, nwork, NULL, 1, speeds, reliefs), GSC_INPUT, "null pointer");
  refused("work is empty", SWEEP(geared, nwork, x[0], 1, speeds, reliefs), GSC_INPUT, "prepare it again");
  refused("work has a negative size", SWEEP(geared, -3, x[0], 1, speeds, reliefs), GSC_INPUT, "prepare it again");
  refused("work too small", gsc_prepare(geared, n, NULL, nwork - 1, x[0], M), GSC_INPUT, "must be at least");
  check("refused calls leave the arrays", x[3][0] == -7 && x[0][0] == -7);
  check("prepare", gsc_prepare(geared, n, NULL, nwork, x[0], M) == GSC_OK);
  refused("work of other gears", SWEEP(other, nwork, x[0], 1, speeds, reliefs), GSC_INPUT, "prepare it again");
  x[0][1] = NAN;
  refused("damaged work", SWEEP(geared, nwork, x[0], 1, speeds, reliefs), GSC_INPUT, "prepare it again");
  x[0][1] = 1e300;
  refused("damaged work", SWEEP(geared, nwork, x[0], 1, speeds, reliefs), GSC_INPUT, "prepare it again");

  refused("a task that is not named", gsc_mesh(other, strlen(other), 0, NULL, MOST, x[1], x[2], x[3], x[4], x[5], x[6],
          x[7], M), GSC_INPUT, "mesh among them");
  refused("too few rows", gsc_mesh(geared, n, 0, NULL, rows - 1, x[1], x[2], x[3], x[4], x[5], x[6], x[7], M), GSC_INPUT,
          "too small");
  refused("too little room", gsc_optimum(geared, n, 0, NULL, 1, tried - 1, k[0], x[1], x[2], x[3], k[1], x[4], x[5],
          x[6], x[7], M), GSC_INPUT, "too small");
  refused("too few modes", gsc_modes(geared, n, 2, 0, x[1], x[2], x[3], x[4], NULL, M), GSC_INPUT, "must be at least 3");
  refused("too few nodes", gsc_modes(geared, n, 3, 7, x[1], x[2], x[3], x[4], x[5], M), GSC_INPUT, "nodes = 7: too small");
  refused("no shapes", gsc_modes(geared, n, 3, nodes, x[1], x[2], x[3], x[4], NULL, M), GSC_INPUT, "null pointer");
  refused("no third gear", gsc_outline(geared, n, 3, MOST, k[0], x[1], x[2], M), GSC_INPUT, "member");
  refused("too few positions", gsc_root(geared, n, 0, NULL, positions - 1, reliefs, x[1], x[2], x[3], x[4], x[5], x[6],
          x[7], x[8], x[9], x[10], x[11], x[1], x[2], M), GSC_INPUT, "too small");
  refused("no geometry", gsc_geometry(prescribed, strlen(prescribed), x[1], x[2], x[3], x[4], x[5], x[6], x[7], x[8], M),
          GSC_INPUT, "no geometry");
  int load_rows = 0;
  refused("too few load rows", gsc_load(geared, n, 0, NULL, 3, &load_rows, x[1], x[2], x[3], x[4], x[5], k[0], k[1], k[2], M),
          GSC_INPUT, "too small");
  check("the rows that are needed", load_rows > 3);
  size_t length = 0;
  char answer[10] = "#########";
  refused("answer too small", gsc_report(other, strlen(other), NULL, 0, NULL, 1, answer, sizeof answer, &length, M), GSC_INPUT,
          "must be at least");
  check("the length that is needed", length > 100 && answer[0] == '#');
  refused("version too small", gsc_version(answer, 3, M), GSC_INPUT, "must be at least");
  check("version", gsc_version(answer, sizeof answer, M) == GSC_OK && strchr(answer, '.') != NULL);
  refused("an answer of any size", gsc_report(other, strlen(other), NULL, 0, NULL, 1, answer, (size_t)-1, &length, M),
          GSC_INPUT, "answer_size: more than 1000000000");
  message[0] = '?';
  check("a message of any size", gsc_version(answer, 3, message, (size_t)-1) == GSC_INPUT && strstr(message, "at least"));
  const char lost[] = "&case tasks = 'sweep' / &pinion teeth = 25 effective_mass_kg = 1 / &gear effective_mass_kg = 1 /"
    "&load normal_force_n = 6858 / &mesh model = 'table' contact_ratio = 1.6 file = 'nowhere.csv' /"
    "&sweep rpm_first = 1000 rpm_last = 2000 rpm_step = 500 /";
  refused("a file that is not there", SWEEP(lost, 0, NULL, 1, MOST, 1), GSC_FILE, "nowhere.csv");
  refused("nor in another folder", gsc_prepare(lost, strlen(lost), "elsewhere", MOST, x[0], M), GSC_FILE,
          "elsewhere/nowhere.csv");
  char changed[400];
  check("a key is changed", gsc_change("&gear teeth = 1 / ! c", 21, "gear", "teeth", "2, 3", changed, sizeof changed, &length, M) == 0 &&
        !strcmp(changed, "&gear teeth = 2, 3 / ! c") && length == strlen(changed));
  refused("no room for the change", gsc_change("&gear teeth = 1 /", 17, "gear", "teeth", "2", changed, 5, &length, M),
          GSC_INPUT, "must be at least 18");
  refused("no key", gsc_change("&gear teeth = 1 /", 17, "gear", NULL, "2", changed, 5, &length, M), GSC_INPUT, "null pointer");
  refused("a misspelt key", gsc_change("&gear teeth = 1 /", 17, "gear", "teth", "2", changed, sizeof changed, &length, M),
          GSC_INPUT, "did you mean teeth?");
  static char complete[20000];
  check("the complete case", gsc_complete(geared, n, complete, sizeof complete, &length, M) == 0 &&
        length == strlen(complete) && strstr(complete, "damping_ratio = 0.17"));
  check("unused keys", gsc_unused(idle, strlen(idle), complete, sizeof complete, &length, M) == 0 &&
        length == strlen(complete) && strcmp(complete, "modal: &modal modes\n") == 0);
  refused("no room for unused keys", gsc_unused(idle, strlen(idle), complete, 5, &length, M), GSC_INPUT,
          "must be at least 21");
}

static void partial(void)
{
  int speeds = 9, i;
  for (i = 0; i < 40; i++) x[3][i] = -7;
  refused("points without an answer are told", SWEEP(prescribed, 0, NULL, 1, speeds, 2), GSC_PARTIAL, "no answer");
  check("they are NaN and say why", isnan(x[3][0]) && k[0][0] >= GSC_UNSTABLE);
  check("the others have one", x[3][6] > 1 && k[0][6] <= GSC_INEXACT);
  check("nothing beyond the sizes is touched", x[3][7] == -7 && x[3][9] == -7);
  int found = -1;
  check("resonances", gsc_resonances(7, x[1], x[3], &found, x[5], x[6], M) == GSC_OK && found >= 0 && found <= 5);
}

/* --- many callers ----------------------------------------------------------------- */

enum { CALLERS = 8 };
static const char *const cases[3] = {geared, other, geared};
static result_t expected[3], got[CALLERS];

static void *caller(void *argument)
{
  int i = *(int *)argument;
  run(cases[i % 3], 1 + i % 2, i % 2, &got[i]);
  return NULL;
}

static void crowd(void)
{
  pthread_t thread[CALLERS];
  int number[CALLERS], i, round;
  for (i = 0; i < 3; i++) run(cases[i], 1, 1, &expected[i]);
  check("all calls succeed", expected[0].info[1] == 0 && expected[0].info[2] == 0 && expected[0].info[3] == 0 &&
        expected[0].info[4] == 0 && expected[0].info[5] == GSC_INPUT && expected[0].length > 500);
  check("the modes ascend", expected[0].frequency[0] > 0 && expected[0].frequency[2] >= expected[0].frequency[1]);
  run(geared, 0, 0, &got[0]);
  check("the same bits with any number of threads, without the stiffness passed in", same(&got[0], &expected[0]));
  for (round = 0; round < 3; round++) {
    for (i = 0; i < CALLERS; i++) {
      number[i] = i;
      if (pthread_create(&thread[i], NULL, caller, &number[i])) exit(1);
    }
    for (i = 0; i < CALLERS; i++) pthread_join(thread[i], NULL);
    for (i = 0; i < CALLERS; i++) check("the same bits for callers at once", same(&got[i], &expected[i % 3]));
  }
}

/* --- files ----------------------------------------------------------------- */

/* Writes the tables of `prescribed`; the names of the files, a line each, are in `files`. */
static char files[2000];
static int write_tables(const char *folder, const char *name)
{
  static char answer[4000];
  size_t length;
  return gsc_files(prescribed, sizeof prescribed - 1, NULL, 0, NULL, 1, folder, name, answer, sizeof answer, &length, NULL,
                   0, files, sizeof files, M);
}

/* The size of a file, -1 if there is none. */
static long size_of(const char *path)
{
  struct stat about;
  return lstat(path, &about) == 0 ? (long)about.st_size : -1;
}

/* Names that leave the folder, and a disk that is full: as if so, files may have 100 bytes. The signal of that limit must
   not end this process either. */
static void files_and_folders(void)
{
  const char *bad[] = {"", " ", ".", "..", "../x", "a/b", "/x", "a\nb", "a\033b", "a\302\233b"};
  const struct rlimit little = {100, RLIM_INFINITY}, all = {RLIM_INFINITY, RLIM_INFINITY};
  for (int i = 0; i < 10; i++) {
    refused("a name that is none", write_tables("written", bad[i]), GSC_INPUT, "name");
    check("no folder for a name that is none", size_of("written") == -1);
  }
  refused("a folder with control characters", write_tables("a\033b", "x"), GSC_INPUT, "control characters");
  check("tables", write_tables("written", "x") == GSC_PARTIAL && strstr(files, "written/x.sweep.csv\n"));
  long before = size_of("written/x.sweep.csv");
  check("a table", before > 1000);
  setrlimit(RLIMIT_FSIZE, &little);
  refused("a full disk", write_tables("written", "x"), GSC_FILE, "cannot write written/x.sweep.csv: File too large");
  setrlimit(RLIMIT_FSIZE, &all);
  check("a full disk: no file is told", files[0] == 0);
  check("a full disk: the old table stays", size_of("written/x.sweep.csv") == before);
  check("a full disk: nothing else is left", unlink("written/x.sweep.csv") == 0 && rmdir("written") == 0);
}

/* Callers at once under one name: each says that its tables are there, and they are whole. */
static void *writer(void *what)
{
  size_t length;
  (void)what;
  return gsc_files(prescribed, sizeof prescribed - 1, NULL, 0, NULL, 1, "crowded", "x", NULL, 0, &length, NULL, 0, NULL, 0,
                   NULL, 0) == GSC_PARTIAL ? "" : NULL;
}

static void crowded_folder(void)
{
  pthread_t thread[CALLERS];
  void *done;
  int good = 0;
  write_tables("crowded", "x");
  long alone = size_of("crowded/x.sweep.csv");
  for (int round = 0; round < 5; round++) {
    for (int i = 0; i < CALLERS; i++) pthread_create(&thread[i], NULL, writer, NULL);
    for (int i = 0; i < CALLERS; i++) {
      pthread_join(thread[i], &done);
      good += done != NULL;
    }
  }
  check("callers at once into one folder succeed", good == 5 * CALLERS);
  check("callers at once into one folder: the table is whole", size_of("crowded/x.sweep.csv") == alone);
  check("callers at once into one folder: nothing else is left", unlink("crowded/x.sweep.csv") == 0 && rmdir("crowded") == 0);
}

int main(void)
{
  refusals();
  files_and_folders();
  crowded_folder();
  partial();
  crowd();
  puts("end");
  return failed > 0;
}
