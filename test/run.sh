#!/bin/sh
# Runs the tests, or only the suites named: sh test/run.sh [--all | SUITE | SUITE:TEST ...]
# Without a word, what takes some 13 min on two idle cores. --all: the rest too, before a release: the scripts whose
# head says that they belong to --all, with run-time checks also the suites that are long with them, the long Python tests, and
# the front panel in a browser, which `sh test/run.sh --panel` runs alone.
# SUITE:TEST stands for the suite's tests whose names contain TEST; where there is none, the names are listed.
# Sets up and builds first where needed. The last line is `N passed, N failed`. A check counts once, however often
# it is looked at: in a loop, or with run-time checks and as released; it fails if it failed once.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
if [ "${1-}" = --panel ]; then
  shift
  exec sh "$root/test/cases/panel.sh" "$@"
fi
all=
if [ "${1-}" = --all ]; then
  shift
  all=--all
  [ $# = 0 ] || { echo "usage: sh test/run.sh [--all | --panel | SUITE ...]" >&2; exit 2; }
fi
. "$root/test/checks.sh"
cd "$root" || exit
passed=0
failed=0
beside=
doing=
stop='kill $beside $doing 2>/dev/null; exit 1'
trap "$stop" HUP INT TERM

say() { printf 'gearsweep: %s\n' "$*"; }

# tell NAME: what comes in, each line with this name before it as soon as it is there.
tell() { while IFS= read -r line; do printf '%s: %s\n' "$1" "$line"; done; }

# counts NAME: what the part said last must be `N passed, N failed`, and its code must agree with it. What cannot be built, or
# breaks off, is one failure.
counts() {
  code=$(cat "$work/$1.code")
  line=$(tail -n 1 "$work/$1.said")
  if ! printf '%s\n' "$line" | grep -Eqx '[0-9]+ passed, [0-9]+ failed'; then
    say "$1 broke off with code $code"
    line='0 passed, 1 failed'
  elif [ "$code" != 0 ] && [ "${line##*, }" = '0 failed' ]; then
    say "$1 broke off with code $code, though no check failed"
    line="${line%, *}, 1 failed"
  fi
}

# add: the counts in `line` to those of the whole.
add() {
  passed=$((passed + ${line%% *}))
  line=${line% failed}
  failed=$((failed + ${line##* }))
}

# What runs beside a shell ignores interrupts, and so would all that it starts; tests send interrupts.
interruptible=
env --default-signal=INT,QUIT true 2>/dev/null && interruptible=--default-signal=INT,QUIT

# run_part NAME COMMAND...: what it says goes to NAME.said, its code to NAME.code. One that hangs is ended after three hours.
run_part() {
  part=$1
  shift
  trap "$stop" HUP INT TERM                      # anew in a subshell
  mkfifo "$work/$part.pipe" || exit
  tee "$work/$part.said" <"$work/$part.pipe" | tell "$part" &
  telling=$!
  env $interruptible timeout -k 60 10800 "$@" </dev/null >"$work/$part.pipe" 2>&1 &
  doing=$!
  wait "$doing"
  echo $? >"$work/$part.code"
  doing=
  wait "$telling"
}

# --- the parts, two at a time --------------------------------------------------------

# run_suites BUILD SUITE...: in the build debug, with run-time checks, or release.
run_suites() {
  build=$1
  shift
  say "the suites as built for $build"
  run_part "$build" env GEARSWEEP_CHECKS="$work/$build.list" "$run_dir/check-$build" "$@"
}

# The longest first, so that both lanes end at about the same time. A script that belongs to --all says so in its head.
list_scripts() {
  for script in test/cases/test_*.sh test/cases/panel.sh; do
    [ -n "$all" ] || ! sed -n 2,9p "$script" | grep -q '^# Belongs to --all' || continue
    printf '%s %s\n' "$(sed -n 's/^# Takes about \([0-9]* [ms]\).*/\1/p' "$script")" "$script"
  done | sort -k 2,2 -k 1,1nr -k 3 | cut -d ' ' -f 3
}

# name_of SCRIPT: the name of the part: test/cases/test_python.sh is python.
name_of() {
  part=$(basename "$1" .sh)
  echo "${part#test_}"
}

# run_script SCRIPT: a further kind of tests, that finds the program as $1.
run_script() {
  say "$(name_of "$1"): $(sed -n 's/^# Takes \(about .*\)\.$/\1/p' "$1")"
  run_part "$(name_of "$1")" sh "$1" "$run_dir/gearsweep"
}

# used FILE FILE: seconds of the processor between two reports of `times`, by all that the shell has waited for.
used() {
  awk 'FNR == 2 { all = 0; for (i = 1; i <= 2; i++) { split($i, part, "[ms]"); all += 60*part[1] + part[2] } spent = all - spent }
    END { printf "%d\n", spent }' "$@"
}

# lane SUITE...: takes the next part that nobody has taken, until there is none.
lane() {
  for what in $order; do
    lane_part=$(name_of "$what")
    mkdir "$work/$lane_part.taken" 2>/dev/null || continue
    since=$(date +%s)
    # Not in a pipe or a subshell, which would tell of itself.
    times >"$work/$lane_part.before"
    # Stands where what the part needs cannot be built.
    echo 1 >"$work/$lane_part.code"
    : >"$work/$lane_part.said"
    case $what in
      debug) build_check_debug && run_suites debug ${short:+"$short"} "$@" ;;
      release) build_check_release && run_suites release "$@" ;;
      *) build_program && run_script "$what" ;;
    esac
    times >"$work/$lane_part.after"
    say "$lane_part took $(($(date +%s) - since)) s, $(used "$work/$lane_part.before" "$work/$lane_part.after") s of the processor"
  done
}

started=$(date +%s)
scripts=
order='debug release'
# Of the suites, those that are not long with run-time checks.
short=
lanes=2
if [ $# = 0 ]; then
  scripts=$(list_scripts)
  # The program shares its build with the suites as released, and Python's own build goes on beside these.
  order="release test/cases/test_python.sh debug $scripts"
  if [ -n "$all" ]; then
    say 'all tests, about 35 min'
  else
    say 'about 13 min; sh test/run.sh --all runs the rest too'
    short=--short
    # Parts of scripts that belong to --all.
    export builds_anew=no long_tests=no
  fi
fi
lane "$@" &
beside=$!
lane "$@"
wait "$beside"
beside=

# --- what they say ----------------------------------------------------------------------

for build in debug release; do
  counts "$build"
  # Its checks are counted below, but not that it broke off.
  [ "${line##*, }" = '1 failed' ] && ! grep -qs '^failed ' "$work/$build.list" && title="$build ends well" && fails "$title"
done
title='debug: no temporary copies of arrays that gfortran tells of, which fpm test and fpm run would print'
if grep -q 'array temporary' "$work/debug.said"; then fails "$title"; else pass; fi
cat "$work"/*.list >>"$list" 2>/dev/null
line=$(count_checks)
say "suites: $line, each counted once over both builds"
add
for script in $scripts; do
  counts "$(name_of "$script")"
  add
done

say "took $(($(date +%s) - started)) s"
echo "$passed passed, $failed failed"
[ "$failed" = 0 ] && [ "$passed" -gt 0 ]
