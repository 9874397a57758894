/* Prints every number that gearsweep has for a case, a line each with its name and 17 digits, then the
   answer: what results.f and results.py print, line by line. The case comes from the standard input; a task
   that it does not name is left out.

     cc results.c $(pkg-config --cflags --libs gearsweep) */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <gearsweep.h>

enum { MOST = 60000, MOST_WORK = 5000 };
static char text[40000], answer[40000], message[200];
static double x[19][MOST], work[MOST_WORK];
static int k[4][MOST];
#define M message, sizeof message

static void check(int info)
{
  if (info == GSC_OK) return;
  printf("info%2d: %s\n", info, message);
  exit(1);
}

/* In the width and with the exponent of Fortran. */
static void show(const char *name, const double *values, int n)
{
  char digits[40];
  for (int i = 0; i < n; i++) {
    sprintf(digits, "%.16E", values[i]);
    char *power = strchr(digits, 'E');
    int exponent = power ? atoi(power + 1) : 0;
    if (power) sprintf(power, "E%c%03d", exponent < 0 ? '-' : '+', abs(exponent));
    printf("%s,%25s\n", name, isnan(values[i]) ? "NaN" : digits);
  }
}

static void count(const char *name, const int *values, int n)
{
  for (int i = 0; i < n; i++) printf("%s,%12d\n", name, values[i]);
}

static int asks(const char *task)
{
  char quoted[20];
  sprintf(quoted, "'%s'", task);
  return strstr(text, quoted) != NULL;
}

