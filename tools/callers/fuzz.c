/* Spoilt calls by several threads at once: random texts and sizes, the same ones each time. A call may refuse,
   but then says why and leaves the results as they were; whatever it does, it touches nothing beyond what it was
   given, and good calls among them and afterwards, afresh or from a study that all callers read, give the same bits as
   before. Prints what fails, then `N passed, N failed`.

     fuzz FOLDER [calls]   as many with spoilt texts, and a tenth of that with other spoilt calls; files go to FOLDER */
#include <limits.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <gearsweep.h>

enum { MARK = 0xA5, GUARD = 64, LONGEST = 3000, CALLERS = 4 };

/* --- chance ----------------------------------------------------------------------- */
static __thread uint64_t state = 88172645463325252u;
static __thread int number; /* of this caller */

/* Below n, by xorshift. */
static unsigned below(unsigned n)
{
  state ^= state << 13, state ^= state >> 7, state ^= state << 17;
  return (unsigned)((state >> 11) % n);
}

#define ANY(list) (list)[below(sizeof(list) / sizeof *(list))]

static const char geared[] =
  "&case tasks = 'mesh', 'sweep', 'optimum', 'modal', 'static', 'load' / &pair module_mm = 3 face_width_mm = 20 /"
  "&pinion teeth = 21 effective_mass_kg = 0.5 / &gear teeth = 34 effective_mass_kg = 0.9 /"
  "&load normal_force_n = 4000 / &relief amount_um = 0, 10 / &mesh model = 'weber' /"
  "&section elements_across = 3 / &modal modes = 3 / &static positions = 5 /"
  "&sweep rpm_first = 3000 rpm_last = 9000 rpm_step = 3000 load_rpm = 4000 /";
static const char prescribed[] =
  "&case tasks = 'sweep', 'mesh' / &pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.9 /"
  "&load normal_force_n = 6858 / &mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400, 0, -120 /"
  "&numerics steps_per_period = 20 / &sweep rpm_first = 1 rpm_last = 6001 rpm_step = 2000 /\n! a remark's end";
static const char *const values[] = {
  "1e308", "-1e308", "1e-308", "1d400", "nan", "-inf", "-0", "0", "-1", "99999999999999999999", "2147483648", "''", "'",
  "'it''s'", ".true.", "3*2", "1000000*7", ",,,", "1e", "+", "0x1f", "'\xc3\xa9'", "\xff\xfe", "1 2 3 4 5 6 7 8 9"};
static const char *const words[] = {
  " &", " /", " = ", "\n", "\r\n", "\t", "!", "'", "\"", " &end ", "&case", "&sweep rpm_step = 1e-9 /", "$case", "module_mm",
  " teeth = 1000000 ", " elements_across = 100000 ", "(1)", "(-1:3)", "%", "tasks", "&&&&", "////", " pair", " = = "};

/* A case with a few places spoilt, and how long it is. */
static size_t spoil(char *text)
{
  const char *from = below(3) ? geared : prescribed;
  size_t n = strlen(from), at, many, i;
  memcpy(text, from, n);
  for (int times = (int)below(4) + 1; times > 0; times--) {
    const char *put = below(2) ? ANY(values) : ANY(words);
    at = below((unsigned)n + 1), many = strlen(put);
    switch (below(6)) {
      case 0: /* a byte */
        if (at < n) text[at] = (char)below(256);
        break;
      case 1: /* a value becomes another */
        while (at < n && text[at] != '=') at++;
        if (at < n && at + 1 + many < n) text[at] = '=', memcpy(text + at + 1, put, many);
        break;
      case 2: /* something comes in */
        if (n + many > LONGEST) break;
        memmove(text + at + many, text + at, n - at);
        memcpy(text + at, put, many), n += many;
        break;
      case 3: /* something goes */
        many = below((unsigned)(n - at) + 1) / 4;
        memmove(text + at, text + at + many, n - at - many), n -= many;
        break;
      case 4: /* the end is lost */
        if (below(4) == 0) n = at;
        break;
      default: /* noise alone */
        if (below(8)) break;
        n = below(400);
        for (i = 0; i < n; i++) text[i] = (char)below(256);
    }
  }
  return n;
}

/* --- what a call leaves behind -------------------------------------------------------- */
static __thread int passed, failed, rooms, said;
static __thread struct { unsigned char *bytes; size_t size; } room[20];
static __thread char message[GUARD + 300];

static void check(const char *what, int which, int info, int holds)
{
  if (holds) { passed++; return; }
  if (failed++ < 20) printf("FAILED: %s (call %d, code %d, message: %.200s)\n", what, which, info, said > 1 ? message : "");
}

/* Marked room for n items, with marks behind it; none for n below 0. */
static void *fresh(long n, size_t item)
{
  size_t size = n > 0 ? (size_t)n * item : 0;
  unsigned char *bytes = malloc(size + GUARD);
  if (!bytes) exit(1);
  memset(bytes, MARK, size + GUARD);
  room[rooms].bytes = bytes, room[rooms++].size = size;
  return bytes;
}
#define D(n) fresh(n, sizeof(double))
#define I(n) fresh(n, sizeof(int))
static int marked(const unsigned char *bytes, size_t n)
{
  while (n > 0 && bytes[n - 1] == MARK) n--;
  return n == 0;
}

