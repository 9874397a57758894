#!/bin/sh
# The library under the address and undefined-behaviour sanitizers, with leaks and the compiler's run-time
# checks: sh test/cases/sanitize.sh [--short] [suite ...]
# Short: the spoilt calls of tools/callers/fuzz.c. Otherwise also the other callers and the suites, or those named.
# The last line is `N passed, N failed`; a finding ends a part and is a failure.
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd) || exit
. "$root/test/checks.sh"
need gcc
if [ "${1-}" = --short ]; then build_sanitized; else build_check_sanitized; fi || exit
library=$root/build/sanitized/libgearsweep.a

# Not ours and kept until the end of the process: OpenBLAS's threads with their buffers, libgomp's pool.
cat >"$work/known" <<'END'
leak:libopenblas
leak:libgomp
END
export ASAN_OPTIONS=detect_leaks=1:detect_stack_use_after_return=1:abort_on_error=0
export LSAN_OPTIONS=suppressions=$work/known:print_suppressions=0
export UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1

# part TITLE COMMAND...: must end with code 0 and say nothing on stderr.
part() {
  title=$1
  shift
  if (cd "$1" && shift && "$@") >"$work/out" 2>"$work/err" && [ ! -s "$work/err" ]; then
    pass
  else
    fails "$title"
    tail -n 5 "$work/out"
    head -n 40 "$work/err"
  fi
}

libraries="-lopenblas -ldmumps_seq -larpack -lgomp -lgfortran -lm -lpthread"
# caller NAME: tools/callers/NAME.
caller() { gcc $sanitize_c_flags -std=gnu99 -I"$root/include" "$root/tools/callers/$1.c" -o "$work/$1" "$library" $libraries; }
legacy() { gfortran $sanitize_c_flags "$root/tools/callers/$1.f" -o "$work/$1" "$library" $libraries; }
# For those that read a case: all tasks.
cat >"$work/case.nml" <<'END'
&case tasks = 'geometry', 'mesh', 'static', 'modal', 'load', 'sweep', 'optimum' /
&pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 / &gear teeth = 34 /
&load normal_force_n = 4000 / &relief amount_um = 0, 10 / &section elements_across = 4 /
&static positions = 5 / &modal modes = 3 / &sweep rpm_first = 3000 rpm_last = 9000 rpm_step = 1000 load_rpm = 4000 /
END
run() { "./$1" case <case.nml; }

calls=2500
[ "${1-}" != --short ] || calls=250
part 'spoilt calls: build' "$work" caller fuzz
part 'spoilt calls' "$work" ./fuzz . $calls
if [ "${1-}" != --short ]; then
  part 'C: build' "$work" caller results
  part 'C' "$work" run results
  part 'Fortran 77: build' "$work" legacy results
  part 'Fortran 77' "$work" run results
  part 'suites' "$root" "$run_dir/check-sanitized" "$@"
fi
finish
