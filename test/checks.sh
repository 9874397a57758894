# Sourced by test/run.sh and test/cases/test_*.sh, with $root set: checks with names, and how they are counted.
# A check is what bears one name: looked at many times, as in a loop, it counts once, and fails if it failed once.

. "$root/app/setup.sh"
# One language and one form of numbers in all messages and tables, whatever the caller's.
export LC_ALL=C
list=$(mktemp "${TMPDIR:-/tmp}/gearsweep.XXXXXX") || exit
work=$(mktemp -d "${TMPDIR:-/tmp}/gearsweep.XXXXXX") || exit
trap 'rm -rf "$work" "$list" "$list.output"' EXIT
trap 'exit 1' HUP INT TERM

pass() { echo "passed $title" >>"$list"; }
# fails TITLE
fails() {
  echo "failed $1" >>"$list"
  printf 'FAILED: %s\n' "$1"
}

# check TITLE COMMAND...: the command must succeed; the end of its output is shown where it does not. It runs in this shell.
check() {
  title=$1
  shift
  if "$@" >"$list.output" 2>&1; then
    pass
  else
    fails "$title"
    tail -n 40 "$list.output" | sed 's/^/  /'
  fi
}

# count_checks: `N passed, N failed` from lines `passed NAME` and `failed NAME`.
count_checks() {
  awk '{ name = substr($0, 8); bad[name] += $1 == "failed" }
    END { for (name in bad) if (bad[name]) failed++; else passed++
      printf "%d passed, %d failed\n", passed, failed }' "$list"
}

# Says the counts in the last line, and ends.
finish() {
  count_checks
  [ -s "$list" ] && ! grep -q '^failed ' "$list"
  exit
}

# need TOOL...: what the script calls. Installs what is missing; what cannot be had fails by its name.
need() {
  install_tools "$@"
  for tool in "$@"; do
    command -v "$tool" >/dev/null || fails "$tool is missing"
  done
}

# run_pytest ARGUMENTS: pytest in $work, away from the checkout, so that the installed package is what is tested. The last line is
# `N passed, N failed`, as pytest counts. No test takes more than 15 minutes: it fails then, and where it does not heed that, the run ends.
run_pytest() {
  cd "$work" || exit
  {
    "$venv/bin/python" -m pytest -q -rs --tb=short --durations=20 --durations-min=0.5 -p no:cacheprovider --timeout=900 \
      -o faulthandler_timeout=1200 -o faulthandler_exit_on_timeout=true "$@"
    echo $? >code
  } | tee said
  code=$(cat code)
  passed=$(told passed)
  failed=$(($(told failed) + $(told error)))
  # No tests, a usage error, an interruption: no count tells of it.
  [ "$code" = 0 ] || [ "$code" = 1 ] || failed=$((failed + 1))
  echo "$passed passed, $failed failed"
  [ "$failed" = 0 ] && [ "$passed" -gt 0 ]
}

# told WORD: how many of these pytest's last line tells.
told() { tail -n 1 said | grep -Eo "[0-9]+ $1s?\b" | grep -Eo '[0-9]+' || echo 0; }
