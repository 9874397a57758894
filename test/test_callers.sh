#!/bin/sh
# Installs the library, links callers in Fortran 77, C, CMake and fpm against it as doc/linking.md
# says, and compares what they and Python say with the program: sh test/test_callers.sh PROGRAM
# The last line is `N passed, N failed`.
# Takes about 2 min.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
. "$root/test/checks.sh"
need gcc cc g++ cmake make pkg-config ar nm readelf
build_package || exit
program=${1:-$root/build/run/gearsweep}
case $program in /*) ;; *) program=$PWD/$program ;; esac
cd "$work" || exit

# check TITLE COMMAND...: the command must succeed; what it said is shown where it does not.
check() {
  title=$1
  shift
  if "$@" >said 2>&1; then
    pass
  else
    fails "$title"
    tail -n 20 said | sed 's/^/  /'
  fi
}

same() { cmp "$1" "$2" || { diff "$1" "$2" | head -n 4; return 1; }; }
silent() { [ ! -s "$1" ] || { head -n 5 "$1"; return 1; }; }

# block LANGUAGE: the first block of that language in the description.
block() { awk -v start="\`\`\`$1" '$0 == "```" { if (on) exit } on { print } $0 == start { on = 1 }' "$root/doc/linking.md"; }
# line WORD: the command line in the description that begins with this word.
line() { sed -n "s/^    \($1 .*\)/\1/p" "$root/doc/linking.md" | head -n 1; }

# numbers FILE: a table's fields, with the 15 digits that tables have, whatever their form.
numbers() {
  awk -F, -v OFS=, '{ for (i = 1; i <= NF; i++) { gsub(/ /, "", $i)
    if ($i ~ /^[-+]?[0-9.]+([eE][-+]?[0-9]+)?$/) $i = sprintf("%.14e", $i) } print }' "$1"
}
# columns TABLE LIST: these columns of the program's table.
columns() { grep -v '^#' "results/$1.csv" | tail -n +2 | cut -d, -f"$2" | numbers -; }
# rows KIND FILE: what a caller printed of this kind.
rows() { sed -n "s/^$1,//p" "$2" | numbers -; }
# agrees TABLE LIST KIND FILE
agrees() {
  columns "$1" "$2" >theirs
  rows "$3" "$4" >ours
  [ -s theirs ] && same theirs ours
}

# --- install -----------------------------------------------------------------

prefix=$work/installed
install() { sh "$root/app/install.sh" "$prefix" </dev/null; }
check 'install' install
for file in bin/gearsweep lib/libgearsweep.a lib/libgearsweep.so lib/pkgconfig/gearsweep.pc lib/pkgconfig/gearsweep-shared.pc \
  lib/cmake/gearsweep/gearsweepConfig.cmake include/gearsweep/gearsweep.h \
  include/gearsweep/gearsweep.mod include/gearsweep/gearsweep_calls.mod; do
  check "installed: $file" test -s "$prefix/$file"
done
for module in $(find "$root/src" -name "*.f90"); do
  name=$(basename "$module" .f90)
  case $name in gearsweep_flat*) continue ;; esac
  check "installed: $name.mod" test -s "$prefix/include/gearsweep/$name.mod"
done
is_usage() { sh "$root/app/install.sh" "$@"; [ $? = 2 ]; }
check 'install wants a folder' is_usage
check 'install refuses options' is_usage --prefix
# The tree may be moved.
mv "$prefix" "$work/moved" && prefix=$work/moved
export PKG_CONFIG_PATH="$prefix/lib/pkgconfig"
version=$(sed -n 's/^version *= *"\(.*\)"/\1/p' "$root/fpm.toml")
check 'version of the package' test "$(pkg-config --modversion gearsweep)" = "$version"

# --- Fortran 77 and C --------------------------------------------------------

cp "$root"/test/callers/* .
compile() { eval "$1"; }
check 'Fortran 77 compiles and links as described' compile "$(line gfortran) -o legacy"
check 'nothing to warn of' silent said
check 'Fortran 77 runs' compile './legacy >legacy.out 2>legacy.err'
check 'Fortran 77: nothing on stderr' silent legacy.err
check 'C compiles and links as described' compile "$(line cc) -o design"
check 'nothing to warn of' silent said
check 'C runs' compile './design >design.out 2>design.err'
check 'C: nothing on stderr' silent design.err
check 'C gives the bits of Fortran 77' same legacy.out design.out

check 'the program runs that case' "$program" legacy.nml --quiet
check 'mesh as in the table' agrees legacy.mesh 1-7 mesh legacy.out
check 'sweep as in the table' agrees legacy.sweep 1-4,7,8 sweep legacy.out
check 'optimum as in the table' agrees legacy.optimum_curve 1-3 vcurve legacy.out
names() {
  awk -F'[, ]+' 'BEGIN { split("ok marginal subharmonic inexact unstable aperiodic unresolved chatter chaotic", s, " ")
    split("full partial lost coast", c, " ") } /^status/ { print s[$2 + 1] "," c[$3 + 1] "," $4 "," $5 }' legacy.out | numbers - >ours
  columns legacy.sweep 5,6,9,10 >theirs
  same theirs ours
}
check 'status, contact, steps and periods as in the table' names

# --- the border of the C functions -------------------------------------------

flags='-std=c99 -Wall -Wextra -Wpedantic -Werror'
check 'C border compiles' compile "cc $flags border.c \$(pkg-config --cflags --libs gearsweep) -o border"
./border >border.out 2>border.err
check 'C border: nothing on stderr' silent border.err
check 'C border: comes to its end' grep -qx 'end' border.out
grep '^FAILED' border.out
sed -nE 's/^(passed|failed) /&C border: /p' border.out >>"$list"
for door in '' fortran77.c; do
  check "spoilt calls compile $door" compile "cc $flags fuzz.c $door \$(pkg-config --cflags --libs gearsweep) -o fuzz"
  check "spoilt calls $door" ./fuzz .
done

# --- every number of every task, through every door ------------------------------

check 'Fortran 77: results compile' compile 'gfortran results.f $(pkg-config --cflags --libs gearsweep) -o results-f77'
check 'nothing to warn of' silent said
check 'C: results compile' compile "cc $flags results.c \$(pkg-config --cflags --libs gearsweep) -o results-c"
sed -e "s/tasks = .*/tasks = 'geometry', 'section', 'mesh', 'static', 'modal', 'load', 'sweep', 'optimum'/" \
  -e 's/rpm_step = .*/rpm_step = 1400/; s/^&section/& elements_across = 5/' \
  -e 's/^&sweep/\&static positions = 9 \/ \&modal modes = 4 \/ &/' "$root/data/case1.nml" >geared.nml