int main(void)
{
  size_t n = fread(text, 1, sizeof text - 1, stdin), length;
  int speeds, reliefs, rows, tried, positions, modes, nodes, elements, harmonics, nwork, m;
  check(gsc_sizes(text, n, NULL, &speeds, &reliefs, &rows, &tried, &positions, &modes, &nodes, &elements, &harmonics,
                  &nwork, M));
  if (speeds * reliefs > MOST || rows > MOST || 6 * positions * reliefs > MOST || 8 * elements > MOST ||
      2 * nodes * (modes > 2 ? modes : 2) > MOST || nwork > MOST_WORK) return puts("arrays too small"), 1;

  if (!strstr(text, "contact_ratio")) {
    check(gsc_geometry(text, n, x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], M));
    show("geometry.radius_mm", x[0], 12);
    show("geometry.point", x[1], 5);
    show("geometry.point_radius_mm", x[2], 10);
    show("geometry.distance_mm", x[3], 1);
    show("geometry.working_angle_deg", x[4], 2);
    show("geometry.contact_ratio", x[5], 1);
    show("geometry.base_pitch_mm", x[6], 1);
    show("geometry.backlash_um", x[7], 1);
    for (int member = 1; member < 3; member++) {
      check(gsc_outline(text, n, member, MOST, &m, x[0], x[1], M));
      show("outline.x_mm", x[0], m);
      show("outline.y_mm", x[1], m);
    }
  }

  if (nwork > 0) {
    check(gsc_prepare(text, n, NULL, nwork, work, M));
    check(gsc_motion(text, n, nwork, work, x[0], x[1], x[2], x[3], x[4], x[5], M));
    show("motion.load_n", x[0], 1);
    show("motion.mass_kg", x[1], 2);
    show("motion.stiffness_n_um", x[2], 1);
    show("motion.frequency_hz", x[3], 1);
    show("motion.turn_um", x[4], 1);
    show("motion.shared_um", x[5], 1);
  }

  if (asks("mesh")) {
    check(gsc_mesh(text, n, nwork, work, rows, x[0], x[1], x[2], x[3], x[4], x[5], x[6], M));
    show("mesh.relief_um", x[0], rows);
    show("mesh.s", x[1], rows);
    show("mesh.pair_n_um", x[2], rows);
    show("mesh.mesh_n_um", x[3], rows);
    show("mesh.error_um", x[4], rows);
    show("mesh.share", x[5], rows);
    show("mesh.ste_um", x[6], rows);
    check(gsc_harmonics(text, n, nwork, work, harmonics, reliefs, x[0], x[1], x[2], x[3], x[4], x[5], x[6], M));
    show("harmonics.relief_um", x[0], reliefs);
    show("harmonics.mean_um", x[1], reliefs);
    show("harmonics.rms_um", x[2], reliefs);
    show("harmonics.peak_to_peak_um", x[3], reliefs);
    show("harmonics.amplitude_um", x[4], harmonics * reliefs);
    show("harmonics.phase_deg", x[5], harmonics * reliefs);
    show("harmonics.estimate_um", x[6], reliefs);
  }

  if (asks("load")) {
    check(gsc_load(text, n, nwork, work, MOST, &m, x[0], x[1], x[2], x[3], x[4], k[0], k[1], k[2], M));
    show("load.relief_um", x[0], m);
    show("load.rpm", x[1], m);
    show("load.s", x[2], m);
    show("load.pair_load_n", x[3], m);
    show("load.dte_um", x[4], m);
    count("load.status", k[0], m);
    count("load.periods", k[1], m);
    count("load.pair", k[2], m);
  }

  if (asks("sweep")) {
    m = speeds * reliefs;
    check(gsc_sweep(text, n, nwork, work, 2, speeds, reliefs, x[0], x[1], x[2], x[3], k[0], k[1], x[4], x[5], k[2], k[3],
                    M));
    show("sweep.rpm", x[0], speeds);
    show("sweep.relief_um", x[1], reliefs);
    show("sweep.dynamic_factor", x[2], m);
    show("sweep.estimate", x[3], m);
    count("sweep.status", k[0], m);
    count("sweep.contact", k[1], m);
    show("sweep.floquet_modulus", x[4], m);
    show("sweep.residual", x[5], m);
    count("sweep.steps", k[2], m);
    count("sweep.periods", k[3], m);
    check(gsc_resonances(speeds, x[0], x[2], &m, x[6], x[7], M));
    show("resonances.peak_rpm", x[6], m);
    show("resonances.peak_factor", x[7], m);
  }

  if (asks("optimum")) {
    check(gsc_optimum(text, n, nwork, work, 2, tried, &m, x[0], x[1], x[2], k[0], x[3], x[4], x[5], x[6], M));
    show("optimum.relief_um", x[0], m);
    show("optimum.worst_factor", x[1], m);
    show("optimum.rpm", x[2], m);
    count("optimum.failed", k[0], m);
    show("optimum.best_um", x[3], 1);
    show("optimum.best_factor", x[4], 1);
    show("optimum.best_rpm", x[5], 1);
    show("optimum.within_um", x[6], 1);
  }

  if (asks("section")) {
    check(gsc_section(text, n, nodes, elements, x[0], x[1], k[0], k[1], M));
    show("section.x_mm", x[0], nodes);
    show("section.y_mm", x[1], nodes);
    count("section.element", k[0], 8 * elements);
    count("section.tooth", k[1], elements);
  }

  if (asks("modal")) {
    check(gsc_modes(text, n, modes, nodes, x[0], x[1], x[2], x[3], x[4], M));
    show("modal.frequency_hz", x[0], modes);
    show("modal.estimate", x[1], modes);
    show("modal.residual", x[2], modes);
    show("modal.rim_share", x[3], modes);
    show("modal.shape", x[4], 2 * nodes * modes);
  }

  if (asks("static")) {
    check(gsc_root(text, n, nwork, work, positions, reliefs, x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], x[8], x[9],
                   x[10], x[11], x[12], M));
    show("static.relief_um", x[0], reliefs);
    show("static.s", x[1], positions);
    show("static.radius_mm", x[2], positions);
    show("static.share", x[3], positions * reliefs);
    show("static.sigma_mpa", x[4], 2 * positions * reliefs);
    show("static.parts_mpa", x[5], 6 * positions * reliefs);
    show("static.tension_mpa", x[6], reliefs);
    show("static.tension_deg", x[7], reliefs);
    show("static.compression_mpa", x[8], reliefs);
    show("static.compression_deg", x[9], reliefs);
    show("static.estimate", x[10], reliefs);
    show("static.iso_mpa", x[11], 1);
    show("static.lewis_mpa", x[12], 1);
    /* The whole section at the last position and the last relief. */
    check(gsc_stress(text, n, nwork, work, positions, reliefs, nodes, x[0], x[1], x[2], x[3], x[4], M));
    show("stress.relief_um", x[0], 1);
    show("stress.s", x[1], 1);
    show("stress.radius_mm", x[2], 1);
    show("stress.share", x[3], 1);
    show("stress.sigma_mpa", x[4], 3 * nodes);
  }

  check(gsc_report(text, n, NULL, nwork, work, 2, answer, sizeof answer, &length, M));
  printf("%s", answer);
  return 0;
}
