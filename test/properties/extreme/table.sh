#!/bin/sh
# Makes test/properties/extreme/table.md: introduction.md, then what becomes of each case in cases.txt.
root=$(CDPATH= cd -- "$(dirname -- "$0")/../../.." && pwd) || exit
. "$root/app/setup.sh"
cd "$root" && build_check_release || exit
table=$run_dir/limits
"$run_dir/check-release" limits >"$table" || exit
{
  cat test/properties/extreme/introduction.md
  sed '$d' "$table"
  printf '\n%s %s, GNU Fortran %s, %s.\n' "$(tail -n 1 "$table" | sed 's/ The longest.*//')" \
    "$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)" "$(gfortran -dumpfullversion)" "$(date +%Y-%m-%d)"
} >test/properties/extreme/table.md
