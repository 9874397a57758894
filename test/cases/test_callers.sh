#!/bin/sh
# Installs the library, links callers in Fortran 77, C, CMake and fpm against it as doc/linking.md
# says, and compares what they and Python say with the program: sh test/cases/test_callers.sh PROGRAM
# The last line is `N passed, N failed`.
# Takes about 2 min.
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd) || exit
. "$root/test/checks.sh"
need gcc cc g++ cmake make pkg-config ar nm readelf
build_package || exit
program=${1:-$root/build/run/gearsweep}
case $program in /*) ;; *) program=$PWD/$program ;; esac
cd "$work" || exit

same() { cmp "$1" "$2" || { diff "$1" "$2" | head -n 4; return 1; }; }
silent() { [ ! -s "$1" ] || { head -n 5 "$1"; return 1; }; }

# block LANGUAGE: the first block of that language in the description.
block() { awk -v start="\`\`\`$1" '$0 == "```" { if (on) exit } on { print } $0 == start { on = 1 }' "$root/doc/linking.md"; }
# line WORD: the command line in the description that begins with this word.
line() { sed -n "s/^    \($1 .*\)/\1/p" "$root/doc/linking.md" | head -n 1; }

# --- install -----------------------------------------------------------------

prefix=$work/installed
install() { sh "$root/app/install.sh" "$prefix" </dev/null; }
check 'install' install
for file in bin/gearsweep lib/libgearsweep.a lib/libgearsweep.so lib/pkgconfig/gearsweep.pc lib/pkgconfig/gearsweep-shared.pc \
  lib/cmake/gearsweep/gearsweepConfig.cmake include/gearsweep/gearsweep.h share/bash-completion/completions/gearsweep \
  include/gearsweep/gearsweep.mod; do
  check "installed: $file" test -s "$prefix/$file"
done
for name in $(find "$root/src" -name "*.f90" -exec sed -n 's/^module \(gearsweep[a-z0-9_]*\)$/\1/p' {} +); do
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

cp "$root"/tools/callers/* "$root"/examples/first.* .
# compile COMMAND: its output, with the warnings, is also in the file `compiled`.
compile() { eval "$1" >compiled 2>&1 || { cat compiled; return 1; }; }
printf 'int main(void) { int unused; return 0; }\n' >warned.c
warns() { compile 'cc -Wall warned.c -o warned' && ! silent compiled; }
check 'a warning is found' warns
for language in Fortran:gfortran C:cc; do
  check "${language%:*} compiles and links as described" compile "$(line "${language#*:}") -o first"
  check "${language%:*}: nothing to warn of" silent compiled
  check "${language%:*} runs" compile "./first >first.${language#*:} 2>first.err"
  check "${language%:*}: nothing on stderr" silent first.err
done
check 'C says what Fortran 77 says' same first.gfortran first.cc
flags='-std=gnu99 -Wall -Wextra -Wpedantic -Werror'
check 'spoilt calls compile' compile "cc $flags fuzz.c \$(pkg-config --cflags --libs gearsweep) -o fuzz"
check 'spoilt calls' ./fuzz .

# --- every column of every table, in every language ----------------------------------

check 'Fortran 77: results compile' compile 'gfortran results.f $(pkg-config --cflags --libs gearsweep) -o results-f77'
check 'Fortran 77, results: nothing to warn of' silent compiled
check 'C: results compile' compile "cc $flags results.c \$(pkg-config --cflags --libs gearsweep) -o results-c"
sed -e "s/tasks = .*/tasks = 'geometry', 'mesh', 'static', 'modal', 'load', 'sweep', 'optimum', 'precision'/" \
  -e 's/rpm_step = .*/rpm_step = 1400/; s/^&section/& elements_across = 5/' \
  -e 's/^&sweep/\&static positions = 9 \/ \&modal modes = 4 \/ \&precision most_steps = 100 most_elements = 4 \/ &/' "$root/data/case1.nml" >geared.nml
sed 's/elements_across = .*/elements_across = 6/' "$root/data/hassan.nml" >shares.nml
cp "$root/data/hassan2009.csv" .
cat >prescribed.nml <<'END'
&case tasks = 'mesh', 'load', 'sweep', 'optimum' /
&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.9 /
&load normal_force_n = 6858 / &relief amount_um = 0, 15 /
&mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400, 0, -120 /
&sweep rpm_first = 2000 rpm_last = 16000 rpm_step = 1000 load_rpm = 3000 /
END
# Callers print column after column, a line each with table, column and value; of run times table and column alone. In the
# program's tables, which those of nodes and elements are not among, numbers have 15 digits, and fields in quotation marks may
# have commas; an apostrophe in front keeps spreadsheets from computing.
cat >tabled.py <<'END'
import csv, os, re, sys
def plain(word):
    return f'{float(word):.14e}' if re.fullmatch(r' *(nan|[-+]?[0-9.]+(e[-+]?[0-9]+)?) *', word, re.I) else word
