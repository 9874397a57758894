#!/bin/sh
# Runs every test, or only the suites named: sh test/run.sh [suite ...]
# Sets up and builds first where needed. The last line is `N passed, N failed`.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
. "$root/app/setup.sh"
cd "$root" || exit
mkdir -p "$run_dir" || exit
passed=0
failed=0
output=$run_dir/output.$$
trap 'rm -f "$output" "$output.code"' EXIT

# part TITLE BUILD COMMAND...: one part of the tests. The command's last line must be
# `N passed, N failed`; a part that cannot be built, or breaks off, is one failure.
part() {
  printf '== %s\n' "$1"
  if $2; then
    shift 2
    { "$@" 2>&1; echo $? >"$output.code"; } </dev/null | tee "$output"
    add_counts "$(tail -n 1 "$output")" "$(cat "$output.code")"
  else
    failed=$((failed + 1))
  fi
}

add_counts() {
  if printf '%s\n' "$1" | grep -Eqx '[0-9]+ passed, [0-9]+ failed'; then
    before=$failed
    passed=$((passed + ${1%% *}))
    line=${1% failed}
    failed=$((failed + ${line##* }))
    [ "$2" = 0 ] || [ "$failed" -gt "$before" ] && return
  fi
  echo "This part broke off with code $2."
  failed=$((failed + 1))
}

part 'suites, with run-time checks' build_check_debug "$run_dir/check-debug" "$@"
part 'suites, as released' build_check_release "$run_dir/check-release" "$@"
# Further kinds of tests go here; scripts named test/test_*.sh find the program as $1.
if [ $# = 0 ]; then
  for script in test/test_*.sh; do
    [ -f "$script" ] && part "$script" build_program sh "$script" "$run_dir/gearsweep"
  done
fi

echo "$passed passed, $failed failed"
[ "$failed" = 0 ] && [ "$passed" -gt 0 ]
