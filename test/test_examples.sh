#!/bin/sh
# The examples in each language, compiled and run as examples/README.md says: sh test/test_examples.sh PROGRAM
# What they print must be what the program's own table has. The last line is `N passed, N failed`.
# Takes about 1 min.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
. "$root/test/checks.sh"
need cc pkg-config
build_package || exit
program=${1:-$root/build/run/gearsweep}
case $program in /*) ;; *) program=$PWD/$program ;; esac

# check TITLE COMMAND...: the command must succeed; what it said is shown where it does not.
check() {
  title=$1
  shift
  if "$@" >"$work/said" 2>&1; then
    pass
  else
    fails "$title"
    tail -n 20 "$work/said" | sed 's/^/  /'
  fi
}

check 'the library installs' sh "$root/app/install.sh" "$work/installed"
export PKG_CONFIG_PATH="$work/installed/lib/pkgconfig"
cp "$root"/examples/first.* "$work" && cd "$work" || exit
# command WORD: the line of the page that begins with this word.
command_of() { sed -n "s/^    \($1 .*\)/\1/p" "$root/examples/README.md" | head -n 1; }

check 'the program runs the case' "$program" first.nml --quiet
# By awk from the CSV, whose columns are found by their names.
awk -F, '/^#/ { next } !named { for (i = 1; i <= NF; i++) at[$i] = i; named = 1; next }
  { printf "%5.1f um: worst dynamic factor%8.4f at%8.1f rpm\n", $at["relief_um"], $at["worst_dynamic_factor"], $at["rpm"] }' \
  results/first.sweep_worst.csv >expected
check 'the table has a row for each relief' test "$(wc -l <expected)" = 3
same() { cmp expected "$1" || { diff expected "$1"; return 1; }; }
for language in 'first.f90:gfortran first.f90' 'first.f:gfortran first.f' 'first.c:cc first.c'; do
  file=${language%%:*}
  check "$file compiles without a warning" sh -c "$(command_of "${language#*:}") -Wall -Wextra -Werror -o run-$file"
  ./"run-$file" >"$file.out" 2>&1
  check "$file prints what the program's table has" same "$file.out"
done
"$venv/bin/python" first.py >first.py.out 2>&1
check "first.py prints what the program's table has" same first.py.out
sed -n 's/^    \(.* um: worst dynamic factor .*\)/\1/p' "$root/examples/README.md" >page
check 'the page shows what they print' same page
finish
