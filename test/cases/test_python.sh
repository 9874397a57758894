#!/bin/sh
# Tests of the Python package, with the examples in its docstrings and in doc/python.md, and of the
# validation ledger: sh test/cases/test_python.sh PROGRAM [pytest options]
# The last line is `N passed, N failed`, as pytest counts.
# Takes about 5 min.
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd) || exit
. "$root/test/checks.sh"
GEARSWEEP_PROGRAM=${1:-$root/build/run/gearsweep}
case $GEARSWEEP_PROGRAM in /*) ;; *) GEARSWEEP_PROGRAM=$PWD/$GEARSWEEP_PROGRAM ;; esac
export GEARSWEEP_PROGRAM
[ $# = 0 ] || shift
build_package || exit

# Rows of the ledger that are open or not reproducible are expected failures, which count neither as passed nor as failed.
ln -s "$root/data" "$root/examples" "$work/" || exit
for page in python many pictures nonlinear sensitivity accuracy asymmetric; do set -- "$root/doc/$page.md" "$@"; done
export PYTHONPATH=$root
# Those that take long belong to --all of test/run.sh.
[ "${long_tests-yes}" = yes ] || set -- "$@" -m 'not long'
run_pytest --doctest-modules --doctest-glob='*.md' --pyargs gearsweep "$root/python/tests" "$root/validation/tests" "$@"
