/* The functions of the header by way of the Fortran calls, for callers that are to try both doors: linked before the
   library, they take the place of its own. Lengths of texts go behind the arguments, as GNU Fortran has them. */
#include <string.h>
#include <gearsweep.h>

void gs_version_(), gs_sizes_(), gs_prepare_(), gs_report_(), gs_write_(), gs_complete_(), gs_change_(), gs_geometry_(),
  gs_motion_(), gs_mesh_(), gs_harmonics_(), gs_load_(), gs_sweep_(), gs_resonances_(), gs_optimum_(), gs_outline_(),
  gs_section_(), gs_modes_(), gs_root_(), gs_stress_(), gs_stability_(), gs_follow_(), gs_strobe_(), gs_unused_();

typedef const char *text_t;
typedef const double *work_t;

/* A text with its NUL, which may be missing; one whose NUL needs a byte. */
static text_t given(text_t text) { return text ? text : ""; }
static size_t length_of(text_t text) { return text ? strlen(text) : 0; }
static size_t without_nul(size_t size) { return size > 0 ? size - 1 : 0; }

/* A NUL behind the last letter: Fortran fills up with blanks. */
static void end(char *text, size_t size)
{
  size_t n = without_nul(size);
  if (size == 0) return;
  while (n > 0 && text[n - 1] == ' ') n--;
  text[n] = 0;
}

#define SAY char *message, size_t room
/* The call, its code; no work is none of it. */
#define CALL(call, ...) int info = -1; call(__VA_ARGS__, &info, message, LENGTHS without_nul(room)); end(message, room); return info;
#define NO_WORK static const double none; if (!work) nwork = 0, work = &none;

/* Calls with one text. */
#define LENGTHS n,

int gsc_geometry(text_t text, size_t n, double *a, double *b, double *c, double *d, double *e, double *f, double *g,
                 double *h, SAY)
{ CALL(gs_geometry_, text, a, b, c, d, e, f, g, h) }

int gsc_motion(text_t text, size_t n, int nwork, work_t work, double *a, double *b, double *c, double *d, double *e,
               double *f, SAY)
{ NO_WORK CALL(gs_motion_, text, &nwork, work, a, b, c, d, e, f) }

int gsc_mesh(text_t text, size_t n, int nwork, work_t work, int rows, double *a, double *b, double *c, double *d,
             double *e, double *f, double *g, SAY)
{ NO_WORK CALL(gs_mesh_, text, &nwork, work, &rows, a, b, c, d, e, f, g) }

int gsc_harmonics(text_t text, size_t n, int nwork, work_t work, int harmonics, int reliefs, double *a, double *b,
                  double *c, double *d, double *e, double *f, double *g, SAY)
{ NO_WORK CALL(gs_harmonics_, text, &nwork, work, &harmonics, &reliefs, a, b, c, d, e, f, g) }

int gsc_load(text_t text, size_t n, int nwork, work_t work, int most, int *rows, double *a, double *b, double *c,
             double *d, double *e, int *f, int *g, int *h, SAY)
{ NO_WORK CALL(gs_load_, text, &nwork, work, &most, rows, a, b, c, d, e, f, g, h) }

int gsc_sweep(text_t text, size_t n, int nwork, work_t work, int threads, int speeds, int reliefs, double *a, double *b,
              double *c, double *d, int *e, int *f, double *g, double *h, int *i, int *j, SAY)
{ NO_WORK CALL(gs_sweep_, text, &nwork, work, &threads, &speeds, &reliefs, a, b, c, d, e, f, g, h, i, j) }

int gsc_optimum(text_t text, size_t n, int nwork, work_t work, int threads, int most, int *tried, double *a, double *b,
                double *c, int *d, double *e, double *f, double *g, double *h, SAY)
{ NO_WORK CALL(gs_optimum_, text, &nwork, work, &threads, &most, tried, a, b, c, d, e, f, g, h) }

int gsc_outline(text_t text, size_t n, int member, int most, int *points, double *a, double *b, SAY)
{ CALL(gs_outline_, text, &member, &most, points, a, b) }

int gsc_section(text_t text, size_t n, int nodes, int elements, double *a, double *b, int *c, int *d, SAY)
{ CALL(gs_section_, text, &nodes, &elements, a, b, c, d) }

int gsc_modes(text_t text, size_t n, int modes, int nodes, double *a, double *b, double *c, double *d, double *e, SAY)
{ CALL(gs_modes_, text, &modes, &nodes, a, b, c, d, e) }

int gsc_root(text_t text, size_t n, int nwork, work_t work, int positions, int reliefs, double *a, double *b, double *c,
             double *d, double *e, double *f, double *g, double *h, double *i, double *j, double *k, double *l, double *m,
             SAY)
{ NO_WORK CALL(gs_root_, text, &nwork, work, &positions, &reliefs, a, b, c, d, e, f, g, h, i, j, k, l, m) }

int gsc_stress(text_t text, size_t n, int nwork, work_t work, int position, int relief, int nodes, double *a, double *b,
               double *c, double *d, double *e, SAY)
{ NO_WORK CALL(gs_stress_, text, &nwork, work, &position, &relief, &nodes, a, b, c, d, e) }

