/* Spoilt calls by several threads at once: random texts and sizes, the same ones each time. A call may refuse,
   but then says why and leaves the results as they were; whatever it does, it touches nothing beyond what it was
   given, and good calls among them and afterwards give the same bits as before. Prints what fails, then
   `N passed, N failed`. With fortran77.c linked before the library, the calls are those of Fortran 77.

     fuzz FOLDER [calls]   as many with spoilt texts, and a tenth of that with spoilt sizes; files go to FOLDER */
#include <limits.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <gearsweep.h>

enum { MARK = 0xA5, GUARD = 64, LONGEST = 3000, CALLERS = 3 };

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
  "&case tasks = 'mesh', 'sweep', 'optimum', 'modal', 'static', 'load', 'section' / &pair module_mm = 3 face_width_mm = 20 /"
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

/* --- spoilt texts -------------------------------------------------------------------- */

static void spoilt_text(void)
{
  char buffer[LONGEST + 100];
  size_t n = spoil(buffer), length = 0;
  char *text = malloc(n + 1); /* as long as it is, so that reading on would be noticed */
  if (!text) exit(1);
  memcpy(text, buffer, n);
  int points, info = -1, which = (int)below(7), much = (int)below(20000);
  char group[8], key[8], value[30];
  switch (which) {
    case 0: info = gsc_geometry(text, n, D(12), D(5), D(10), D(1), D(2), D(1), D(1), D(1), message, words_room()); break;
    case 1: info = gsc_complete(text, n, fresh(much, 1), much, &length, message, words_room()); break;
    case 2: /* what is to be changed is spoilt, too */
      snprintf(group, sizeof group, "%s", below(2) ? "sweep" : ANY(words));
      snprintf(key, sizeof key, "%s", below(2) ? "rpm" : ANY(words));
      snprintf(value, sizeof value, "%s", below(2) ? ANY(values) : ANY(words));
      info = gsc_change(text, n, group, key, value, fresh(much, 1), much, &length, message, words_room());
      break;
    case 3: info = gsc_outline(text, n, (int)below(4), much / 8, &points, D(much / 8), D(much / 8), message, words_room()); break;
    case 4: info = gsc_unused(text, n, fresh(much, 1), much, &length, message, words_room()); break;
    default: info = gsc_sizes(text, n, below(9) ? NULL : "no/folder", I(1), I(1), I(1), I(1), I(1), I(1), I(1), I(1), I(1), I(1),
                              message, words_room());
  }
  free(text);
  judge(which, info);
}

/* --- spoilt sizes ------------------------------------------------------------------------ */

static int speeds, reliefs, rows, tried, positions, modes, nodes, elements, harmonics, nwork;
static double *good;
static const char *folder;

static int some_size(int right)
{
  int sizes[] = {right, right, right, right + 1, right + 7, right - 1, 1, 0, -1, INT_MIN};
  return ANY(sizes);
}

/* For an array's last size, which may be said to be any. */
static int last_size(int right) { return below(6) ? some_size(right) : INT_MAX; }
static long held(int size, int right) { return size < right + 8 ? size : right + 8; }
static long most(int size) { return size > 0 ? size : 0; }

/* For an array that is read: no more than there is. */
static int few(int right)
{
  int sizes[] = {right, right, right, right - 1, 0, -1, INT_MIN};
  return ANY(sizes);
}

static const double odd[] = {0, -1, 1e308, -1e-308, 2.5, 1e9};

/* Work with a number spoilt, or none of it. */
static double *some_work(int *n)
{
  double *work;
  int sizes[] = {nwork, nwork, nwork, 0, 0, nwork - 1, 1, -1, INT_MIN};
  *n = ANY(sizes);
  work = malloc(sizeof *work * (size_t)(*n > 0 ? *n : 1));
  if (!work) exit(1);
  if (*n > 0) memcpy(work, good, sizeof *work * (size_t)*n);
  if (*n > 0 && below(3) == 0) work[below(below(2) ? 4 : (unsigned)*n) % (unsigned)*n] = below(5) ? ANY(odd) : 0.0 / (work[0] - work[0]);
  return below(20) ? work : (free(work), NULL);
}

