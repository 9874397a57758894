#!/bin/sh
# Tests of the Python package, with the examples in its docstrings and in doc/python.md, and of the
# validation ledger: sh test/test_python.sh PROGRAM [pytest options]
# The last line is `N passed, N failed`, as pytest counts.
# Takes about 2 min.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
. "$root/test/checks.sh"
GEARSWEEP_PROGRAM=${1:-$root/build/run/gearsweep}
case $GEARSWEEP_PROGRAM in /*) ;; *) GEARSWEEP_PROGRAM=$PWD/$GEARSWEEP_PROGRAM ;; esac
export GEARSWEEP_PROGRAM
[ $# = 0 ] || shift
build_package || exit

# Away from the checkout, so that the installed package is what is tested. Rows of the ledger that
# are open or not reproducible are expected failures, which count neither as passed nor as failed.
cd "$work" && ln -s "$root/data" data || exit
{
  PYTHONPATH=$root "$venv/bin/python" -m pytest -q -rs --tb=short -p no:cacheprovider --doctest-modules \
    --doctest-glob='*.md' --pyargs gearsweep "$root/doc/python.md" "$root/doc/pictures.md" "$root/doc/stability.md" "$root/doc/branches.md" "$root/doc/precision.md" "$root/python/tests" "$root/validation/tests" "$@"
  echo $? >code
} | tee said
code=$(cat code)
# number WORD: how many of these pytest's last line tells.
number() { tail -n 1 said | grep -Eo "[0-9]+ $1s?\b" | grep -Eo '[0-9]+' || echo 0; }
passed=$(number passed)
failed=$(($(number failed) + $(number error)))
# No tests, a usage error, an interruption: no count tells of it.
[ "$code" = 0 ] || [ "$code" = 1 ] || failed=$((failed + 1))
echo "$passed passed, $failed failed"
[ "$failed" = 0 ] && [ "$passed" -gt 0 ]