int gsc_stability(text_t text, size_t n, int nwork, work_t work, int speeds, work_t rpm, int dampings, work_t damping_ratio,
                  int tongues, double *a, int *b, double *c, double *d, double *e, SAY)
{ NO_WORK CALL(gs_stability_, text, &nwork, work, &speeds, rpm, &dampings, damping_ratio, &tongues, a, b, c, d, e) }

int gsc_follow(text_t text, size_t n, int nwork, work_t work, int relief, int speeds, work_t rpm, double jump,
               double closeness, int most, int *changes, double *a, double *b, int *c, int *d, double *e, double *f, int *g,
               int *h, double *i, int *j, double *k, double *l, SAY)
{ NO_WORK CALL(gs_follow_, text, &nwork, work, &relief, &speeds, rpm, &jump, &closeness, &most, changes, a, b, c, d, e, f, g, h,
               i, j, k, l) }

int gsc_strobe(text_t text, size_t n, int nwork, work_t work, int relief, int speeds, work_t rpm, double start_um,
               double start_mm_s, int settle, int keep, double *a, double *b, double *c, int *d, int *e, SAY)
{ NO_WORK CALL(gs_strobe_, text, &nwork, work, &relief, &speeds, rpm, &start_um, &start_mm_s, &settle, &keep, a, b, c, d, e) }

/* Calls with one text and a folder. */
#undef LENGTHS
#define LENGTHS n, length_of(folder),

int gsc_sizes(text_t text, size_t n, text_t folder, int *a, int *b, int *c, int *d, int *e, int *f, int *g, int *h,
              int *i, int *j, SAY)
{ CALL(gs_sizes_, text, given(folder), a, b, c, d, e, f, g, h, i, j) }

int gsc_prepare(text_t text, size_t n, text_t folder, int nwork, double *work, SAY)
{ CALL(gs_prepare_, text, given(folder), &nwork, work) }

/* Calls with other texts. */
#undef LENGTHS
#define LENGTHS
int gsc_resonances(int speeds, work_t rpm, work_t factor, int *found, double *a, double *b, SAY)
{ CALL(gs_resonances_, &speeds, rpm, factor, found, a, b) }

int gsc_version(char *version, size_t size, SAY)
{
  int info = -1;
  gs_version_(version, &info, message, without_nul(size), without_nul(room));
  if (info == GSC_OK) end(version, size);
  end(message, room);
  return info;
}

/* A text that is given back: `used` bytes, then its NUL. */
static int give(int info, char *answer, int used, size_t *length, SAY)
{
  if (used >= 0) *length = (size_t)used;
  if (info == GSC_OK || info == GSC_PARTIAL) answer[used] = 0;
  end(message, room);
  return info;
}

int gsc_report(text_t text, size_t n, text_t folder, int nwork, work_t work, int threads, char *answer, size_t size,
               size_t *length, SAY)
{
  NO_WORK
  int info = -1, used = -1;
  gs_report_(text, given(folder), &nwork, work, &threads, answer, &used, &info, message, n, length_of(folder),
             without_nul(size), without_nul(room));
  return give(info, answer, used, length, message, room);
}

int gsc_files(text_t text, size_t n, text_t folder, int nwork, work_t work, int threads, text_t out, text_t name,
              char *answer, size_t size, size_t *length, char *stages, size_t stages_size, char *files, size_t files_size,
              SAY)
{
  NO_WORK
  int info = -1, used = -1, room_of_values = 0, values_used;
  double values[1];
  char names[1];
  gs_write_(text, given(folder), &nwork, work, &threads, out, name, &room_of_values, values, &values_used, names, answer,
            &used, stages, files, &info, message, n, length_of(folder), strlen(out), strlen(name), (size_t)1,
            without_nul(size), without_nul(stages_size), without_nul(files_size), without_nul(room));
  if (used >= 0) *length = (size_t)used, end(answer, size), end(stages, stages_size), end(files, files_size);
  end(message, room);
  return info;
}

int gsc_complete(text_t text, size_t n, char *complete, size_t size, size_t *length, SAY)
{
  int info = -1, used = -1;
  gs_complete_(text, complete, &used, &info, message, n, without_nul(size), without_nul(room));
  return give(info, complete, used, length, message, room);
}

int gsc_unused(text_t text, size_t n, char *unused, size_t size, size_t *length, SAY)
{
  int info = -1, used = -1;
  gs_unused_(text, unused, &used, &info, message, n, without_nul(size), without_nul(room));
  return give(info, unused, used, length, message, room);
}

int gsc_change(text_t text, size_t n, text_t group, text_t key, text_t value, char *changed, size_t size, size_t *length,
               SAY)
{
  int info = -1, used = -1;
  gs_change_(text, group, key, given(value), changed, &used, &info, message, n, strlen(group), strlen(key),
             length_of(value), without_nul(size), without_nul(room));
  return give(info, changed, used, length, message, room);
}