static void spoilt_size(void)
{
  static const int some_threads[] = {1, 1, 1, 2, 0, -1, 1025, INT_MAX, INT_MIN};
  const char *t = geared;
  size_t length = strlen(t), answer_length = 0;
  int n, a, b, c, info = -1, found, which = 10 + (int)below(18), threads = ANY(some_threads);
  double *w = some_work(&n);
  long x, y, z;
  switch (which) {
    case 10: a = last_size(nwork), info = gsc_prepare(t, length, NULL, a, D(held(a, nwork)), message, words_room()); break;
    case 11: info = gsc_motion(t, length, n, w, D(1), D(2), D(1), D(1), D(1), D(1), message, words_room()); break;
    case 12:
      a = last_size(rows), x = held(a, rows);
      info = gsc_mesh(t, length, n, w, a, D(x), D(x), D(x), D(x), D(x), D(x), D(x), message, words_room());
      break;
    case 13:
      a = last_size(700), x = held(a, 10000);
      info = gsc_load(t, length, n, w, a, &found, D(x), D(x), D(x), D(x), D(x), I(x), I(x), I(x), message, words_room());
      break;
    case 14:
      a = some_size(speeds), b = last_size(reliefs), y = held(b, reliefs), z = most(a) * y;
      info = gsc_sweep(t, length, n, w, threads, a, b, D(a), D(y), D(z), D(z), I(z), I(z), D(z), D(z), I(z), I(z), message,
                       words_room());
      break;
    case 15:
      a = last_size(tried), x = held(a, tried);
      info = gsc_optimum(t, length, n, w, threads, a, I(1), D(x), D(x), D(x), I(x), D(1), D(1), D(1), D(1), message, words_room());
      break;
    case 16:
      a = last_size(modes), b = below(2) ? 0 : some_size(nodes), x = held(a, modes);
      info = gsc_modes(t, length, a, b, D(x), D(x), D(x), D(x), D(2 * most(b) * x), message, words_room());
      break;
    case 17:
      a = some_size(nodes), b = last_size(elements), y = held(b, elements);
      info = gsc_section(t, length, a, b, D(a), D(a), I(8 * y), I(y), message, words_room());
      break;
    case 18:
      a = some_size(positions), b = last_size(reliefs), y = held(b, reliefs), z = most(a) * y;
      info = gsc_root(t, length, n, w, a, b, D(y), D(a), D(a), D(z), D(2 * z), D(6 * z), D(y), D(y), D(y), D(y), D(y), D(1),
                      D(1), message, words_room());
      break;
    case 19:
      a = last_size(nodes), x = held(a, nodes);
      info = gsc_stress(t, length, n, w, some_size(positions), some_size(reliefs), a, D(1), D(1), D(1), D(1), D(3 * x), message,
                        words_room());
      break;
    case 20: a = (int)below(6000), info = gsc_report(t, length, NULL, n, w, threads, fresh(a, 1), a, &answer_length, message,
                                                     words_room()); break;
    case 21: {
      double curve[2][6] = {{1, 2, 3, 4, 5, 6}, {1, 3, 1, 0.0 / (speeds - speeds), 1, 1e308}};
      a = some_size(5), a = a > 6 ? 6 : a;
      info = gsc_resonances(a, curve[0], curve[below(2)], I(1), D(5), D(5), message, words_room());
      break;
    }
    case 22:
      a = some_size(harmonics), b = last_size(reliefs), y = held(b, reliefs), z = most(a) * y;
      info = gsc_harmonics(t, length, n, w, a, b, D(y), D(y), D(y), D(y), D(z), D(z), D(y), message, words_room());
      break;
    case 23: { /* the texts are cut, not refused */
      char name[20];
      sprintf(name, "%s%d", below(4) ? "case" : "no/folder/", number);
      a = (int)below(6000), b = (int)below(400);
      info = gsc_files(t, length, NULL, n, w, threads, below(4) ? folder : "/dev/null/none", name, fresh(a, 1), a,
                       &answer_length, fresh(b, 1), b, fresh(b, 1), b, message, words_room());
      break;
    }
    case 24: {
      double rpm[3] = {3000, 6000, 9000}, damping_ratio[2] = {0.02, 0.1};
      if (below(4) == 0) rpm[below(3)] = ANY(odd);
      if (below(4) == 0) damping_ratio[below(2)] = ANY(odd);
      a = few(3), b = few(2), c = below(9) ? few(1) : 101, y = most(a) * most(b), z = most(c);
      info = gsc_stability(t, length, n, w, a, rpm, b, damping_ratio, c, D(y), I(y), D(z), D(z), D(2 * most(b) * z), message,
                           words_room());
      break;
    }
    case 25: {
      double rpm[3] = {3000, 6000, 9000};
      if (below(4) == 0) rpm[below(3)] = ANY(odd);
      a = few(3), b = few(2), x = most(a), y = 2 * most(b);
      info = gsc_follow(t, length, n, w, some_size(1), a, rpm, below(5) ? 0.02 : ANY(odd), below(5) ? 1e-3 : ANY(odd), b, &found,
                        D(y), D(y), I(y), I(y), D(x), D(x), I(x), I(x), D(x), I(x), D(x), D(x), message, words_room());
      break;
    }
    case 26: {
      double rpm[3] = {3000, 6000, 9000};
      if (below(4) == 0) rpm[below(3)] = ANY(odd);
      a = few(3), b = few(9), x = most(a), y = x * most(b);
      info = gsc_strobe(t, length, n, w, some_size(1), a, rpm, below(2) ? 8 : ANY(odd), below(2) ? 0 : ANY(odd), some_size(9), b, D(y),
                        D(y), D(x), I(x), I(x), message, words_room());
      break;
    }
    default: a = (int)below(10), info = gsc_version(fresh(a, 1), a, message, words_room());
  }
  free(w);
  judge(which, info);
}

