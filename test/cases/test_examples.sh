#!/bin/sh
# The examples in each language, compiled and run as examples/README.md says: sh test/cases/test_examples.sh PROGRAM
# What they print must be what the program's own table has; of plain.f90 also what ISO 1328-1 has. The last line is `N passed, N failed`.
# Takes about 1 min.
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd) || exit
. "$root/test/checks.sh"
need cc g++ pkg-config
build_package || exit
program=${1:-$root/build/run/gearsweep}
case $program in /*) ;; *) program=$PWD/$program ;; esac

check 'the library installs' sh "$root/app/install.sh" "$work/installed"
export PKG_CONFIG_PATH="$work/installed/lib/pkgconfig"
cp "$root"/examples/first.* "$root"/examples/plain.f90 "$work" && cd "$work" || exit
# command WORD: the line of the page that begins with this word.
command_of() { sed -n "s/^    \($1 .*\)/\1/p" "$root/examples/README.md" | head -n 1; }

check 'the program runs the case' "$program" first.nml --quiet
# By awk from the CSV, whose columns are found by their names.
awk -F, '/^#/ { next } !named { for (i = 1; i <= NF; i++) at[$i] = i; named = 1; next }
  { printf "%5.1f um: worst dynamic factor%8.4f at%8.1f rpm\n", $at["relief_um"], $at["worst_dynamic_factor"], $at["rpm"] }' \
  results/first.sweep_worst.csv >expected
check 'the table has a row for each relief' test "$(wc -l <expected)" = 3
same() { cmp expected "$1" || { diff expected "$1"; return 1; }; }
for language in 'first.f90:gfortran first.f90' 'first.f:gfortran first.f' 'first.c:cc first.c' 'first.cpp:g++ first.cpp'; do
  file=${language%%:*}
  check "$file compiles without a warning" sh -c "$(command_of "${language#*:}") -Wall -Wextra -Werror -o run-$file"
  ./"run-$file" >"$file.out" 2>&1
  check "$file prints what the program's table has" same "$file.out"
done
"$venv/bin/python" first.py >first.py.out 2>&1
check "first.py prints what the program's table has" same first.py.out

# Plain calls. The tolerances of class 6 are ISO 1328-1:2013's: sqrt(2) times those of class 5, rounded to 0.5 um up to 10 um, else to 1.
awk 'function rounded(x) { return x > 10 ? int(x + 0.5) : int(2*x + 0.5)/2 }
  BEGIN { m = 3; d = 21*m; c = sqrt(2); printf "class 6, um: f_p, F_p and f_Halpha of the pinion %.1f %.1f %.1f\n",
    rounded(c*(0.001*d + 0.4*m + 5)), rounded(c*(0.002*d + 0.55*sqrt(d) + 0.7*m + 12)), rounded(c*(0.4*m + 0.001*d + 4)) }' >plain.expected
# The rest the program has of the same gears by a case: this says that the calls are joined rightly, not that they are right.
gears="&pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 / &gear teeth = 34 / &load normal_force_n = 3000 /
&mesh model = 'weber' corner_contact = .false. / &dynamics damping_ratio = 0.1 /
&sweep rpm_first = 3000 rpm_last = 9000 rpm_step = 3000 /"
# column TABLE NAME: its numbers, in the rows whose first field is WORD, if one is given.
column() {
  awk -F, -v name="$2" -v word="${3-}" '/^#/ { next } !at { for (i = 1; i <= NF; i++) if ($i == name) at = i; next }
    word == "" || $1 == word { print $at }' "results/plain.$1.csv"
}
printf '%s\n' "$gears" "&case tasks = 'deflection_relief' /" >plain.nml
check 'the program finds the relief' "$program" plain.nml --quiet
pinion=$(column deflection_relief pinion_relief_um markovic_vrcan)
gear=$(column deflection_relief gear_relief_um markovic_vrcan)
printf 'relief by deflection, um: pinion and gear %.3f %.3f\n' "$pinion" "$gear" >>plain.expected
printf '%s\n' "$gears" "&case tasks = 'sweep', 'rating' /" "&relief amount_um = $pinion gear_fraction = $(awk "BEGIN { printf \"%.15g\", $gear/$pinion }") /" \
  "&rating rpm = 9000 dynamic_factor_method = 'a' contact_limit_mpa = 1500 root_limit_mpa = 900 /" >plain.nml
check 'the program rates the gears' "$program" plain.nml --quiet
{
  printf 'dynamic factor at 3000, 6000 and 9000 1/min %.4f %.4f %.4f\n' $(column sweep dynamic_factor)
  printf 'S_H of pinion and gear for 1500 MPa at 9000 1/min %.3f %.3f\n' $(column rating contact_safety)
  printf 'S_F for 900 MPa %.3f %.3f\n' $(column rating root_safety)
} >>plain.expected
check 'plain.f90 compiles without a warning' sh -c "$(command_of 'gfortran plain.f90') -Wall -Wextra -Werror -o run-plain"
./run-plain >plain.out 2>&1
check 'plain.f90 prints what ISO 1328-1 and the tables have' sh -c 'cmp plain.expected plain.out || { diff plain.expected plain.out; false; }'
sed -n 's/^    \(.* um: worst dynamic factor .*\)/\1/p' "$root/examples/README.md" >page
check 'the page shows what they print' same page
finish
