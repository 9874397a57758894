#!/bin/sh
# Runs fpm as in any of its packages, in a copy of the sources as fresh as a clone: sh test/cases/test_fpm.sh PROGRAM
# The last line is `N passed, N failed`.
# Belongs to --all of test/run.sh.
# Takes about 2 min.
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd) || exit
. "$root/test/checks.sh"
program=${1:-$root/build/run/gearsweep}
case $program in /*) ;; *) program=$PWD/$program ;; esac
install_packages && install_fpm || exit
mkdir "$work/clone" && cd "$root" && cp -R fpm.toml app data doc include src test "$work/clone" && cd "$work/clone" || exit

# beyond FILE: the lines that fpm does not say as it builds.
beyond() { grep -Ev '^ \+ mkdir -p |^\[ *[0-9]+%\] ' "$1"; }
# words: without numbers, times and names of files: another build may round a last digit otherwise.
words() { sed -e '/^Time/d' -e '/^Wrote/,$d' -e 's/[0-9.][-0-9.E+]*//g' -e 's/  */ /g'; }
same() { cmp "$1" "$2" || { diff "$1" "$2" | head -n 8; return 1; }; }

"$venv/bin/fpm" run gearsweep -- data/case1.nml >"$work/said" 2>&1 </dev/null
code=$?
check 'fpm run: exit code' test "$code" = 0
(cd "$work" && "$program" clone/data/case1.nml --out "$work/theirs" </dev/null) | words >"$work/answer"
beyond "$work/said" | words >"$work/ours"
check 'fpm run: the answer and nothing else' same "$work/ours" "$work/answer"
check 'fpm run: says something' test -s "$work/ours"

# What these suites do reaches most of the library; test/run.sh runs all of them in a build with more checks.
"$venv/bin/fpm" test -- reader calls geometry motion resonances >"$work/said" 2>&1 </dev/null
code=$?
check 'fpm test: exit code' test "$code" = 0
counts='[1-9][0-9]* passed, +0 failed'
last() { tail -n 1 "$work/said" | grep -Eqx "$counts" || { tail -n 20 "$work/said"; return 1; }; }
check 'fpm test: nothing failed' last
beyond "$work/said" | grep -Ev "^[a-z_]+ \.\.\.\$|^[a-z_]+ +$counts|^$counts" >"$work/ours" || true
silent() { [ ! -s "$1" ] || { head "$1"; return 1; }; }
check 'fpm test: the counts and nothing else' silent "$work/ours"
finish
