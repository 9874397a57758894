// Which relief is best? The worst dynamic factor over the speeds, for each relief.
#include <cstdio>
#include <gearsweep.hpp>

static const char text[] =
    "&case tasks = 'sweep' / &pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 / &gear teeth = 34 /"
    "&load torque_nm = 100 / &relief amount_um = 0, 10, 20 /"
    "&sweep rpm_first = 1000 rpm_last = 15000 rpm_step = 500 /";

int main() try {
  const gearsweep::study study(text);
  // Some operating points have no result; the others have.
  if (study.code() == GSC_PARTIAL) std::fprintf(stderr, "some operating points have no result\n");
  const auto relief = study.column("sweep_worst", "relief_um"), factor = study.column("sweep_worst", "worst_dynamic_factor"),
             rpm = study.column("sweep_worst", "rpm");
  for (std::size_t i = 0; i < relief.size(); i++)
    std::printf("%5.1f um: worst dynamic factor%8.4f at%8.1f rpm\n", relief[i], factor[i], rpm[i]);
} catch (const gearsweep::error &error) {
  std::fprintf(stderr, "%s\n", error.what());
  return error.code;
}