ours, count = {}, 0
for line in open(f'{sys.argv[1]}.c'):
    if found := re.fullmatch(r'([a-z_]+)\.([a-z_0-9]+)(?:,(.*))?\n', line):
        ours.setdefault(found[1], {}).setdefault(found[2], []).append(found[3])
for table, columns in ours.items():
    if os.path.exists(path := f'results/{sys.argv[1]}.{table}.csv'):
        head, *rows = csv.reader(line for line in open(path) if not line.startswith('#'))
        assert head == list(columns), table
        for i, (name, mine) in enumerate(columns.items()):
            count += len(mine)
            assert mine == [None] or list(map(plain, mine)) == [plain(row[i].removeprefix(chr(39))) for row in rows], (table, name)
assert count > 300
END
in_tables() { "$venv/bin/python" tabled.py "$case"; }
# The nodes of the grid file, whose numbers have 9 digits.
in_grid() {
  "$venv/bin/python" - "$case" <<'END'
import re, sys
points = re.search('<Points>.*?<DataArray.*?>(.*?)</DataArray>', open(f'results/{sys.argv[1]}.mode_shapes.vtu').read(), re.S)[1].split()
for i, axis in enumerate('xy'):
    ours = [float(line.split(',')[1]) / 1000 for line in open(f'{sys.argv[1]}.c') if line.startswith(f'nodes.{axis}_mm,')]
    assert ours and [f'{x:.8e}' for x in ours] == [f'{float(x):.8e}' for x in points[i::3]], axis
END
}
# Behind the report stand the log of the second run and its files.
said_alike() {
  sed -e 1d -e '/^Time  /,$d' "$case.screen" >theirs
  grep -Ev '^[a-z_]+\.[a-z_0-9]+(,|$)' "$case.c" | head -n "$(wc -l <theirs)" >ours
  [ -s ours ] && same theirs ours
}
# Fortran 77's lines end in blanks. Tables with run times, which callers print without their values, differ from run to run.
same_files() { diff -rZ $(sed -n 's/^\([a-z_]*\)\.[a-z_0-9]*$/-x *.\1.csv/p' "$case.c") "f77.$case" written; }
# The rounded run times of the task precision differ, too.
timeless() { sed -E '/^Precision at/,/^ *$/s/^(   .*[^ ]) +[0-9]+ (us|ms|s) *$/\1/' "$1" >timeless && cp timeless "$1"; }
for case in geared shares prescribed; do
  check "$case: the program runs it" compile '"$program" $case.nml >$case.screen && timeless $case.screen'
  check "$case: Fortran 77 runs it" compile './results-f77 $case <$case.nml >$case.f77 && timeless $case.f77 && cp -r written f77.$case'
  check "$case: C runs it" compile './results-c $case <$case.nml >$case.c && timeless $case.c'
  check "$case: Python runs it" compile '"$venv/bin/python" results.py $case.nml $case >$case.python && timeless $case.python'
  check "$case: C gives the bits of Fortran 77" same "$case.f77" "$case.c"
  check "$case: Python gives the bits of Fortran 77" same "$case.f77" "$case.python"
  check "$case: the same files" same_files
  check "$case: the same report" said_alike
  check "$case: every column as in the tables" in_tables
  [ ! -e "results/$case.mode_shapes.vtu" ] || check "$case: nodes as in the grid" in_grid
done

check 'C++ takes the header' compile 'echo "#include <gearsweep.h>" >header.cpp && g++ -Wall -Wextra -Wpedantic -Werror -fsyntax-only $(pkg-config --cflags gearsweep) header.cpp'
prototypes() {
  tr '\n' ' ' <"$prefix/include/gearsweep/gearsweep.h" | grep -o '\(int\|void\) gsc_[a-z]*([^)]*);' | sed 's/(.*//; s/.* //' | sort >theirs
  nm "$prefix/lib/libgearsweep.a" 2>/dev/null | sed -n 's/.* T \(gsc_.*\)/\1/p' | sort >ours
  same theirs ours
}
check 'the header has every C function' prototypes
# Where a function with a result of len=: is called, gfortran keeps the length in static memory
# (slen), which callers at once spoil. The modules named are entered by one at a time, or, as
# tables and grids, by none of the calls.
no_static_lengths() {
  mkdir objects && (cd objects && ar x "$prefix/lib/libgearsweep.a" && for object in *.o; do
    case $object in *_reader.f90.o | *_published.f90.o | *_keys.f90.o | *_vtu.f90.o) continue ;; esac
    nm "$object" | grep -q ' b slen' && echo "$object keeps text lengths in static memory"
  done) >ours
  silent ours
}
check 'no static text lengths' no_static_lengths