/* How much room the next message has: none, its NUL alone, or some. */
static int words_room(void)
{
  static const int sizes[] = {0, 1, 2, 40, 300, 300, 300};
  memset(message, MARK, sizeof message);
  return said = ANY(sizes);
}

/* The rules for every call. */
static void judge(int which, int info)
{
  const char *end = memchr(message, 0, sizeof message);
  int whole = 1, behind = 1, done = info == GSC_OK || info == GSC_PARTIAL;
  check("a code of the header", which, info, info >= GSC_OK && info <= GSC_MEMORY && info != GSC_USAGE);
  check("the message stays in its room", which, info, marked((unsigned char *)message + said, sizeof message - said));
  if (said > 0) check("the message ends with its NUL", which, info, end != NULL && end < message + said);
  if (said > 1) check("a message where something is wrong", which, info, (info != GSC_OK) == (message[0] != 0));
  while (rooms > 0) {
    rooms--;
    if (!marked(room[rooms].bytes + room[rooms].size, GUARD)) behind = 0;
    if (!done && !marked(room[rooms].bytes, room[rooms].size)) whole = 0;
    free(room[rooms].bytes);
  }
  check("nothing beyond the room is touched", which, info, behind);
  check("what is refused leaves the results", which, info, whole);
}

/* --- spoilt calls -------------------------------------------------------------------- */
static gsc_study *shared;                 /* read by all callers at once */
static int rows, longest_row;
static const char *folder;

/* A text of its own, as long as it is, so that reading on would be noticed. */
static char *own(const char *from, size_t n)
{
  char *text = malloc(n + 1);
  if (!text) exit(1);
  memcpy(text, from, n);
  return text;
}

static void spoilt_text(void)
{
  char buffer[LONGEST + 100], group[8], key[8], value[30];
  size_t n = spoil(buffer), length = 0;
  char *text = own(buffer, n);
  int info = -1, which = (int)below(4), much = (int)below(20000);
  gsc_study *study = NULL;
  switch (which) {
    case 0: info = gsc_edit("complete", text, n, NULL, NULL, NULL, fresh(much, 1), much, &length, message, words_room()); break;
    case 1: info = gsc_edit("unused", text, n, NULL, NULL, NULL, fresh(much, 1), much, &length, message, words_room()); break;
    case 2: /* what is to be changed is spoilt, too */
      snprintf(group, sizeof group, "%s", below(2) ? "sweep" : ANY(words));
      snprintf(key, sizeof key, "%s", below(2) ? "rpm" : ANY(words));
      snprintf(value, sizeof value, "%s", below(2) ? ANY(values) : ANY(words));
      info = gsc_edit("change", text, n, group, key, value, fresh(much, 1), much, &length, message, words_room());
      break;
    default: /* a run that reads no file and computes nothing, as its argument `resume` is not empty */
      info = gsc_run(text, n, below(9) ? NULL : "no/folder", 1, below(2) ? shared : NULL, NULL, "no/checkpoint", NULL, &study,
                     message, words_room());
      check("a refused run makes no study", which, info, study == NULL);
  }
  free(text);
  judge(which, info);
}

static int some_size(int right) { return ANY(((int[]){right, right, right, right + 1, right + 7, right - 1, 1, 0, -1, INT_MIN})); }
static long held(int size, int right) { return size < right + 8 ? size : right + 8; }

