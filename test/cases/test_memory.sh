#!/bin/sh
# Every task under limits on address space that lie close together, in the program and in C hosts: each run ends by
# itself, with an answer or with code 6 and a message. And hosts with floating-point traps on, and threads with
# little stack: sh test/cases/test_memory.sh PROGRAM [long]
# With `long` the limits lie 1 MB apart (half an hour). The last line is `N passed, N failed`.
# Belongs to --all of test/run.sh.
# Takes about 2 min.
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd) || exit
program=${1:-$root/build/run/gearsweep}
case $program in /*) ;; *) program=$PWD/$program ;; esac
fineness=${2:-short}
. "$root/test/checks.sh"
cd "$work" || exit

pair="&pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 effective_mass_kg = 0.5 /
&gear teeth = 34 effective_mass_kg = 0.9 / &load normal_force_n = 4000 /"
# write NAME GROUPS: a case of that pair.
write() { printf '%s\n%s\n' "$pair" "$2" >"$1.nml"; }
write modal "&case tasks = 'modal' / &section elements_across = 4 / &modal modes = 3 /"
write modes "&case tasks = 'modal' / &section elements_across = 4 / &modal modes = 60 /"
write static "&case tasks = 'static' / &relief amount_um = 0, 5, 10 / &mesh model = 'fe' /
&section elements_across = 4 / &static positions = 50 /"
write section "&case tasks = 'modal' / &section elements_across = 40 / &modal modes = 1 /"
write fe "&case tasks = 'mesh' / &mesh model = 'fe' /"
write sweep "&case tasks = 'sweep' / &relief amount_um = 0, 10, 20 /
&sweep rpm_first = 1000 rpm_last = 20000 rpm_step = 50 /"
write slow "&case tasks = 'sweep' / &dynamics damping_ratio = 0.3 / &numerics tolerance = 1e-10 /
&sweep rpm_first = 1 rpm_last = 3 rpm_step = 1 /"
write optimum "&case tasks = 'optimum' / &sweep rpm_first = 3000 rpm_last = 20000 rpm_step = 500 /"
write load "&case tasks = 'mesh', 'load' / &relief amount_um = 0, 10, 20 / &sweep load_rpm = 100, 300, 5000, 6000 /"
write huge "&case tasks = 'modal' / &section elements_across = 200 teeth = 0 / &modal modes = 10 /"
write many "&case tasks = 'modal' / &section elements_across = 16 / &modal modes = 1000 /"
write points "&case tasks = 'sweep' / &sweep rpm_first = 1000 rpm_last = 20000 rpm_step = 0.00191 /"
{ printf '%s\n' "$pair" "&case tasks = 'mesh' / &relief amount_um ="; awk 'BEGIN { for (i = 0; i < 3000; i++) print i/1000 }'; echo /; } >reliefs.nml
{ printf '%s\n' "$pair" "&case tasks = 'mesh' / &relief amount_um ="; yes '100000*1' | head -n 30; echo /; } >values.nml

# at LIMIT COMMAND...: its code, in a limit in kB.
at() (
  ulimit -v "$1" || exit 99
  shift
  exec timeout 120 "$@"
)

# ladder STEP MOST COMMAND...: from what loads the program upwards, at most to MOST kB, until three runs in a row
# have an answer. Every run must end with 0 or 4 (1: the case of too many values), or with 6 and a message; some with 6.
ladder() {
  step=$1
  most=$2
  shift 2
  [ "$fineness" = long ] && step=1000
  limit=$least
  answers=0
  refusals=0
  while [ "$limit" -le "$most" ] && [ "$answers" -lt 3 ]; do
    at "$limit" "$@" >told 2>&1
    code=$?
    case $code in
      0 | 1 | 4) answers=$((answers + 1)) ;;
      6)
        answers=0
        refusals=$((refusals + 1))
        grep -q 'MB can be had\|does not hold\|; at most 8 GB' told || { echo "no message at $limit kB:"; tail -n 3 told; return 1; }
        ;;
      *)
        echo "code $code at $limit kB:"
        tail -n 3 told
        return 1
        ;;
    esac
    limit=$((limit + step))
  done
  [ "$refusals" -gt 0 ] || { echo "never short of memory"; return 1; }
}

least=30000
while [ "$least" -lt 200000 ] && ! at "$least" "$program" --version >told 2>&1; do least=$((least + 1000)); done
check 'the program says its version in little memory' test "$least" -lt 100000

for name in modal modes static section fe sweep slow optimum load reliefs values; do
  check "program, $name: an answer or code 6" ladder 24000 600000 "$program" "$name.nml" --quiet
done
# These need gigabytes; here they are refused.
check 'program, the largest whole gear: code 6' ladder 300000 900000 "$program" huge.nml --quiet
check 'program, 1000 modes: code 6' ladder 400000 1500000 "$program" many.nml --quiet
check 'program, 1e7 points: code 6' ladder 300000 900000 "$program" points.nml --quiet
largest() { at 900000 "$program" points.nml --quiet 2>told; cat told; grep -q 'speeds times 1 reliefs: needs some [0-9]* MB' told; }
check '1e7 points: the message says what lacks' largest

# --- C hosts -------------------------------------------------------------------

install() { sh "$root/app/install.sh" "$work/installed" </dev/null; }
check 'install' install
export PKG_CONFIG_PATH="$work/installed/lib/pkgconfig"
compile() { cc -std=c11 -Wall -Wextra -Werror "$root/tools/callers/host.c" $(pkg-config --cflags --libs gearsweep) -o host; }
check 'the host compiles' compile

# As doc/linking.md says for hosts that live under such a limit.
OPENBLAS_NUM_THREADS=1
MALLOC_ARENA_MAX=1
export OPENBLAS_NUM_THREADS MALLOC_ARENA_MAX
# All calls of a host end with 0, 1, 4 or 6; it ends with 6 where one does.
cat >lives.sh <<'END'
"$@" >calls 2>&1 || { code=$?; tail -n 3 calls; case $code in 0 | 1 | 4 | 6) exit 98 ;; esac; exit $code; }
grep '^[a-z]*: [0-9]' calls | grep -v ': [0146] ' && exit 97
grep '^[a-z]*: 6 ' calls && exit 6
exit 0
END
# The host loads more shared libraries than the program.
while [ "$least" -lt 200000 ] && ! at "$least" ./host >told 2>&1; do least=$((least + 1000)); done
check 'the host starts in little memory' test "$least" -lt 100000
# As doc/linking.md says: with less than 2 MB to spare no message can be made.
least=$((least + 2000))
for name in modal static; do
  check "host, $name: answers or code 6" ladder 60000 600000 sh lives.sh ./host "$name.nml"
done
for name in sweep load; do
  check "host, $name: answers or code 6" ladder 8000 200000 sh lives.sh ./host "$name.nml"
done
check 'host, four calls at once: answers or code 6' ladder 100000 1200000 sh lives.sh ./host threads static.nml

# Stiffness tables that overflow when read, scaled or splined.
table() {
  printf -- "$2" >"$1.table"
  printf "%s\n" "&case tasks = 'mesh', 'sweep' / &pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.9 /
&load normal_force_n = 6858 / &relief amount_um = 0, 15 / &mesh model = 'table' contact_ratio = 1.6 file = '$1.table' /
&sweep rpm_first = 2000 rpm_last = 16000 rpm_step = 1000 /" >"$1.nml"
}
table t1 '0 1e400\n1.6 400\n'
table t2 '0 400\n0.8 1e308\n1 -1e308\n1.6 400\n'
table t3 '0 400\n1e-300 300\n1.6 400\n'
table t4 '0 1e308\n0.5 1e308\n1.6 1e308\n'
table t5 '-1e308 400\n1e308 400\n'
table t6 '0 400\n0.8 300\n1.6 400\n'
traps() { sh lives.sh ./host traps "$@"; }
check 'traps: every task' traps modal.nml modes.nml static.nml section.nml fe.nml sweep.nml optimum.nml load.nml
for name in t1 t2 t3 t4 t5 t6; do check "traps: table $name" traps "$name.nml"; done

# Threads whose stack is too small for the library, or for libgomp.
unset OPENBLAS_NUM_THREADS MALLOC_ARENA_MAX
"$program" sweep.nml --quiet --out usual
small_stack() { OMP_STACKSIZE=$1 OMP_NUM_THREADS=4 "$program" sweep.nml --quiet --out small && cmp usual/sweep.sweep.csv small/sweep.sweep.csv; }
for size in 16k 64k 100k 8192B; do check "threads with a stack of $size" small_stack "$size"; done

finish
