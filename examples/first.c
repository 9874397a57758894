/* Which relief is best? The worst dynamic factor over the speeds, for each relief. */
#include <gearsweep.h>
#include <stdio.h>
#include <string.h>

static const char text[] =
    "&case tasks = 'sweep' / &pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 / &gear teeth = 34 /"
    "&load torque_nm = 100 / &relief amount_um = 0, 10, 20 /"
    "&sweep rpm_first = 1000 rpm_last = 15000 rpm_step = 500 /";

int main(void) {
  gsc_study *study = NULL;
  double relief[20], factor[20], rpm[20];
  int rows, kind, width;
  char message[200];
  int code = gsc_run(text, strlen(text), NULL, 0, NULL, NULL, NULL, NULL, &study, message, sizeof message);
  /* Some operating points have no result; the others have. */
  if (code == GSC_PARTIAL) fprintf(stderr, "%s\n", message);
  if ((code != GSC_OK && code != GSC_PARTIAL) ||
      gsc_size(study, "sweep_worst", "rpm", &rows, &kind, &width, message, sizeof message) ||
      gsc_column(study, "sweep_worst", "relief_um", 20, relief, message, sizeof message) ||
      gsc_column(study, "sweep_worst", "worst_dynamic_factor", 20, factor, message, sizeof message) ||
      gsc_column(study, "sweep_worst", "rpm", 20, rpm, message, sizeof message)) {
    fprintf(stderr, "%s\n", message);
    return 1;
  }
  for (int i = 0; i < rows; i++) printf("%5.1f um: worst dynamic factor%8.4f at%8.1f rpm\n", relief[i], factor[i], rpm[i]);
  gsc_free(&study);
  return 0;
}