static void spoilt_call(void)
{
  static const char *const tables[] = {"sweep", "sweep", "sweep", "mesh", "swep", "", "\xff", "a table with a very long name"};
  static const char *const columns[] = {"dynamic_factor", "dynamic_factor", "status", "rpm", "rmp", "", "\n", "*"};
  static const char *const kinds[] = {"report", "log", "tables", "case", "logs", "", "\x01"};
  static const int some_threads[] = {1, 1, 2, 0, -1, 1025, INT_MAX, INT_MIN};
  static const char *const names[] = {"relief.amount_um", "relief.amount_um gear.teeth", "", "gear", "a.b", "\xff.\n",
                                      "gear.teeth gear.teeth"};
  static const char *const takes[] = {"sweep.dynamic_factor", "geometry.contact_ratio sweep.rpm", "sweep.status", "swep.rpm",
                                      "", "."};
  static const double some_numbers[] = {10, 34, 35, -1, 0.5, 1e308};
  const gsc_study *study = below(12) ? shared : NULL;
  gsc_study *made = NULL;
  size_t length = 0;
  int a, info = -1, which = 10 + (int)below(8);
  char name[20];
  double numbers[4];
  switch (which) {
    case 10: a = (int)below(20000), info = gsc_text(study, ANY(kinds), fresh(a, 1), a, &length, message, words_room()); break;
    case 11: info = gsc_size(study, ANY(tables), ANY(columns), I(1), I(1), I(1), message, words_room()); break;
    case 12:
      a = below(6) ? some_size(rows) : INT_MAX;
      info = gsc_column(study, ANY(tables), ANY(columns), a, D(held(a, rows)), message, words_room());
      break;
    case 13: a = (int)below(30), info = gsc_words(study, ANY(tables), ANY(columns), some_size(longest_row), fresh(a, 1), a, message,
                                                  words_room()); break;
    case 14: /* the list is refused where it does not fit, the files are written */
      sprintf(name, "%s%d", below(4) ? "case" : "no/folder/", number), a = (int)below(6000);
      info = gsc_write(study, below(4) ? folder : "/dev/null/none", name, fresh(a, 1), a, &length, message, words_room());
      break;
    case 15:
      info = gsc_run(below(20) ? geared : NULL, below(20) ? strlen(geared) : (size_t)-1, NULL, ANY(some_threads),
                     below(2) ? shared : NULL, NULL, NULL, NULL, below(20) ? &made : NULL, message, words_room());
      check("a study where there is one", which, info, (info == GSC_OK) == (made != NULL));
      gsc_free(&made), gsc_free(&made);
      break;
    case 16:
      for (a = 0; a < 4; a++) numbers[a] = ANY(some_numbers);
      info = gsc_rows(below(20) ? geared : NULL, below(20) ? strlen(geared) : (size_t)-1, NULL, ANY(some_threads),
                      below(2) ? shared : NULL, NULL, below(20) ? ANY(names) : NULL, below(9) ? 2 : 0, below(20) ? numbers : NULL,
                      ANY(takes), below(20) ? &made : NULL, message, words_room());
      check("rows where there are some", which, info, (info == GSC_OK || info == GSC_PARTIAL) == (made != NULL));
      gsc_free(&made);
      break;
    default: a = (int)below(10), info = gsc_version(fresh(a, 1), a, message, words_room());
  }
  judge(which, info);
}

/* --- a good call --------------------------------------------------------------------------- */
enum { LONGEST_ANSWER = 40000 };
static char before[LONGEST_ANSWER];

/* Runs the case and takes its report and a column. */
static void answer(char *text, const gsc_study *earlier)
{
  size_t length = 0;
  gsc_study *study = NULL;
  memset(text, 0, LONGEST_ANSWER);
  int info = gsc_run(geared, strlen(geared), NULL, 1, earlier, NULL, NULL, NULL, &study, message, sizeof message);
  if (info == GSC_OK) info = gsc_text(study, "report", text, LONGEST_ANSWER / 2, &length, message, sizeof message);
  if (info == GSC_OK) info = gsc_column(study, "sweep", "dynamic_factor", rows, (double *)(text + LONGEST_ANSWER / 2), message,
                                        sizeof message);
  check("a good call succeeds", 0, info, info == GSC_OK && length == strlen(text));
  gsc_free(&study);
}

static void same_answer(void)
{
  char *now = malloc(LONGEST_ANSWER);
  if (!now) exit(1);
  answer(now, below(2) ? shared : NULL);
  check("the same answer as before", 0, 0, memcmp(before, now, LONGEST_ANSWER) == 0);
  free(now);
}

static int ready(void)
{
  int kind, width;
  if (gsc_run(geared, strlen(geared), NULL, 1, NULL, NULL, NULL, NULL, &shared, message, sizeof message)) return 0;
  if (gsc_size(shared, "sweep", "dynamic_factor", &rows, &kind, &width, message, sizeof message)) return 0;
  longest_row = rows - 1;
  answer(before, NULL);
  return 1;
}

typedef struct { pthread_t thread; long calls; int number, passed, failed; } caller_t;

static void *caller(void *argument)
{
  caller_t *this = argument;
  state += (uint64_t)(number = this->number);
  for (long i = 1; i <= this->calls; i++) {
    spoilt_text();
    if (i % 10 == 0) spoilt_call();
    if (i % 100 == 0) same_answer();
  }
  this->passed = passed, this->failed = failed;
  return NULL;
}

int main(int count, char **arguments)
{
  caller_t callers[CALLERS];
  long calls = count > 2 ? atol(arguments[2]) : 2500;
  if (count < 2) return 2;
  folder = arguments[1];
  if (!ready()) return printf("%s\n0 passed, 1 failed\n", message), 1;
  for (int i = 0; i < CALLERS; i++) {
    callers[i].calls = calls / CALLERS, callers[i].number = i;
    if (pthread_create(&callers[i].thread, NULL, caller, &callers[i])) exit(1);
  }
  for (int i = 0; i < CALLERS; i++) {
    pthread_join(callers[i].thread, NULL);
    passed += callers[i].passed, failed += callers[i].failed;
  }
  same_answer();
  gsc_free(&shared);
  printf("%d passed, %d failed\n", passed, failed);
  return failed > 0;
}