/* --- a good call --------------------------------------------------------------------------- */

static int ready(void)
{
  int info = gsc_sizes(geared, strlen(geared), NULL, &speeds, &reliefs, &rows, &tried, &positions, &modes, &nodes, &elements,
                       &harmonics, &nwork, message, sizeof message);
  good = malloc(sizeof *good * (size_t)(nwork > 0 ? nwork : 1));
  return info == GSC_OK && good && gsc_prepare(geared, strlen(geared), NULL, nwork, good, message, sizeof message) == GSC_OK;
}

enum { LONGEST_ANSWER = 20000 };
static char before[LONGEST_ANSWER];

static void answer(char *text)
{
  size_t length = 0, size = LONGEST_ANSWER;
  memset(text, 0, size);
  int info = gsc_report(geared, strlen(geared), NULL, 0, NULL, 1, text, size, &length, message, sizeof message);
  check("a good call succeeds", 0, info, info == GSC_OK && length == strlen(text));
}

static void same_answer(void)
{
  char *now = malloc(LONGEST_ANSWER);
  if (!now) exit(1);
  answer(now);
  check("the same answer as before", 0, 0, memcmp(before, now, LONGEST_ANSWER) == 0);
  free(now);
}

typedef struct { pthread_t thread; long calls; int number, passed, failed; } caller_t;

static void *caller(void *argument)
{
  caller_t *this = argument;
  state += (uint64_t)(number = this->number);
  for (long i = 1; i <= this->calls; i++) {
    spoilt_text();
    if (i % 10 == 0) spoilt_size();
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
  answer(before);
  for (int i = 0; i < CALLERS; i++) {
    callers[i].calls = calls / CALLERS, callers[i].number = i;
    if (pthread_create(&callers[i].thread, NULL, caller, &callers[i])) exit(1);
  }
  for (int i = 0; i < CALLERS; i++) {
    pthread_join(callers[i].thread, NULL);
    passed += callers[i].passed, failed += callers[i].failed;
  }
  same_answer();
  free(good);
  printf("%d passed, %d failed\n", passed, failed);
  return failed > 0;
}