sed 's/elements_across = .*/elements_across = 6/' "$root/data/hassan.nml" >shares.nml
cp "$root/data/hassan2009.csv" .
cat >prescribed.nml <<'END'
&case tasks = 'mesh', 'load', 'sweep', 'optimum' /
&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.9 /
&load normal_force_n = 6858 / &relief amount_um = 0, 15 /
&mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400, 0, -120 /
&sweep rpm_first = 2000 rpm_last = 16000 rpm_step = 1000 load_rpm = 3000 /
END
# named NAME: what the doors print by this name. tabled TABLE PROGRAM: the same from the rows of a table, by awk.
named() { sed -n "s/^$1,//p" "$case.c" | numbers -; }
tabled() { sed '/^#/d' "results/$case.$1.csv" | awk -F, "NR > 1 $2" | numbers -; }
in_table() {
  named "$1" >ours
  tabled "$2" "$3" >theirs
  [ -s ours ] && same theirs ours
}
# vtu KIND NAME: the values of a field in a grid file, one a line.
vtu() {
  awk -v name="$2" '/<\/DataArray>/ { on = 0 } on { print } /<Points>/ && name == "Points" || index($0, "\"" name "\"") { on = 1 }' \
    "results/$case.$1.vtu" | tr -s ' ' '\n' | sed '/^$/d'
}
# Numbers in grid files have 9 digits.
in_grid() {
  sed -n "s/^$1,//p" "$case.c" | awk "$4" >ours
  vtu "$2" "$3" | awk "$5" >theirs
  [ -s ours ] && same theirs ours
}
said_alike() {
  awk '/,/ && !on && $0 ~ /^[a-z]+\.[a-z_]+,/ { next } { on = 1; print }' "$case.c" >ours
  sed -e 1d -e '/^Time  /,$d' "$case.screen" >theirs
  [ -s ours ] && same theirs ours
}
# What every case with this task must have: name, table, rows by awk.
tables() {
  cat <<'END'
mesh.relief_um mesh { print $1 }
mesh.s mesh { print $2 }
mesh.pair_n_um mesh { print $3 }
mesh.mesh_n_um mesh { print $4 }
mesh.error_um mesh { print $5 }
mesh.share mesh { print $6 }
mesh.ste_um mesh { print $7 }
harmonics.relief_um harmonics && $2 == 0 { print $1 }
harmonics.mean_um harmonics && $2 == 0 { print $3 }
harmonics.estimate_um harmonics && $2 == 0 { print $5 }
harmonics.amplitude_um harmonics && $2 > 0 { print $3 }
harmonics.phase_deg harmonics && $2 > 0 { print $4 }
load.relief_um load { print $1 }
load.rpm load { print $2 }
load.s load { print $3 }
load.pair_load_n load { print $4 }
load.dte_um load { print $6 }
load.periods load { print $8 }
load.pair load { print $9 }
sweep.relief_um sweep && !seen[$1]++ { print $1 }
sweep.rpm sweep && !seen[$2]++ { print $2 }
sweep.dynamic_factor sweep { print $3 }
sweep.estimate sweep { print $4 }
sweep.floquet_modulus sweep { print $7 }
sweep.residual sweep { print $8 }
sweep.steps sweep { print $9 }
sweep.periods sweep { print $10 }
optimum.relief_um optimum_curve { print $1 }
optimum.worst_factor optimum_curve { print $2 }
optimum.rpm optimum_curve { print $3 }
optimum.failed optimum_curve { print $4 }
outline.x_mm outline { print $2 }
outline.y_mm outline { print $3 }
modal.frequency_hz modal { print $2 }
modal.estimate modal { print $3 }
modal.residual modal { print $4 }
modal.rim_share modal { print $5 }
static.relief_um static && !seen[$1]++ { print $1 }
static.s static && !seen[$2]++ { print $2 }
static.radius_mm static && !seen[$2]++ { print $3 }
static.share static && $5 == "drive" { print $4 }
static.sigma_mpa static { print $6 }
static.parts_mpa static { print $7; print $8; print $9 }
END
}
for case in geared shares prescribed; do
  check "$case: the program runs it" compile '"$program" $case.nml >$case.screen'
  check "$case: Fortran 77 runs it" compile './results-f77 <$case.nml >$case.f77'
  check "$case: C runs it" compile './results-c <$case.nml >$case.c'
  check "$case: Python runs it" compile '"$venv/bin/python" results.py $case.nml >$case.python'
  check "$case: C gives the bits of Fortran 77" same "$case.f77" "$case.c"
  check "$case: Python gives the bits of Fortran 77" same "$case.f77" "$case.python"
  check "$case: the same answer" said_alike
  tables >list
  while read -r name table rows; do
    [ -e "results/$case.$table.csv" ] && check "$case: $name as in the table" in_table "$name" "$table" "$rows"
  done <list
  if [ -e "results/$case.section.vtu" ]; then
    round='{ printf "%.8e\n", $1 }'
    nodes=$(named section.x_mm | wc -l)
    metres='{ printf "%.8e\n", $1/1000 }'
    check "$case: x as in the grid" in_grid section.x_mm section Points "$metres" "NR % 3 == 1 $round"
    check "$case: y as in the grid" in_grid section.y_mm section Points "$metres" "NR % 3 == 2 $round"
    check "$case: elements as in the grid" in_grid section.element section connectivity '{ print $1 - 1 }' '{ print $1 }'
    check "$case: teeth as in the grid" in_grid section.tooth section tooth '{ print $1 + 0 }' '{ print $1 }'
    check "$case: a mode shape as in the grid" in_grid modal.shape mode_shapes mode_1 "NR <= 2*$nodes $round" "NR % 3 $round"
  fi