# What a C++ caller may do besides examples/first.cpp. Each row has the bits of its own run; a study outlives the one that it was copied from.
cat >caller.cpp <<'END'
#include <gearsweep.hpp>
#include <cassert>
#include <cstdio>
static std::string with(double torque) {
  return "&case tasks = 'sweep' / &pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 / &gear teeth = 34 / &load torque_nm = " +
    std::to_string(torque) + " / &mesh model = 'weber' / &sweep rpm_first = 3000 rpm_last = 6000 rpm_step = 1000 /";
}
template <class Call> static int code_of(Call call) {
  try { call(); } catch (const gearsweep::error &error) { return *error.what() ? error.code : -1; }
  return 0;
}
int main() {
  auto copy = [] { gearsweep::study study(with(80)); return gearsweep::study(study); }();
  const std::vector<double> factor = copy.column("sweep", "dynamic_factor");
  assert(factor.size() == 4 && factor == gearsweep::study(with(80), "", 1, &copy).column("sweep", "dynamic_factor"));
  std::vector<double> both = factor, other = gearsweep::study(with(120)).column("sweep", "dynamic_factor");
  both.insert(both.end(), other.begin(), other.end());
  assert(factor != other && both == gearsweep::study::rows(with(100), "load.torque_nm", 2, {80, 120}, "sweep.dynamic_factor").column("sweep", "dynamic_factor"));
  assert(copy.text("case") == with(80) && copy.text("report").find("Dynamic factor") != std::string::npos);
  const std::string word = copy.words("sweep", "status").at(3);
  char theirs[40];
  gearsweep::ask(gsc_words, copy.get(), "sweep", "status", 3, theirs, sizeof theirs);
  assert(word != "" && word == theirs);
  assert(code_of([] { gearsweep::study study("&case tasks = 'swep' /"); }) == GSC_INPUT);
  assert(code_of([&] { copy.column("sweep", "no_such"); }) == GSC_INPUT);
  assert(code_of([&] { copy.text("no such"); }) == GSC_INPUT);
  std::puts("done");
}
END
check 'C++: the caller compiles, without a warning' compile 'g++ -std=c++11 -Wall -Wextra -Wpedantic -Werror caller.cpp $(pkg-config --cflags --libs gearsweep) -o caller'
check 'C++: studies, rows, words, texts, errors' compile '[ "$(./caller)" = done ]'

# --- CMake and fpm -----------------------------------------------------------

mkdir cmake
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
sed "s/gearsweep\.h/gearsweep.hpp/" tiny.c >tiny.cpp
cat >tiny.f90 <<'END'
program tiny
  use gearsweep, only: case_t, error_t, read_case, version
  implicit none
  type(case_t) :: case
  type(error_t), allocatable :: error

  call read_case('&case tasks = ''none'' /', case, error)
  if (allocated(error)) print '(a)', 'version '//version
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
  mkdir -p "$folder" && cp "tiny.$2" "$folder" && block cmake | sed "s/first C)/first $1)/; s/first\.c/tiny.$2/" >"$folder/CMakeLists.txt" &&
    cmake -S "$folder" -B "$folder/build" -DCMAKE_PREFIX_PATH="$prefix" -DBUILD_SHARED_LIBS="$4" && cmake --build "$folder/build" &&
    tiny_runs "$folder/build/first" "$3"
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
too_new() { block cmake | sed "s/gearsweep ${version%.*}/gearsweep ${version%%.*}.99/" >cmake/CMakeLists.txt && grep -q '\.99 REQUIRED' cmake/CMakeLists.txt && ! cmake -S cmake -B cmake/new -DCMAKE_PREFIX_PATH="$prefix"; }
check 'CMake: another minor version is refused' too_new
check 'the shared library has its SONAME' compile 'readelf -d "$prefix/lib/libgearsweep.so" | grep -q "SONAME.*libgearsweep.so.${version%.*}\]"'
# Builds all anew, which mutants (tools/mutation) have no time for.
if [ "${builds_anew-yes}" = yes ]; then
  mkdir -p fpm/app && ln -s "$root" fpm/gearsweep && block toml >fpm/fpm.toml
  cp tiny.f90 fpm/app/main.f90
  check 'fpm is there' install_fpm
  check 'fpm as described' compile "(cd fpm && '$root/.venv/bin/fpm' run --profile release >../fpm.out)"
  check 'fpm: the program runs' grep -qx "version $version" fpm.out
fi

finish
