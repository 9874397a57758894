#!/bin/sh
# Runs every test, or only the suites named: sh test/run.sh [SUITE | SUITE:TEST ...]
# SUITE:TEST stands for the suite's tests whose names contain TEST; where there is none, the names are listed.
# Sets up and builds first where needed. The last line is `N passed, N failed`. A check counts once, however often
# it is looked at: in a loop, or with run-time checks and as released; it fails if it failed once.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
. "$root/test/checks.sh"
cd "$root" || exit
passed=0
failed=0
beside=
trap '[ -z "$beside" ] || kill "$beside" 2>/dev/null; exit 1' HUP INT TERM

say() { printf 'gearsweep: %s\n' "$*"; }

# tell NAME: what comes in, each line with this name before it as soon as it is there.
tell() { while IFS= read -r line; do printf '%s: %s\n' "$1" "$line"; done; }

# broke NAME CODE WHY: a part that cannot be built, or breaks off, is one failure.
broke() {
  say "$1 broke off with code $2$3"
  failed=$((failed + 1))
}

# counts NAME: what the part said last must be `N passed, N failed`, and its code must agree with it.
counts() {
  code=$(cat "$work/$1.code")
  line=$(tail -n 1 "$work/$1.said")
  if ! printf '%s\n' "$line" | grep -Eqx '[0-9]+ passed, [0-9]+ failed'; then
    broke "$1" "$code" ''
    line='0 passed, 0 failed'
  elif [ "$code" != 0 ] && [ "${line##*, }" = '0 failed' ]; then
    broke "$1" "$code" ', though no check failed'
  fi
}

# add_counts NAME: of a part whose checks are its own.
add_counts() {
  counts "$1"
  passed=$((passed + ${line%% *}))
  line=${line% failed}
  failed=$((failed + ${line##* }))
}

# suites BUILD ARGUMENTS...: the suites of one build, their checks in a list.
suites() {
  build=$1
  shift
  { GEARSWEEP_CHECKS=$work/$build.list "$run_dir/check-$build" "$@" 2>&1; echo $? >"$work/$build.code"; } </dev/null |
    tee "$work/$build.said" | tell "$build"
}

# --- the suites, in both builds at the same time ---------------------------------

started=$(date +%s)
[ $# -gt 0 ] || say 'the suites, in two builds at the same time, take about 3 min, everything about 10'
if build_check_debug; then
  say 'suites with run-time checks (debug)'
  mkfifo "$work/debug.pipe" || exit
  tee "$work/debug.said" <"$work/debug.pipe" | tell debug &
  telling=$!
  GEARSWEEP_CHECKS=$work/debug.list "$run_dir/check-debug" "$@" </dev/null >"$work/debug.pipe" 2>&1 &
  beside=$!
else
  broke debug 1 ': it cannot be built'
fi
if build_check_release; then
  say 'suites as released (release)'
  suites release "$@"
  counts release
else
  broke release 1 ': it cannot be built'
fi
if [ -n "$beside" ]; then
  wait "$beside"
  echo $? >"$work/debug.code"
  beside=
  wait "$telling"
  counts debug
  title='debug: no temporary copies of arrays that gfortran tells of, which fpm test and fpm run would print'
  if grep -q 'array temporary' "$work/debug.said"; then fails "$title"; else pass; fi
fi
cat "$work"/*.list >>"$list" 2>/dev/null
line=$(count_checks)
say "suites: $line, each counted once over both builds"
passed=$((passed + ${line%% *}))
line=${line% failed}
failed=$((failed + ${line##* }))

# --- further kinds of tests: scripts that find the program as $1 -------------------

if [ $# = 0 ]; then
  for script in test/test_*.sh; do
    # Not `name`, which building sets.
    part=$(basename "$script" .sh)
    part=${part#test_}
    say "$part: $(sed -n 's/^# Takes \(about .*\)\.$/\1/p' "$script")"
    if build_program; then
      { sh "$script" "$run_dir/gearsweep" 2>&1; echo $? >"$work/$part.code"; } </dev/null | tee "$work/$part.said" | tell "$part"
      add_counts "$part"
    else
      broke "$part" 1 ': the program cannot be built'
    fi
  done
fi

say "took $(($(date +%s) - started)) s"
echo "$passed passed, $failed failed"
[ "$failed" = 0 ] && [ "$passed" -gt 0 ]
