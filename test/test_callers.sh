#!/bin/sh
# Installs the library, links callers in Fortran 77, C, CMake and fpm against it as doc/linking.md
# says, and compares what they print with the program: sh test/test_callers.sh PROGRAM
# The last line is `N passed, N failed`.
export LC_ALL=C
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
program=${1:-$root/build/run/gearsweep}
case $program in /*) ;; *) program=$PWD/$program ;; esac
work=$(mktemp -d "${TMPDIR:-/tmp}/gearsweep.XXXXXX") || exit
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
cd "$work" || exit
passed=0
failed=0

fails() {
  failed=$((failed + 1))
  printf 'FAILED: %s\n' "$1"
}

# check TITLE COMMAND...: the command must succeed; what it said is shown where it does not.
check() {
  title=$1
  shift
  if "$@" >said 2>&1; then
    passed=$((passed + 1))
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
for file in bin/gearsweep lib/libgearsweep.a lib/pkgconfig/gearsweep.pc include/gearsweep/gearsweep.h \
  include/gearsweep/gearsweep.mod include/gearsweep/gearsweep_calls.mod; do
  check "installed: $file" test -s "$prefix/$file"
done
for module in "$root"/src/*.f90 "$root"/src/*/*.f90; do
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
check 'optimum as in the table' agrees legacy.vcurve 1-3 vcurve legacy.out
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
sed '$d' border.out
counts=$(tail -n 1 border.out)
case $counts in
  *' passed, '*' failed')
    passed=$((passed + ${counts%% *}))
    counts=${counts% failed}
    failed=$((failed + ${counts##* }))
    ;;
  *) fails 'C border: broke off' ;;
esac
check 'spoilt calls compile' compile "cc $flags fuzz.c \$(pkg-config --cflags --libs gearsweep) -o fuzz"
check 'spoilt calls' ./fuzz
cat >other.nml <<'END'
&case tasks = 'mesh', 'load', 'static', 'modal', 'section' /
&pair module_mm = 3 face_width_mm = 20 /
&pinion teeth = 21 effective_mass_kg = 0.5 /
&gear teeth = 34 effective_mass_kg = 0.9 /
&load normal_force_n = 4000 /
&relief amount_um = 0, 10 /
&section elements_across = 6 /
&static positions = 9 /
&modal modes = 6 /
&sweep load_rpm = 4000, 6000 /
END
check 'the other results' compile './border other.nml >other.out'
check 'the program runs that case too' compile '"$program" other.nml >screen'
check 'modes as in the table' agrees other.modes 1-5 modes other.out
check 'outlines as in the table' agrees other.outline 1-3 outline other.out
# vtu ENDING NAME COMPONENTS: the values of a field in the grid file, a node or element a line.
vtu() { awk -v name="Name=\"$2\"" '/<\/DataArray>/ { on = 0 } on { print } /<Points>/ { if (name ~ /points/) on = 1 }
  index($0, name) { on = 1 }' "results/$1.vtu" | tr -s ' ' ',' | sed 's/,$//; s/^,//'; }
like_grid() {
  vtu "$1" "$2" | cut -d, -f"$3" | awk -F, -v OFS=, '{ for (i = 1; i <= NF; i++) if ($i ~ /E/) $i = sprintf("%.8e", $i); print }' >theirs
  sed -n "s/^$4,//p" other.out >ours
  [ -s ours ] && same theirs ours
}
check 'nodes as in the grid' like_grid other.section points 1,2 node
check 'elements as in the grid' like_grid other.section connectivity 1-8 element
check 'mode shape as in the grid' like_grid other.modes mode_1 1,2 shape
check 'teeth as in the grid' like_grid other.section tooth 1 tooth
check 'harmonics as in the table' agrees other.harmonics 1-5 harmonics other.out
check 'root stress as in the table' agrees other.root 1-9 root other.out
check 'pair loads as in the table' agrees other.load 1-4,6 load other.out
said_alike() {
  sed '1,/^report$/d' other.out >ours
  sed -e 1d -e '/^Time  /,$d' screen >theirs
  same theirs ours
}
check 'the report as on the screen' said_alike

# The library prints only through the program.
check 'C++ takes the header' compile 'if command -v g++ >/dev/null; then
  echo "#include <gearsweep.h>" >header.cpp && g++ -Wall -Wextra -Wpedantic -Werror -fsyntax-only $(pkg-config --cflags gearsweep) header.cpp
fi'
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
# interfaces FILE: the heads and dummy arguments of gs_..., one a line.
interfaces() {
  sed -e ':a' -e '/&$/N; s/&\n *//; ta' "$1" | sed 's/^ *//' | awk '/^subroutine gs_/ { on = 1 }
    on && (/^subroutine/ || /intent\(.*::/) { print } /^end subroutine/ { on = 0 }'
}
interfaces_alike() {
  for file in flat flat_motion flat_body flat_maps; do interfaces "$root/src/doors/gearsweep_$file.f90"; done >theirs
  interfaces "$root/src/doors/gearsweep_calls.f90" >ours
  [ -s theirs ] && same theirs ours
}
check 'the interfaces are those of the subroutines' interfaces_alike

# --- CMake and fpm -----------------------------------------------------------

if command -v cmake >/dev/null; then
  mkdir cmake && cp design.c cmake && block cmake >cmake/CMakeLists.txt
  check 'CMake as described' compile 'cmake -S cmake -B cmake/build && cmake --build cmake/build'
  check 'CMake: the program runs' compile 'cmake/build/design >cmake.out'
  check 'CMake: the same bits' same legacy.out cmake.out
fi
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

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
