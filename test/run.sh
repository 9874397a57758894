#!/bin/sh
# Runs every test, or only the suites named: sh test/run.sh [SUITE | SUITE:TEST ...]
# SUITE:TEST stands for the suite's tests whose names contain TEST; where there is none, the names are listed.
# The front panel's tests in a browser are no part of the whole: sh test/run.sh --panel
# Sets up and builds first where needed. The last line is `N passed, N failed`. A check counts once, however often
# it is looked at: in a loop, or with run-time checks and as released; it fails if it failed once.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
if [ "${1-}" = --panel ]; then
  shift
  exec sh "$root/test/panel.sh" "$@"
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

# What runs beside a shell ignores interrupts, and so would all that it starts; tests send interrupts.
interruptible=
env --default-signal=INT,QUIT true 2>/dev/null && interruptible=--default-signal=INT,QUIT

# run_part NAME COMMAND...: what it says goes to NAME.said, its code to NAME.code.
run_part() {
  part=$1
  shift
  trap "$stop" HUP INT TERM                      # anew in a subshell
  mkfifo "$work/$part.pipe" || exit
  tee "$work/$part.said" <"$work/$part.pipe" | tell "$part" &
  telling=$!
  env $interruptible "$@" </dev/null >"$work/$part.pipe" 2>&1 &
  doing=$!
  wait "$doing"
  echo $? >"$work/$part.code"
  doing=
  wait "$telling"
}

# --- the suites, in both builds at the same time ---------------------------------

started=$(date +%s)
[ $# -gt 0 ] || say 'the suites, in two builds at the same time, take about 8 min, everything about 25'
if build_check_debug; then
  say 'suites with run-time checks (debug)'
  run_part debug env GEARSWEEP_CHECKS="$work/debug.list" "$run_dir/check-debug" "$@" &
  beside=$!
else
  broke debug 1 ': it cannot be built'
fi
if build_check_release; then
  say 'suites as released (release)'
  run_part release env GEARSWEEP_CHECKS="$work/release.list" "$run_dir/check-release" "$@"
  counts release
else
  broke release 1 ': it cannot be built'
fi
if [ -n "$beside" ]; then
  wait "$beside"
  beside=
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

# --- further kinds of tests: scripts that find the program as $1, two at a time ---------

# The longest first, so that both lanes end at about the same time.
list_scripts() {
  for script in test/test_*.sh; do
    printf '%s %s\n' "$(sed -n 's/^# Takes about \([0-9]* [ms]\).*/\1/p' "$script")" "$script"
  done | sort -k 2,2 -k 1,1nr -k 3 | cut -d ' ' -f 3
}

# lane: takes the next script that nobody has taken, until there is none.
lane() {
  for script in $scripts; do
    part=$(basename "$script" .sh)
    part=${part#test_}
    mkdir "$work/$part.taken" 2>/dev/null || continue
    say "$part: $(sed -n 's/^# Takes \(about .*\)\.$/\1/p' "$script")"
    run_part "$part" sh "$script" "$run_dir/gearsweep"
  done
}

if [ $# = 0 ]; then
  if build_program; then
    scripts=$(list_scripts)
    lane &
    beside=$!
    lane
    wait "$beside"
    beside=
    for script in $scripts; do
      part=$(basename "$script" .sh)
      add_counts "${part#test_}"
    done
  else
    broke program 1 ': it cannot be built'
  fi
fi

say "took $(($(date +%s) - started)) s"
echo "$passed passed, $failed failed"
[ "$failed" = 0 ] && [ "$passed" -gt 0 ]
