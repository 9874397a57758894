#!/bin/sh
# Builds the library and the program in several ways, runs the cases of data/ with each, and compares all tables and
# the screen with those of the released build, by test/cases/compare.py: sh test/cases/matrix.sh [BUILD ...]
#
#   release   as released (app/build.py): what the others are compared with
#   O0, O2    without optimisation, with less than released
#   native    -O3 -march=native: with all that this processor can, fused multiply and add among it
#   plain     -O3 -fno-frontend-optimize: gfortran's front end may take two calls for one
#   flang     by flang 19, another compiler; installed by this command where it is missing (Debian)
#
# Without a name, all. --quick: O0 and plain, with two cases that name every task between them (a part of test/run.sh).
# The last line is `N passed, N failed`: one check for each build and case, and one for each build.
# About 8 minutes on two cores, mostly to compile; --quick 1 minute.
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd) || exit
. "$root/app/setup.sh"
cases=
builds=
for word; do
  case $word in
    --quick) cases='case2 hassan' builds='O0 plain' ;;
    O0 | O2 | native | plain | flang) builds="$builds $word" ;;
    *) echo "usage: sh test/cases/matrix.sh [--quick | O0 O2 native plain flang ...]" >&2; exit 2 ;;
  esac
done
: "${builds:=O0 O2 native plain flang}"
: "${cases:=$(cd "$root/data" && ls *.nml | sed 's/\.nml$//')}"
cd "$root" || exit
mkdir -p "$run_dir" || exit
work=$(mktemp -d "${TMPDIR:-/tmp}/gearsweep.XXXXXX") || exit
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
passed=0
failed=0

# The released flags of most files. A call of a function that is not pure and may be left out stops the build.
released='-O3 -funroll-loops'
warned='-Wfunction-elimination -Werror=function-elimination'
make_release() { build_program; }
make_gfortran() { build "matrix-$1" program "matrix-$1" --flags="$2"; }
make_O0() { make_gfortran O0 -O0; }
make_O2() { make_gfortran O2 "-O2 $warned"; }
make_native() { make_gfortran native "$released -march=native $warned"; }
make_plain() { make_gfortran plain "$released -fno-frontend-optimize"; }
# From the start, as fpm takes stale modules for current ones.
make_flang() {
  rm -rf "$root"/build/flang-*
  install_fpm && install_flang && quietly "building with flang, about 2 min" "$venv/bin/fpm" run gearsweep --compiler "$flang" \
    --c-compiler gcc --flag "-O2 -fPIC" --runner echo && cp "$(sed -n 's|^\(build/[^ ]*\) *$|\1|p' "$log" | tail -n 1)" "$run_dir/matrix-flang"
}

# run PROGRAM FOLDER: all cases; tables, screen and exit code go into the folder.
run() {
  mkdir "$work/$2" || return
  for one in $cases; do
    "$1" "data/$one.nml" --out "$work/$2" >"$work/$2/$one.txt" 2>"$work/$2/$one.err" </dev/null
    echo $? >"$work/$2/$one.code"
  done
}

count() { if [ "$1" = 0 ]; then passed=$((passed + 1)); else failed=$((failed + 1)); fi; }

# Not in a pipe or a subshell: the builds share a lock and the log.
if ! make_release; then echo "0 passed, 1 failed"; exit 1; fi
run "$run_dir/gearsweep" release
for one in $cases; do
  # A case that breaks off would compare as equal.
  [ "$(cat "$work/release/$one.code")" = 0 ] || { echo "$one ends with code $(cat "$work/release/$one.code")"; cat "$work/release/$one.err"; count 1; }
done
echo 'Numbers that differ from the released build, and the largest deviation over what is allowed (test/cases/compare.py)'
for way in $builds; do
  make_$way
  code=$?
  count $code
  echo "-- $way"
  [ $code = 0 ] || { echo "  FAILED to build"; continue; }
  if [ "$way" = O0 ] && cmp -s "$run_dir/gearsweep" "$run_dir/matrix-O0"; then
    echo "  FAILED: the build without optimisation is the released one"
    count 1
  fi
  run "$run_dir/matrix-$way" "$way"
  echo 'case         values   differ   over allowed   where'
  for one in $cases; do
    "$venv/bin/python" test/cases/compare.py "$work/release" "$work/$way" "$one"
    count $?
    rm -f "$work/$way/$one".*
  done
done
echo "$passed passed, $failed failed"
[ "$failed" = 0 ] && [ "$passed" -gt 0 ]