done

# The library prints only through the program.
check 'C++ takes the header' compile 'echo "#include <gearsweep.h>" >header.cpp && g++ -Wall -Wextra -Wpedantic -Werror -fsyntax-only $(pkg-config --cflags gearsweep) header.cpp'
prototypes() {
  tr '\n' ' ' <"$prefix/include/gearsweep/gearsweep.h" | grep -o 'int gsc_[a-z]*([^)]*)' | sed 's/  */ /g; s/(.*//; s/int //' | sort >theirs
  nm "$prefix/lib/libgearsweep.a" 2>/dev/null | sed -n 's/.* T \(gsc_.*\)/\1/p' | sort >ours
  same theirs ours
}
check 'the header has every C function' prototypes
# Where a function with a result of len=: is called, gfortran keeps the length in static memory
# (slen), which callers at once spoil. The modules named are entered by one at a time, or, as
# tables and grids, by none of the calls.
no_static_lengths() {
  mkdir objects && (cd objects && ar x "$prefix/lib/libgearsweep.a" && for object in *.o; do
    case $object in *_reader.f90.o | *_published.f90.o | *_report.f90.o | *_tables.f90.o | *_vtu.f90.o | *_flat.f90.o | *_keys.f90.o | *_output.f90.o) continue ;; esac
    nm "$object" | grep -q ' b slen' && echo "$object keeps text lengths in static memory"
  done) >ours
  silent ours
}
check 'no static text lengths' no_static_lengths
# interfaces FILE: the heads with the dummy arguments of gs_..., a subroutine a line.
interfaces() {
  sed -e ':a' -e '/&$/N; s/&\n *//; ta' "$1" | sed 's/^ *//' | awk '/^subroutine gs_/ { on = 1 }
    on && (/^subroutine/ || /intent\(.*::/) { all = all $0 "; " } /^end subroutine/ { if (on) print all; all = ""; on = 0 }' | sort
}
interfaces_alike() {
  for file in flat flat_run flat_motion flat_body flat_maps; do interfaces "$root/src/doors/gearsweep_$file.f90"; done | sort >theirs
  interfaces "$root/src/doors/gearsweep_calls.f90" >ours
  [ -s theirs ] && same theirs ours
}
check 'the interfaces are those of the subroutines' interfaces_alike

# --- CMake and fpm -----------------------------------------------------------

mkdir cmake && cp design.c cmake && block cmake >cmake/CMakeLists.txt
check 'CMake as described' compile 'cmake -S cmake -B cmake/build -DCMAKE_PREFIX_PATH=$prefix && cmake --build cmake/build'
check 'CMake: the program runs' compile 'cmake/build/design >cmake.out'
check 'CMake: the same bits' same legacy.out cmake.out
# A tiny program in each language, by CMake and by pkg-config, with the static and the shared library.
cat >tiny.c <<'END'
#include <gearsweep.h>
#include <stdio.h>
int main(void)
{
  char version[32], message[200];
  if (gsc_version(version, sizeof version, message, sizeof message) != GSC_OK) return 1;
  printf("version %s\n", version);
  return 0;
}
END
cp tiny.c tiny.cpp
cat >tiny.f90 <<'END'
program tiny
  use gearsweep_calls, only: gs_version
  implicit none
  character(20) :: found, message
  integer :: info

  call gs_version(found, info, message)
  print '(a)', 'version '//trim(found)
end program tiny
END
# tiny_runs PROGRAM KIND: it says the version, and needs the shared library exactly where it is linked with that.
tiny_runs() {
  [ "$("$1")" = "version $version" ] || return
  ldd "$1" >needed
  if [ "$2" = shared ]; then grep -q "libgearsweep.so.${version%.*} => $prefix/" needed; else ! grep -q libgearsweep needed; fi
}
by_cmake() {
  folder=tiny-$1-$3
  mkdir -p "$folder" && cp "tiny.$2" "$folder" && block cmake | sed "s/design C)/design $1)/; s/design\.c/tiny.$2/" >"$folder/CMakeLists.txt" &&
    cmake -S "$folder" -B "$folder/build" -DCMAKE_PREFIX_PATH="$prefix" -DBUILD_SHARED_LIBS="$4" && cmake --build "$folder/build" &&
    tiny_runs "$folder/build/design" "$3"
}
by_pkg_config() { $1 "tiny.$2" $(pkg-config --cflags --libs "$4") -o "tiny-$2-$3" && tiny_runs "./tiny-$2-$3" "$3"; }
for kind in static shared; do
  on=OFF module=gearsweep
  [ $kind = static ] || on=ON module=gearsweep-shared
  check "CMake: C, $kind" by_cmake C c $kind $on
  check "CMake: C++, $kind" by_cmake CXX cpp $kind $on
  check "CMake: Fortran, $kind" by_cmake Fortran f90 $kind $on
  check "pkg-config: C, $kind" by_pkg_config cc c $kind $module
  check "pkg-config: C++, $kind" by_pkg_config g++ cpp $kind $module
  check "pkg-config: Fortran, $kind" by_pkg_config gfortran f90 $kind $module
done
too_new() { block cmake | sed 's/gearsweep 0.1/gearsweep 0.2/' >cmake/CMakeLists.txt && ! cmake -S cmake -B cmake/new -DCMAKE_PREFIX_PATH="$prefix"; }
check 'CMake: another minor version is refused' too_new
check 'the shared library has its SONAME' compile 'readelf -d "$prefix/lib/libgearsweep.so" | grep -q "SONAME.*libgearsweep.so.${version%.*}\]"'
mkdir -p fpm/app && ln -s "$root" fpm/gearsweep && block toml >fpm/fpm.toml
cat >fpm/app/main.f90 <<'END'
program design
  use gearsweep, only: version
  use gearsweep_calls, only: gs_version
  implicit none
  character(20) :: found, message
  integer :: info

  call gs_version(found, info, message)
  if (info == 0 .and. found == version) print '(a)', 'version '//trim(found)
end program design
END
check 'fpm as described' compile "(cd fpm && '$root/.venv/bin/fpm' run --profile release >../fpm.out)"
check 'fpm: the program runs' grep -qx "version $version" fpm.out

finish
