/* Designs a spur-gear pair with gearsweep in C: what legacy.f does, line by line the same output.

     cc design.c $(pkg-config --cflags --libs gearsweep) */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <gearsweep.h>

static char message[200];

static void check(int info)
{
  if (info == GSC_OK) return;
  printf("info%2d: %s\n", info, message);
  if (info != GSC_PARTIAL) exit(1);
}

static double *numbers(int n)
{
  double *x = malloc(sizeof *x * (n > 0 ? n : 1));
  if (!x) exit(1);
  return x;
}

/* 17 digits, which no two numbers share, in the width and with the exponent of Fortran. */
static void put(double x)
{
  char text[40];
  sprintf(text, "%.16E", x);
  char *power = strchr(text, 'E');
  int exponent = power ? atoi(power + 1) : 0;
  if (power) sprintf(power, "E%c%03d", exponent < 0 ? '-' : '+', abs(exponent));
  printf(",%25s", text);
}

static void show(const char *name, const double *x, int n)
{
  for (int i = 0; i < n; i++) {
    printf("%s", name);
    put(x[i]);
    putchar('\n');
  }
}

int main(void)
{
  char text[1000];
  sprintf(text,
          "&case tasks = 'mesh', 'sweep', 'optimum' / &pair module_mm = %.3f face_width_mm = %.3f / "
          "&pinion teeth = %d effective_mass_kg = 0.8 / &gear teeth = %d effective_mass_kg = 1.1 / "
          "&load normal_force_n = %.2f / &relief amount_um = 0, 12.5, 20 / "
          "&mesh model = 'fe' / &section elements_across = 6 / "
          "&sweep rpm_first = 2000 rpm_last = 16000 rpm_step = 500 /", 3.18, 25.4, 25, 31, 7010.0);
  size_t length = strlen(text);

  int speeds, reliefs, rows, room, positions, modes, nodes, elements, harmonics, nwork;
  check(gsc_sizes(text, length, NULL, &speeds, &reliefs, &rows, &room, &positions, &modes, &nodes, &elements,
                  &harmonics, &nwork, message, sizeof message));

  double radius[12], point[5], point_radius[10], distance, angle[2], ratio, pitch, backlash;
  check(gsc_geometry(text, length, radius, point, point_radius, &distance, angle, &ratio, &pitch, &backlash,
                     message, sizeof message));
  show("radius", radius, 12);
  show("point", point, 5);
  show("point_radius", point_radius, 10);
  show("distance", &distance, 1);
  show("angle", angle, 2);
  show("ratio", &ratio, 1);
  show("pitch", &pitch, 1);
  show("backlash", &backlash, 1);

  /* The finite elements run here, and in no call that is given work. */
  double *work = numbers(nwork), load, mass[2], stiffness, frequency, turn, shared;
  check(gsc_prepare(text, length, NULL, nwork, work, message, sizeof message));
  check(gsc_motion(text, length, nwork, work, &load, mass, &stiffness, &frequency, &turn, &shared, message, sizeof message));
  show("load", &load, 1);
  show("mass", mass, 2);
  show("stiffness", &stiffness, 1);
  show("frequency", &frequency, 1);
  show("turn", &turn, 1);
  show("shared", &shared, 1);

  double *mesh[7];
  for (int k = 0; k < 7; k++) mesh[k] = numbers(rows);
  check(gsc_mesh(text, length, nwork, work, rows, mesh[0], mesh[1], mesh[2], mesh[3], mesh[4], mesh[5], mesh[6],
                 message, sizeof message));
  for (int i = 0; i < rows; i++) {
    printf("mesh");
    for (int k = 0; k < 7; k++) put(mesh[k][i]);
    putchar('\n');
  }

  int points = speeds * reliefs;
  double *rpm = numbers(speeds), *relief = numbers(reliefs), *factor = numbers(points), *estimate = numbers(points);
  double *modulus = numbers(points), *residual = numbers(points);
  int *status[4];
  for (int k = 0; k < 4; k++)
    if (!(status[k] = malloc(points * sizeof **status))) return 1;
  check(gsc_sweep(text, length, nwork, work, 2, speeds, reliefs, rpm, relief, factor, estimate, status[0],
                  status[1], modulus, residual, status[2], status[3], message, sizeof message));
  for (int j = 0; j < reliefs; j++)
    for (int i = 0; i < speeds; i++) {
      printf("sweep");
      put(relief[j]);
      put(rpm[i]);
      put(factor[i + speeds * j]);
      put(estimate[i + speeds * j]);
      put(modulus[i + speeds * j]);
      put(residual[i + speeds * j]);
      printf("\nstatus");
      for (int k = 0; k < 4; k++) printf(",%6d", status[k][i + speeds * j]);
      putchar('\n');
    }

  int tried, *failed = malloc(room * sizeof *failed);
  double *curve[3], best[4];
  if (!failed) return 1;
  for (int k = 0; k < 3; k++) curve[k] = numbers(room);
  check(gsc_optimum(text, length, nwork, work, 2, room, &tried, curve[0], curve[1], curve[2], failed, &best[0],
                    &best[1], &best[2], &best[3], message, sizeof message));
  for (int i = 0; i < tried; i++) {
    printf("vcurve");
    for (int k = 0; k < 3; k++) put(curve[k][i]);
    putchar('\n');
  }
  printf("best");
  for (int k = 0; k < 4; k++) put(best[k]);
  putchar('\n');

  /* The same speeds: where less damping would be too little, what a slow run up meets, and what is seen of it
     once a mesh period. */
  enum { DAMPINGS = 2, TONGUES = 2, ROOM = 20, KEEP = 8 };
  double damping_ratio[DAMPINGS] = {0, 0.01}, *largest = numbers(speeds * DAMPINGS), closing[TONGUES], closing_rpm[TONGUES];
  double edge[2 * DAMPINGS * TONGUES];
  int *sense = malloc(speeds * DAMPINGS * sizeof *sense);
  if (!sense) return 1;
  check(gsc_stability(text, length, nwork, work, speeds, rpm, DAMPINGS, damping_ratio, TONGUES, largest, sense, closing,
                      closing_rpm, edge, message, sizeof message));
  show("modulus", largest, speeds * DAMPINGS);
  for (int i = 0; i < speeds * DAMPINGS; i++) printf("sense,%6d\n", sense[i]);
  show("closing", closing, TONGUES);
  show("closing", closing_rpm, TONGUES);
  show("edge", edge, 2 * DAMPINGS * TONGUES);

  int changes, change_status[2 * ROOM], change_periods[2 * ROOM];
  double change_rpm[2 * ROOM], change_factor[2 * ROOM], *x = numbers(speeds), *v = numbers(speeds);
  check(gsc_follow(text, length, nwork, work, 1, speeds, rpm, 0.02, 1e-6, ROOM, &changes, change_rpm, change_factor,
                   change_status, change_periods, factor, estimate, status[0], status[1], modulus, status[3], x, v,
                   message, sizeof message));
  printf("changes,%6d\n", changes);
  for (int i = 0; i < speeds; i++) {
    printf("follow");
    put(rpm[i]), put(factor[i]), put(estimate[i]), put(modulus[i]), put(x[i]), put(v[i]);
    putchar('\n');
  }

  double *seen = numbers(KEEP * speeds), *rate = numbers(KEEP * speeds), *exponent = numbers(speeds);
  check(gsc_strobe(text, length, nwork, work, 1, speeds, rpm, x[0], v[0], 20, KEEP, seen, rate, exponent, status[0],
                   status[3], message, sizeof message));
  show("strobe", seen, KEEP * speeds);
  show("strobe", rate, KEEP * speeds);
  show("exponent", exponent, speeds);

  for (int k = 0; k < 7; k++) free(mesh[k]);
  for (int k = 0; k < 3; k++) free(curve[k]);
  for (int k = 0; k < 4; k++) free(status[k]);
  free(largest), free(sense), free(x), free(v), free(seen), free(rate), free(exponent);
  free(work), free(rpm), free(relief), free(factor), free(estimate), free(modulus), free(residual), free(failed);
  return 0;
}
