#!/bin/sh
# Drives the program as a user does: sh test/cases/test_program.sh PROGRAM
# The last line is `N passed, N failed`.
# Takes about 1 min.
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd) || exit
program=${1:-$root/build/run/gearsweep}
case $program in /*) ;; *) program=$PWD/$program ;; esac
. "$root/test/checks.sh"
need timeout python3 setpriv
cd "$work" || exit
limit='timeout 120'

# --- tools -------------------------------------------------------------------

# run ARGUMENTS...: runs the program; leaves $code, stdout and stderr.
run() {
  $limit "$program" "$@" >stdout 2>stderr </dev/null
  code=$?
}

# edit SED: the base case, edited, as case.nml.
edit() { sed "$1" base.nml >case.nml; }

exits() { [ "$code" = "$1" ] || { echo "  exit code $code, not $1: $(head -c 300 stderr)"; return 1; }; }
silent() { [ ! -s "$1" ] || { echo "  $1: $(head -n 3 "$1")"; return 1; }; }
says() { grep -qF -- "$2" "$1" || { echo "  $1 lacks: $2"; return 1; }; }
lacks() { ! grep -qF -- "$2" "$1" || { echo "  $1 has: $2"; return 1; }; }
no_files_in() { [ -z "$(find "$1" ! -type d 2>/dev/null)" ] || { echo "  left: $(find "$1" ! -type d)"; return 1; }; }
same() { cmp -s "$1" "$2" || { echo "  $1 and $2 differ"; return 1; }; }
files_in() { (cd "$1" && LC_ALL=C ls -A | tr '\n' ' '); }
# named NAME TABLE...: the files of these tables, as files_in has them; one with an ending of its own keeps it.
named() {
  of=$1
  shift
  for table; do
    case $table in *.*) echo "$of.$table" ;; *) echo "$of.$table.csv" ;; esac
  done | LC_ALL=C sort | tr '\n' ' '
}
pair_tables='geometry gears contact_points'
sweep_tables='sweep sweep_worst resonances sweep_summary'
motion_tables="motion mesh transmission_error harmonics load load_points motion_harmonics $sweep_tables optimum optimum_curve"
# Over the torque, which a mesh without a base pitch does not know.
torque_tables='optimum_loads optimum_map'
geared_tables="$pair_tables $motion_tables $torque_tables"
static_tables='section static root_stress root_rating'
modal_tables='section modal mode_energy mode_shapes.vtu'
rows() { grep -v '^#' "$1" | tail -n +2; }
columns() { grep -v '^#' "$1" | head -n 1; }

# is_one_error TEXT CODE: exit code, one line on stderr that has the text, nothing on stdout.
is_one_error() {
  exits "$2" && silent stdout || return
  [ "$(wc -l <stderr)" -eq 1 ] || { echo "  not one line: $(head -n 5 stderr)"; return 1; }
  case $(cat stderr) in
    'gearsweep: '*) says stderr "$1" ;;
    *) echo "  not ours: $(cat stderr)"; return 1 ;;
  esac
}

refused() { is_one_error "$1" "$2" && no_files_in out; }

# refuses TEXT CODE SED: the edited base case must be refused with this text and leave no file.
refuses() {
  edit "$3"
  [ -z "$base_changes" ] || ! cmp -s base.nml case.nml || { fails "no change by: $3"; return; }
  rm -rf out
  run case.nml --out out
  check "refuses $3" refused "$1" "$2"
}
base_changes=yes

# refuses_text TEXT CODE: the same for case.nml as it stands.
refuses_text() {
  rm -rf out
  run case.nml --out out
  check "refuses a case: $1" refused "$1" "$2"
}

# --- cases -------------------------------------------------------------------

# Case 1 with few speeds, and without remarks.
sed -e 's/ *!.*//' -e '/^ *$/d' -e 's/rpm_last = .*/rpm_last = 15400/' -e 's/rpm_step = .*/rpm_step = 500/' \
  -e 's/amount_um = .*/amount_um = 0, 15/' "$root/data/case1.nml" >geared.nml
# The same without elements: cheap, for what is refused late or run often.
sed -e "s/model = 'fe'/model = 'weber'/" -e '/^&section/,/^\//d' -e '/tooth_coupling/d' -e '/_contact = /d' geared.nml >cheap.nml
# Hassan's section on a coarse grid, its published values beside it.
sed -e 's/ *!.*//' -e '/^ *$/d' -e 's/elements_across = .*/elements_across = 6/' "$root/data/hassan.nml" >coarse.nml
cp "$root/data/hassan2009.csv" hassan2009.csv
# A mesh with no geometry behind it.
cat >prescribed.nml <<'END'
&case tasks = 'mesh', 'load', 'sweep', 'optimum' /
&pinion teeth = 25 effective_mass_kg = 0.8 /
&gear effective_mass_kg = 0.9 /
&load normal_force_n = 6858 /
&relief amount_um = 0, 15 /
&mesh
  model = 'polynomial'
  contact_ratio = 1.6
  coefficients = 400, 0, -120
/
&dynamics damping_ratio = 0.1 /
&sweep rpm_first = 2000 rpm_last = 16000 rpm_step = 1000 load_rpm = 3000 /
END
# The same stiffness as a table beside the case; nine points give the spline its parabola back.
{
  printf '# s, N/um\n! second remark\n\n'
  for i in 0 1 2 3 4 5 6 7 8; do
    awk "BEGIN { u = $i/4 - 1; printf \"%.15g\", 1.6*$i/8; printf \"$([ $((i % 2)) = 0 ] && echo ', ' || echo '\t')%.15g\n\", 400 - 120*u*u }"
  done
} >pair.csv
cp geared.nml base.nml

# --- the command line --------------------------------------------------------

version=$(sed -n 's/^version *= *"\(.*\)"/\1/p' "$root/fpm.toml")
run --version
check 'version: exit code' exits 0
check 'version: text' test "$(cat stdout)" = "gearsweep $version"
check 'version: stderr' silent stderr
for option in --help -h; do
  run $option
  check "$option: exit code" exits 0
  check "$option: stderr" silent stderr
  for word in usage CASE.nml --out --threads --verbose --quiet --version --help --new --describe 'exit code' doc/case.md; do
    check "$option names $word" says stdout "$word"
  done
done
check 'the reference of the case is there' test -s "$root/doc/case.md"
run --help pair module_mm
check 'help on a key: exit code' exits 0
check 'help on a key' says stdout '  allowed   0.05 to 1000'
run --help optimum
check 'help on a task' says stdout 'task optimum'
# completes WANTED WORD...: the shell offers these words where the last one is begun.
completes() {
  wanted=$1
  shift
  bash -c '. "$1"; program=$2; shift 2; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _gearsweep "$program"; echo "${COMPREPLY[*]}"' \
    - "$root/app/completion.sh" "$program" gearsweep "$@" >offered 2>&1
  [ "$(cat offered)" = "$wanted" ] || { echo "  offered: $(cat offered)"; return 1; }
}
need bash
check 'completion of a task' completes sweep --new sw
check 'completion of an option' completes '--verbose --version' --ve
check 'completion of a key of a group' completes amount_um --help relief am
check 'completion of a group and its keys' completes 'relief relief_um' --help relie
check 'completion of a case' completes base.nml bas
# completes_in_zsh WANTED LINE: Tab completes this line in zsh.
completes_in_zsh() {
  timeout 60 zsh -f "$root/test/cases/complete.zsh" "$root/app/completion.sh" "$program" "$2" "$1" </dev/null
}
need zsh
check 'zsh: completion of a task' completes_in_zsh 'new sweep' 'gearsweep --new sw'
check 'zsh: completion of an option' completes_in_zsh '--help' 'gearsweep --he'
check 'zsh: completion of a key of a group' completes_in_zsh amount_um 'gearsweep --help relief am'
check 'zsh: completion of a case' completes_in_zsh base.nml 'gearsweep bas'
run --describe
check 'description: exit code' exits 0
check 'description: JSON' "$root/.venv/bin/python" -c 'import json, sys
found = json.load(open(sys.argv[1]))
assert {"version", "tasks", "groups", "keys"} == set(found) and len(found["keys"]) > 80' stdout

# A case to begin with runs once the keys that stand out have a value: for each task, and for all together.
# begin TASK...: the text of such a case, with values.
begin() {
  "$program" --new "$@" | sed -e '/REQUIRED/{
    /normal_force_n\|line_load_n_mm/b
    s/teeth =/teeth = 25/
    s/bore_mm =/bore_mm = 20/
    s/frequency_hz =/frequency_hz = 0, 1e5/
    s/module_mm =/module_mm = 3/
    s/face_width_mm =/face_width_mm = 20/
    s/torque_nm =/torque_nm = 100/
    s/rpm_first =/rpm_first = 5000/
    s/rpm_last =/rpm_last = 6000/
    s/rpm_step =/rpm_step = 500/
    s/load_rpm =/load_rpm = 5500/
    s/ rpm =/ rpm = 5500/
    s/ first =/ first = 5000/
    s/ last =/ last = 6000/
    s/duration_h =/duration_h = 1/
    s/ material =/ material = "C45"/
    s/pinion_class =/pinion_class = 6/
  }' -e 's/damping_ratio = 0.1 /damping_ratio = 0.17/'
}
tasks=$("$program" --describe tasks | sed -n 's/^  {"name": "\([a-z_]*\)".*/\1/p')
check 'the tasks are described' test "$(echo $tasks | wc -w)" -gt 8
for task in $tasks "$(echo $tasks)"; do
  begin $task >new.nml
  run new.nml --out new
  check "a new case runs: $task" exits 0
  check "a new case has nothing that is not used: $task" lacks stdout 'Not used'
done
rm -r new new.nml

# misuse TEXT ARGUMENTS...
misuse() {
  text=$1
  shift
  run "$@"
  check "misuse: $*" is_one_error "$text" 2
  check "misuse points to the help: $*" says stderr '--help'
  check "misuse leaves nothing: $*" test "$(files_in .)" = 'base.nml stderr stdout '
}
mkdir misuse && cp base.nml misuse && cd misuse || exit
misuse 'rim_m: no such task, group or key (did you mean rim_mm?)' --help rim_m
misuse 'sweeep: no such task (did you mean sweep?)' --new sweeep
misuse 'name at least one task' --new
misuse 'keyss: cannot be described (did you mean keys?)' --describe keyss
misuse 'no case' --quiet
misuse 'no case'
misuse '--colour' --colour base.nml
misuse '-x' base.nml -x
misuse '--out' base.nml --out
misuse '--out' base.nml --out ''
misuse '--out: a value must follow, not --quiet' base.nml --out --quiet
misuse '--name: a/b must be a name without a folder' base.nml --name a/b
misuse '--threads' base.nml --threads
misuse '1 to 1024' base.nml --threads 0
misuse '1 to 1024' base.nml --threads -1
misuse '1 to 1024' base.nml --threads two
misuse '1 to 1024' base.nml --threads 1.5
misuse '1 to 1024' base.nml --threads 99999999999
misuse 'one case' base.nml base.nml
misuse 'empty' ''
cd ..

# --- good runs ---------------------------------------------------------------

run base.nml
check 'good: exit code' exits 0
check 'good: nothing on stderr in a pipe' silent stderr
check 'good: the folder without --out' test -s results/base.sweep.csv
rm -rf results
run base.nml --out out
cp stdout answer
check 'good: exit code with --out' exits 0
check 'good: the tables and nothing else' test \
  "$(files_in out)" = "$(named base $geared_tables)"
for text in 'contact ratio 1.61165' 'Stiffness' 'Natural frequency' 'Static transmission error' 'worst' \
  'of a peak at rpm' 'Best of the list' 'Points ' 'without an answer 0' 'Best single amount' 'Time' 'tables: out/base.*.csv'; do
  check "good: the answer has $text" says answer "$text"
done
check 'good: not verbose' lacks answer 'left out'

columns_of() {
  case $1 in
    sweep) echo relief_um,rpm,dynamic_factor,error_estimate,status,contact,floquet_modulus,residual,steps,mesh_periods ;;
    harmonics) echo relief_um,harmonic,amplitude_um,phase_deg,error_estimate_um ;;
    mesh) echo relief_um,s,pair_stiffness_n_um,mesh_stiffness_n_um,profile_error_um,load_share,ste_um ;;
    load) echo relief_um,rpm,s,pair_load_n,load_ratio,dte_um,status,mesh_periods,pair ;;
    optimum_curve) echo relief_um,worst_dynamic_factor,rpm,points_without_answer ;;
  esac
}
begins() { case $1, in "$2"*) ;; *) echo "  found: $1"; return 1 ;; esac; }
geometry_columns=,pair_stiffness_estimate_n_um,path_mm,pinion_radius_mm,pinion_curvature_mm,gear_curvature_mm

# Every number of a row has 15 digits, or is a whole number or a word.
well_formed() {
  rows "$1" | awk -F, -v n="$(columns "$1" | awk -F, '{ print NF }')" '
    NF != n { print "  columns: " $0; bad = 1; exit }
    { for (i = 1; i <= NF; i++)
        if ($i !~ /^-?[0-9]\.[0-9][0-9][0-9][0-9][0-9][0-9][0-9][0-9][0-9][0-9][0-9][0-9][0-9][0-9]E[-+][0-9]+$/ &&
            $i !~ /^[0-9]+$/ && $i != "NaN" && $i !~ /^[a-z_]+$/ && $i !~ /^[ABPDE]$/) { print "  number: " $i; bad = 1; exit } }
    END { exit bad }'
}
# The header carries the case as it was read.
echoes() { sed -n '/^# case:$/,$p' "$1" | sed -n 's/^#   //p' | cmp -s - "$2"; }
header_first() { awk '/^#/ && seen { bad = 1 } !/^#/ { seen = 1 } END { exit bad }' "$1"; }

for kind in $geared_tables; do
  table=out/base.$kind.csv
  wanted=$(columns_of $kind)
  [ $kind = mesh ] && wanted=$wanted$geometry_columns
  # Those that scripts may know by their place; further ones stand behind them.
  check "$kind: columns" begins "$(columns $table)" "$wanted"
  check "$kind: version" test "$(head -n 1 $table | grep -c "^# gearsweep $version:")" = 1
  check "$kind: what its columns mean" test "$(sed -n '/^# columns:$/,/^# case:$/s/^#   \([a-z_]*\)[ :].*/\1/p' $table |
    paste -s -d, -)" = "$(columns $table)"
  check "$kind: the case as read" echoes $table base.nml
  check "$kind: remarks come first" header_first $table
  check "$kind: numbers" well_formed $table
  check "$kind: ends with a line end" test -z "$(tail -c 1 $table | tr -d '\n')"
done
check 'sweep: rows' test "$(rows out/base.sweep.csv | wc -l)" -eq 62
check 'sweep: speeds' test "$(rows out/base.sweep.csv | awk -F, '{ printf "%d ", $2 }' | cut -d' ' -f1,2,31,32)" = '400 900 15400 400'
check 'sweep: all ok' test "$(rows out/base.sweep.csv | cut -d, -f5 | sort -u)" = ok
check 'sweep: errors within the tolerance' test "$(rows out/base.sweep.csv | awk -F, '$4 > 1e-6' | wc -l)" -eq 0
check 'load: chosen speed' test "$(rows out/base.load.csv | awk -F, '{ print $2 + 0 }' | sort -u)" = 1600
check 'mesh: a pair carries all the load alone' test "$(rows out/base.mesh.csv | awk -F, '$6 > m { m = $6 } END { printf "%.9f", m }')" = 1.000000000
check 'harmonics: eight and the mean for each relief' test "$(rows out/base.harmonics.csv | awk -F, '{ printf "%d", $2 }')" = 012345678012345678
# Mean and harmonics add up to the static transmission error of the mesh table, but for its steep steps.
check 'harmonics: add up to the transmission error' test "$({ rows out/base.harmonics.csv | grep '^0\.0'; rows out/base.mesh.csv | grep '^0\.0'; } |
  awk -F, 'NF == 5 { a[$2] = $3; p[$2] = $4; next } $2 < 1 { x = 0
    for (k in a) x += a[k]*cos(6.283185307179586*k*$2 + 0.017453292519943295*p[k]); d += (x - $7)^2; v += (a[0] - $7)^2; n++ }
  END { print (n > 100 && d < 0.1*v) }')" = 1
# DF of the load table is the largest load ratio of each relief, and that of the screen.
check 'load: largest ratio is the answer' says answer "$(rows out/base.load.csv |
  awk -F, '$1 == 0 && $5 > m { m = $5 } END { printf "%.3f", m }' | cut -c1-4)"
# The published shape: relief lowers the worst dynamic factor, and the optimum lies between.
check 'optimum_curve: the optimum' test "$(rows out/base.optimum_curve.csv |
  awk -F, 'NR == 1 || $2 < m { m = $2; a = $1 } END { print (a > 13 && a < 17 && m < 1.1) }')" = 1

# The files in one line, but by name with --verbose; what never differs has no column.
tables=$(find out -name 'base.*.csv' | wc -l)
check 'files: one line' test "$(grep '^Wrote' answer)" = "Wrote              $tables tables: out/base.*.csv"
check 'transmission error: no column of ones' lacks answer 'largest pair load/static'

run base.nml --out again
for kind in $geared_tables; do check "twice: $kind" same out/base.$kind.csv again/base.$kind.csv; done
sed '/^Time/d; /^Wrote/d' answer >first
sed '/^Time/d; /^Wrote/d' stdout >second
check 'twice: the answer' same first second
run base.nml --out out
check 'a second run into the same folder' exits 0
check 'a second run leaves nothing else' test "$(files_in out)" = "$(named base $geared_tables)"

run base.nml --out out --quiet
check 'quiet: exit code' exits 0
check 'quiet: stdout' silent stdout
check 'quiet: stderr' silent stderr
run --quiet --out early base.nml
check 'options in front of the case' test -s early/base.sweep.csv

sed "s/tasks = .*/tasks = 'sweep'/" base.nml >sweep_only.nml
run sweep_only.nml --out sweep_only --verbose
check 'verbose: exit code' exits 0
check 'verbose: files by name' says stdout 'Wrote              sweep_only/sweep_only.sweep.csv'
for text in 'mesh left out' 'load left out' 'optimum left out' \
  'friction left out' 'coast side left out' 'geometry: pair built' 'sweep: 62 operating points'; do
  check "verbose: $text" says stdout "$text"
done
check 'one task makes its own tables' test "$(files_in sweep_only)" = "$(named sweep_only $pair_tables motion $sweep_tables)"
rows out/base.sweep.csv >rows_all
rows sweep_only/sweep_only.sweep.csv >rows_alone
check 'a task gives the same alone' same rows_all rows_alone

sed "s/tasks = .*/tasks = 'geometry'/" base.nml >geometry.nml
run geometry.nml --out geometry --verbose
check 'geometry: exit code' exits 0
check 'geometry: the pair' says stdout 'contact ratio'
check 'geometry: no mesh' lacks stdout 'Stiffness'
check 'geometry: says what is left out' says stdout 'mesh and motion left out'
check 'geometry: its tables' test "$(files_in geometry)" = "$(named geometry $pair_tables outline)"
sed -n '/^&pair/,/^&material/p' geometry.nml | sed '/^&material/d' >bare.nml
echo "&case tasks = 'geometry' /" >>bare.nml
run bare.nml --out geometry
check 'geometry: needs no load and no speeds' exits 0

cp base.nml two.dots.nml
run two.dots.nml --out stem --quiet
check 'names: the last ending goes' test -s stem/two.dots.sweep.csv
cp base.nml plain
run plain --out stem --quiet
check 'names: no ending' test -s stem/plain.sweep.csv
mkdir 'a folder'
cp base.nml 'a folder/my case.nml'
run 'a folder/my case.nml' --out 'a folder/my results' --quiet
check 'names: blanks' test -s 'a folder/my results/my case.sweep.csv'
run "$work/base.nml" --out "$work/absolute/" --quiet
check 'names: absolute, with a slash' test -s absolute/base.sweep.csv

# --- elements: a section, its stress and its modes ---------------------------

run coarse.nml --out elements --verbose
cp stdout answer
check 'elements: exit code' exits 0
check 'elements: nothing on stderr' silent stderr
check 'elements: the files and nothing else' test "$(files_in elements)" = \
  "$(named coarse $pair_tables motion outline published $static_tables ${modal_tables#section })"
for text in 'section: 3 of 30 teeth, +/-17.5 deg, inner radius 203.125 mm' 'smallest scaled Jacobian' \
  'Natural frequencies of the section' 'error est. %' 'Root stress of the pinion' 'ISO 6336-3' 'Lewis' \
  'Printed values and ours' 'not reproducible' 'sweep left out' 'static: root stress at 9 positions' elements/coarse.mode_shapes.vtu; do
  check "elements: the answer has $text" says answer "$text"
done
check 'published: the reason under the row' test "$(grep -A1 '^   beam_frequency_rad_s ' answer | tail -n 1 | cut -c7-34)" = \
  'The stated inputs give 30761'
columns_of_body() {
  case $1 in
    outline) echo gear,x_mm,y_mm ;;
    static) echo relief_um,s,radius_mm,load_share,side,sigma_mpa,sigma_x_mpa,sigma_y_mpa,tau_xy_mpa ;;
    modal) echo mode,frequency_hz,error_estimate,residual,rim_share ;;
    published) echo quantity,place,printed,ours,deviation,unit,status,reason ;;
  esac
}
for kind in outline static modal published; do
  table=elements/coarse.$kind.csv
  check "$kind: columns" test "$(columns $table)" = "$(columns_of_body $kind)"
  check "$kind: version" test "$(head -n 1 $table | grep -c "^# gearsweep $version:")" = 1
  check "$kind: the case as read" echoes $table coarse.nml
  check "$kind: remarks come first" header_first $table
  [ $kind = published ] || check "$kind: numbers" well_formed $table
done
check 'static: nine positions, both sides' test "$(rows elements/coarse.static.csv | wc -l)" -eq 18
check 'static: the shares as stated' test "$(rows elements/coarse.static.csv | awk -F, '{ printf "%g ", $4 }')" = \
  '0.5 0.5 0.5 0.5 0.5 0.5 1 1 1 1 1 1 0.5 0.5 0.5 0.5 0.5 0.5 '
check 'static: tension on the loaded side, pressure on the other' test "$(rows elements/coarse.static.csv |
  awk -F, '($5 == "drive") != ($6 > 0) { bad = 1 } END { print bad + 0 }')" = 0
# The frequencies ascend and follow Table 1; the error estimate covers what a finer grid changes.
check 'modal: ascending, within 0.5 % of Table 1' test "$(rows elements/coarse.modal.csv | awk -F, '
  BEGIN { split("7342 7647 7947 10497 12662", printed, " ") }
  { d = $2/printed[$1] - 1; if ($1 != NR || d*d > 25e-6 || $4 > 1e-6 || $3 > 0.01 || $5 < 0 || $5 > 1) bad = 1 }
  END { print NR, bad + 0 }')" = '5 0'
check 'outline: both gears' test "$(rows elements/coarse.outline.csv | cut -d, -f1 | sort | uniq -c | wc -l)" -eq 2
check 'outline: between root and tip' test "$(rows elements/coarse.outline.csv | awk -F, '
  { r = sqrt($2*$2 + $3*$3); low = $1 == "gear" ? 718.75 : 343.75; high = $1 == "gear" ? 775 : 400
    if (r < low - 1e-6 || r > high + 1e-6) bad = 1 } END { print bad + 0 }')" = 0
check 'published: every row has our value' test "$(rows elements/coarse.published.csv | awk -F, '
  $4 == "NaN" || !($4*$4 > 0) || ($4/$3 - 1 - $5)^2 > 1e-20 { bad = 1 } END { print NR, bad + 0 }')" = '28 0'
check 'published: each row of the file, in its order' test "$(rows elements/coarse.published.csv | cut -d, -f1)" = \
  "$(grep -v '^#' hassan2009.csv | tail -n +2 | cut -d, -f1)"
check 'published: what follows from the stated inputs agrees' test "$(rows elements/coarse.published.csv | awk -F, '
  $7 == "stated" && $5*$5 > 4e-4 { bad = 1 } END { print bad + 0 }')" = 0

# well_shaped FILE: XML, its counts right, every node of every element there; FIELDS vectors at the nodes.
well_shaped() {
  python3 - "$1" "$2" <<'END'
import math, sys, xml.etree.ElementTree as tree
root = tree.parse(sys.argv[1]).getroot()
piece = root.find('UnstructuredGrid/Piece')
points, cells = int(piece.get('NumberOfPoints')), int(piece.get('NumberOfCells'))
arrays = {a.get('Name'): a.text.split() for a in piece.iter('DataArray')}
nodes = [int(i) for i in arrays['connectivity']]
assert len(piece.find('Points/DataArray').text.split()) == 3*points
assert len(nodes) == 8*cells and sorted(set(nodes)) == list(range(points))
assert [int(i) for i in arrays['offsets']] == list(range(8, 8*cells + 1, 8))
assert set(arrays['types']) == {'23'} and len(arrays['types']) == cells
assert set(arrays['tooth']) == {'0', '1', '2', '3'} and len(arrays['tooth']) == cells
fields = piece.findall('PointData/DataArray')
assert len(fields) == int(sys.argv[2])
for field in fields:
    values = [float(v) for v in field.text.split()]
    assert len(values) == 3*points and all(map(math.isfinite, values)) and any(values)
END
}
check 'mode_shapes.vtu: well formed' well_shaped elements/coarse.mode_shapes.vtu 5

for threads in 1 2 7; do
  run coarse.nml --out elements$threads --threads $threads --quiet
  check "elements: exit code with $threads threads" exits 0
  for file in modal.csv mode_energy.csv mode_shapes.vtu outline.csv published.csv static.csv root_stress.csv section.csv; do
    check "elements: the same $file with $threads threads" same elements/coarse.$file elements$threads/coarse.$file
  done
done
# Only what is asked for, from only what it needs. A case without &load is enough for modes.
sed "s/tasks = .*/tasks = 'modal'/; /published/d; /^&load/,/^\//d" coarse.nml >modal.nml
run modal.nml --out modal
check 'modal: needs no load' exits 0
check 'modal: its files' test "$(files_in modal)" = "$(named modal $pair_tables $modal_tables)"
check 'modal: no mesh' lacks stdout 'Stiffness'
rows elements/coarse.modal.csv >rows_modes
rows modal/modal.modal.csv >rows_alone
check 'modal: the same alone' same rows_modes rows_alone
rows elements/coarse.section.csv >rows_section
rows modal/modal.section.csv >rows_alone
check 'section: the same alone' same rows_section rows_alone
sed "s/tasks = .*/tasks = 'static'/; /published/d" coarse.nml >static.nml
run static.nml --out static
check 'static: exit code' exits 0
check 'static: its tables' test "$(files_in static)" = "$(named static $pair_tables motion $static_tables)"
rows elements/coarse.static.csv >rows_root
rows static/static.static.csv >rows_alone
check 'static: the same alone' same rows_root rows_alone
rows static/static.section.csv >rows_alone
check 'static: the section of the modes' same rows_section rows_alone
# Twice the load, twice the stress; the load of the mesh shared as the pairs' stiffness and relief have it.
sed 's/28000/56000/' static.nml >twice.nml
run twice.nml --out static --quiet
rows static/twice.static.csv >rows_twice
check 'static: proportional to the load' test "$(paste -d, rows_root rows_twice |
  awk -F, '{ d = $15/$6 - 2; if (d*d > 1e-18) bad = 1 } END { print NR, bad + 0 }')" = '18 0'
# Without contact at tip corners, so that one pair carries all between B and D.
sed "/shares/d; /spacing/d; s/model = 'weber'/model = 'weber' corner_contact = .false./; s/^&modal/\&relief amount_um = 0, 40 \/ \&modal/" static.nml >shared.nml
run shared.nml --out static
check 'static: shared by the mesh' exits 0
check 'static: a row for each relief' says stdout '          40 '
check 'static: one pair carries all the load alone' test "$(rows static/shared.static.csv |
  awk -F, '{ n[$1]++; if ($4 > m) m = $4 } END { for (i in n) printf "%d ", n[i]; printf "%.9f", m }')" = '74 74 1.000000000'
sed "/shares/d; /spacing/d; s/tangent_deg/sharing = 'equal' positions = 5 tangent_deg/" static.nml >equal.nml
run equal.nml --out static --quiet
check 'static: shared equally' test "$(rows static/equal.static.csv | awk -F, '{ printf "%g ", $4 }' | cut -d' ' -f1,9)" = '0.5 1'
# Above a contact ratio of 2, two and three pairs take turns.
sed 's/^  addendum = 1$//; s/^  dedendum = 1.25$//; s/teeth = 30$/teeth = 40 addendum = 1.3 dedendum = 1.5/; s/teeth = 60$/& addendum = 1.3 dedendum = 1.5/' \
  equal.nml | sed '/half_angle/d; s/rack_tip_radius = 0.30/rack_tip_radius = 0.2/' >three.nml
run three.nml --out static
check 'static: contact ratio above 2' says stdout 'contact ratio 2.2'
check 'static: two or three pairs' test "$(rows static/three.static.csv | awk -F, '{ printf "%.4f\n", $4 }' | sort -u | tr '\n' ' ')" = '0.3333 0.5000 '
# Sections from one tooth to the whole gear, either gear, down to the bore, with asymmetric teeth.
for change in 's/teeth = 3$/teeth = 1/' 's/teeth = 3$/teeth = 2/' 's/teeth = 3$/teeth = 30/' "s/'pinion'/'gear'/" \
  "s/'sides', 'rim'/'sides'/" "s/'sides', 'rim'/'rim'/" "s/'stress'/'strain'/" 's/across = 6/across = 3/' \
  's/teeth = 30$/teeth = 30 bore_mm = 500/; /rim_mm/d' 's/pressure_angle_deg = 20/& coast_angle_deg = 25/' \
  's/rim_mm = .*/rim_mm = 30/' 's/tangent_deg = .*/tangent_deg = 60/'; do
  sed "$change; /half_angle/d" coarse.nml >case.nml
  cmp -s coarse.nml case.nml && fails "no change by: $change"
  run case.nml --out sections
  check "sections: $change" exits 0
  check "sections: numbers of $change" well_formed sections/case.static.csv
done
# Down to the bore: the same as the rim that ends there.
sed 's/teeth = 30$/teeth = 30 bore_mm = 406.25/; /rim_mm/d' coarse.nml >bored.nml
run bored.nml --out sections --quiet
rows sections/bored.modal.csv >rows_bored
check 'sections: the bore is the inner edge' test "$(paste -d, rows_modes rows_bored |
  awk -F, '{ d = $7/$2 - 1; if (d*d > 1e-20) bad = 1 } END { print NR, bad + 0 }')" = '5 0'
# The stiffness by elements is the default, and finer grids do not move it much.
sed "s/tasks = .*/tasks = 'mesh'/" geared.nml >case.nml
run case.nml --out stiffness
check 'fe: exit code' exits 0
check 'fe: said' says stdout 'Stiffness          fe: '
rows stiffness/case.mesh.csv | cut -d, -f1-4 >rows_16
sed "s/^&section/& elements_across = 24/; s/tasks = .*/tasks = 'mesh'/" geared.nml >case.nml
run case.nml --out stiffness --quiet
rows stiffness/case.mesh.csv | cut -d, -f1-4 >rows_24
check 'fe: pair stiffness within 0.2 % of a finer grid' test "$(paste -d, rows_16 rows_24 |
  awk -F, '{ d = $7/$3 - 1; if (d*d > 4e-6) bad = 1 } END { print (NR > 20), bad + 0 }')" = '1 0'

# --- threads and directions --------------------------------------------------

# Little damping and a tight tolerance: some points may have no answer, the same ones whatever the threads.
cp cheap.nml base.nml
answered() { [ "$code" = 0 ] || exits 4; }
for direction in each up down both; do
  edit "s/&sweep/\&sweep direction = '$direction'/; s/tasks = .*/tasks = 'sweep', 'optimum'/; s/damping_ratio = .*/damping_ratio = 0.02/"
  cp case.nml $direction.nml
  for threads in 1 2 7; do
    run $direction.nml --out threads$threads --threads $threads --quiet
    check "threads: exit code of $direction with $threads" answered
    echo "$code" >>$direction.codes
  done
  check "threads: one exit code of $direction" test "$(sort -u $direction.codes | wc -l)" -eq 1
  for kind in sweep optimum_curve; do
    check "threads: 1 and 2, $direction, $kind" same threads1/$direction.$kind.csv threads2/$direction.$kind.csv
    check "threads: 1 and 7, $direction, $kind" same threads1/$direction.$kind.csv threads7/$direction.$kind.csv
  done
done
check 'threads: these cases lose contact' says threads1/up.sweep.csv ,lost,
cp geared.nml base.nml

# --- each task's numbers ------------------------------------------------------

# Not the numbers of another run: what each must be to others and to the case, worked out in numbers.py.
cat >every.nml <<'END'
&case tasks = 'geometry', 'mesh', 'load', 'sweep', 'optimum', 'stability', 'hysteresis', 'poincare', 'attractors',
  'sensitivity', 'flank', 'rating', 'transient', 'harmonic', 'life', 'deflection_relief', 'static', 'modal', 'body_modes' /
&pair module_mm = 3 face_width_mm = 20 backlash_um = 60 coast_angle_deg = 22 /
&pinion teeth = 21 effective_mass_kg = 0.5 profile_shift = 0.1 bore_mm = 12 /
&gear teeth = 34 effective_mass_kg = 0.9 rim_thickness_mm = 6 web_thickness_mm = 6 / &load normal_force_n = 4000 /
&relief amount_um = 0, 8 / &mesh model = 'weber' / &dynamics damping_ratio = 0.05 friction = 0.06 /
&section teeth = 1 elements_across = 3 plane = 'strain' /
&sweep rpm_first = 6000 rpm_last = 26000 rpm_step = 1000 load_rpm = 4000, 21000 load_torque = .true. /
&flank rpm = 4000, 9000 conductivity_w_mk = 45, 60 /
&rating rpm = 4000, 21000 contact_limit_mpa = 1400, 1300 root_limit_mpa = 700, 650 face_load_factor = 1.2
  pitch_deviation_um = 10 profile_deviation_um = 8 /
&stability rpm = 24000, 35776 damping_first = 0.02 damping_last = 0.1 damping_count = 3 tongues = 1 /
&hysteresis rpm = 14000, 15000, 17000, 35000, 35776, 36500 /
&poincare rpm = 12000, 17000 settling_periods = 100 kept_periods = 40 / &attractors rpm = 12000, 17000 starts = 4 /
&sensitivity rpm = 9000 / &transient rpm = 4000, 9000 modes = 2 positions = 4 samples = 200 /
&harmonic frequency_hz = 0, 40000 modes = 2 / &static positions = 5 / &modal modes = 3 /
&body_modes nodal_diameters = 2 elements_across = 2 held = 'tangential' /
&life rpm = 4000, 9000 duration_h = 10, 20 load_factor = 1, 1.5 tensile_strength_mpa = 1100
  curve_cycles = 1e3, 1e6 curve_stress_mpa = 1000, 86 /
END
run every.nml --out every --quiet
check 'each task: exit code' exits 0
python3 "$root/test/cases/numbers.py" every every >numbers 2>&1 || fails "each task: $(tail -n 1 numbers)"
while IFS= read -r line; do
  title="each task: ${line#* }"
  case $line in passed*) pass ;; *) fails "$title" ;; esac
done <numbers

# --- how faces meet -------------------------------------------------------------

grep -v '^ *!' "$root/data/face_load.nml" | sed 's/ *!.*//' >base.nml
refuses '&face misalignment_um = 2000: must be at least -1000 and at most 1000' 1 's/misalignment_um = 10/misalignment_um = 2000/'
refuses '&face misalignment_um = 1010 together: must be from -1000 to 1000' 1 's/misalignment_um = 10/misalignment_um = 1000/; s/crowning_um = 8/lead_slope_um = 10/'
refuses '&pinion crowning_um = 8000: must be at least -1000 and at most 1000' 1 's/crowning_um = 8/crowning_um = 8000/'
refuses '&pinion end_relief_mm: missing; an end relief has end_relief_um and end_relief_mm' 1 '/end_relief_mm/d'
refuses '&pinion end_relief_um: missing; an end relief has end_relief_um and end_relief_mm' 1 '/end_relief_um/d'
refuses '&pinion end_relief_mm = 16: must be from 0 to half of the face width, 15 mm' 1 's/end_relief_mm = 3/end_relief_mm = 16/'
refuses '&pair face_width_mm = 8: must be at least 3 modules for a load distribution over it' 1 's/face_width_mm = 30/face_width_mm = 8/'
refuses '&face bearing_span_mm: missing; a shaft has shaft_diameter_mm, bearing_span_mm and torque_side' 1 '/bearing_span_mm/d'
refuses '&face torque_side: missing; a shaft has shaft_diameter_mm, bearing_span_mm and torque_side' 1 '/torque_side/d'
refuses 'for an overhung pinion state the misalignment' 1 's/bearing_offset_mm = -15/bearing_offset_mm = 80/'
refuses "&mesh model = 'weber': must be 'fe' for the load over the face width" 1 "s/^&face/\\&mesh model = 'weber' \/ \\&face/"
refuses "&section plane = 'stress': must be 'strain' for the load over the face width" 1 "s/^&face/\\&section plane = 'stress' \/ \\&face/"
refuses "&face slices: too narrow beside Hertz's contact; use fewer" 5 's/^&face/\&face slices = 200/'
refuses 'bodies held inside: of gears with a web' 1 "s/^&gear/\\&gear rim_thickness_mm = 6 web_thickness_mm = 6/"
refuses "needs bodies held inside, &section fixed = 'sides', 'rim'" 1 "s/^&face/\\&section fixed = 'sides' \/ \\&face/"
speeds='rpm_first = 15000 rpm_last = 15000 rpm_step = 1000'
edit "s/'face_load'/'sweep', 'rating'/; s/^&face/\\&sweep $speeds \/ \\&rating rpm = 3000 \/ \\&dynamics damping_ratio = 0.03 \/ \\&face/"
run case.nml --out out
check 'the screen says which motions have uneven faces' says stdout 'Faces              uneven in the sweep, the mean mesh stiffness and the natural frequency; parallel in all other motions'
check 'and that the sweep has no contact of tip corners' says stdout 'the sweep has no contact of tip corners'
check 'and no task that has parallel faces to look for other motions' says stdout "direction = 'all' shows them"
edit "s/'face_load'/'rating'/; s/^&face/\\&rating rpm = 3000 \/ \\&face/"
run case.nml --out out
check 'and that K_v is that of parallel faces' says stdout 'Faces              parallel in the motion'
cp geared.nml base.nml

# --- spellings of the same case ----------------------------------------------

# means TITLE FILE: gives the same sweep as the base case.
means() {
  run "$2" --out spelling --quiet
  check "$1: exit code" exits 0
  rows "spelling/$(basename "$2" .nml).sweep.csv" >rows_spelt 2>/dev/null
  check "$1: the same sweep" same rows_all rows_spelt
}
awk '{ printf "%s\r\n", $0 }' base.nml >crlf.nml
means 'CRLF' crlf.nml
check 'CRLF: no half line ends in a table' test "$(tr -cd '\r' <spelling/crlf.sweep.csv | wc -c)" -eq 0
{ printf '\357\273\277'; cat base.nml; } >bom.nml
means 'byte order mark' bom.nml
tr '\n' ' ' <base.nml >one_line.nml
means 'all on one line' one_line.nml
sed 's/^/	/; s/$/  ! a remark/' base.nml >remarks.nml
means 'tabs and remarks' remarks.nml
tr 'a-z' 'A-Z' <base.nml >upper.nml
means 'capitals' upper.nml
sed "s/'/\"/g; s/ = /=/; s/^\\/\$/\\&end/" base.nml >quotes.nml
means 'other quotes, no blanks, &end' quotes.nml
sed 's/rpm_first = 400/rpm_first = 4.0D+2/; s/amount_um = 0, 15/amount_um = 0 15./; s/teeth = 25/teeth = +25/' base.nml >figures.nml
means 'other figures' figures.nml
awk '/^&/ { n++ } { print > ("group" n ".part") }' base.nml
cat $(ls group*.part | sort -r) >reversed.nml
rm -f group*.part
means 'groups in another order' reversed.nml
sed "s/start = 'hpstc'/start = hpstc/; s/module_mm/coast_angle_deg =\\n  centre_distance_mm =\\n  module_mm/" base.nml >defaults.nml
means 'keys with nothing behind them' defaults.nml
sed "s/ addendum = 1\$/ addendum = /; /profile_shift/d; /dedendum/d; /rack_tip/d; /friction/d; /&material/,/^\//d; /fraction/d; /start =/d; /shape =/d" base.nml >fewest.nml
means 'what is a default, left out' fewest.nml

# --- a mesh with no geometry behind it ---------------------------------------

cp prescribed.nml base.nml
run base.nml --out prescribed --verbose
check 'prescribed: exit code' exits 0
check 'prescribed: no geometry' says stdout 'geometry left out: the mesh is prescribed'
check 'prescribed: the tables' test "$(files_in prescribed)" = "$(named base $motion_tables)"
check 'prescribed: columns of the mesh' test "$(columns prescribed/base.mesh.csv)" = "$(columns_of mesh)"
for kind in $motion_tables; do check "prescribed: numbers of $kind" well_formed prescribed/base.$kind.csv; done
sed "s/model = 'polynomial'/model = 'table' file = 'pair.csv'/; /coefficients/d" base.nml >tabled.nml
mkdir -p elsewhere
cp tabled.nml pair.csv elsewhere
mv pair.csv pair.away
run elsewhere/tabled.nml --out tabled
mv pair.away pair.csv
check 'table: lies beside the case' exits 0
# near A B: the sweeps agree to 1e-6.
near() {
  rows "$1" >near1
  rows "$2" >near2
  paste -d, near1 near2 | awk -F, -v n="$(columns "$1" | awk -F, '{ print NF }')" '
    { d = $3 - $(n + 3); if (d < 0) d = -d; if (d > 2e-6) bad = 1 } END { exit bad || NR == 0 }'
}
check 'table: the same answer as its polynomial' near prescribed/base.sweep.csv tabled/tabled.sweep.csv
sed "s|pair.csv|$work/pair.csv|" tabled.nml >absolute.nml
run absolute.nml --out tabled
check 'table: absolute name' exits 0
awk '{ printf "%s\r\n", $0 }' pair.csv | tr ',' ';' >elsewhere/pair.csv
run elsewhere/tabled.nml --out crlf
check 'table: CRLF and semicolons' exits 0
check 'table: the same answer with them' near tabled/tabled.sweep.csv crlf/tabled.sweep.csv
# Load and relief doubled together change nothing; without relief the load does not matter.
sed 's/6858/13716/; s/amount_um = 0, 15/amount_um = 0, 30/' base.nml >doubled.nml
run doubled.nml --out doubled
check 'doubled load and relief: the same dynamic factors' near prescribed/base.sweep.csv doubled/doubled.sweep.csv
# A torque is a force on the base circle.
sed 's/normal_force_n = 6858/torque_nm = 100/; s/contact_ratio/base_pitch_mm = 10 contact_ratio/' base.nml >torque.nml
run torque.nml --out torque
check 'torque: the force on the base circle' says stdout '2513.3 N'
sed 's/normal_force_n = 6858/line_load_n_mm = 100/; s/&case/\&pair face_width_mm = 20 \/ \&case/' base.nml >line.nml
run line.nml --out line
check 'line load: times the width' says stdout '2000 N'

# --- points without an answer ------------------------------------------------

edit 's/&dynamics/\&numerics steps_per_period = 12 \/ \&dynamics/'
run case.nml --out partial
check 'no answer: exit code' exits 4
check 'no answer: said' says stdout unresolved
check 'no answer: NaN in the table' says partial/case.sweep.csv ',NaN,NaN,unresolved,'
check 'no answer: the others are computed' says partial/case.sweep.csv ,inexact,
awk_nan() { rows "$1" | awk -F, '($3 == "NaN") != ($5 ~ /^(unstable|aperiodic|unresolved|chatter|chaotic|transient|unbounded)$/) { exit 1 }'; }
check 'no answer: NaN exactly where the status says so' awk_nan partial/case.sweep.csv
# The same holds for the other tasks that follow the motion.
for task in load optimum; do
  edit "s/tasks = .*/tasks = '$task' \\//; s/&dynamics/\\&numerics steps_per_period = 4 \\/ \\&dynamics/; s/rpm_last = 16000/rpm_last = 3000/"
  run case.nml --out partial
  check "no answer in the task $task: exit code" exits 4
done
rows partial/case.optimum_curve.csv >rows_optimum_curve
check 'no answer: NaN in the optimum_curve table' test "$(cut -d, -f2 rows_optimum_curve | sort -u)" = NaN
# Strong damping and coarse tolerances need steps for stability, which are there.
for change in 's/damping_ratio = 0.1/damping_ratio = 2/' 's/&dynamics/\&numerics tolerance = 0.01 \/ \&dynamics/'; do
  edit "$change; s/tasks = .*/tasks = 'sweep' \\//; s/rpm_first = .*rpm_step = 1000/rpm_first = 400 rpm_last = 4000 rpm_step = 20/"
  run case.nml --out stable
  check "every point has an answer: $change" exits 0
done
# An interval of two pairs as short as rounding errors.
for ratio in 1.00000001 1.000000001 1.0000000001 1.00000000002 1.00000000001 1.000000000009 1.000000000001 1.9999999999 1.99999999999 2.0000000001 2.00000000001; do
  edit "s/contact_ratio = .*/contact_ratio = $ratio/"
  run case.nml --out ratio --quiet
  check "contact ratio $ratio" exits 0
done

# --- progress ----------------------------------------------------------------

# on_terminal COMMAND: what a shell command prints on a pseudo-terminal of its own, as typescript.
on_terminal() {
  python3 -c 'import pty, sys; pty.spawn(["sh", "-c", sys.argv[1]])' "$1" </dev/null >typescript 2>&1
}

cp geared.nml progress.nml
if python3 -c 'import os; os.openpty()' 2>/dev/null; then
  on_terminal "'$program' progress.nml --out progress"
  check 'progress: on a terminal' says typescript ' points, 100 %'
  on_terminal "'$program' progress.nml --out progress --quiet"
  check 'progress: none when quiet' lacks typescript ' points, 100 %'
  on_terminal "'$program' progress.nml --out progress 2>piped"
  check 'progress: none where stderr is a file' silent piped
else
  fails 'progress: this machine has no pseudo-terminals: devpts must be mounted on /dev/pts, and /dev/ptmx be there'
fi

# --- files and folders -------------------------------------------------------

cp cheap.nml base.nml
rm -rf out
run missing.nml --out out
check 'missing file' refused 'missing.nml' 3
run . --out out
check 'a folder as the case' refused 'cannot read .' 3
mkdir -p folder.nml
run folder.nml --out out
check 'a folder named as a case' refused 'cannot read folder.nml' 3
run base.nml/case.nml --out out
check 'a case below a file' refused 'base.nml/case.nml' 3
: >case.nml
refuses_text 'no group' 1
printf '\n  \n! only a remark\n' >case.nml
refuses_text 'no group' 1
printf '\n' >case.nml
refuses_text 'no group' 1
head -c 5000 "$program" >case.nml
refuses_text 'line 1' 1
printf '\000\000\000\000' >case.nml
refuses_text 'control character' 1
{ cat base.nml; printf '\000'; } >case.nml
refuses_text 'control character' 1
printf '\377\376&\000c\000a\000s\000e\000' >case.nml
refuses_text 'line 1' 1
awk 'BEGIN { for (i = 0; i < 200000; i++) print "! 0123456789 0123456789 0123456789 0123456789 0123456789" }' >case.nml
refuses_text '10 MB' 1
printf '{ "module": 3.18 }\n' >case.nml
refuses_text 'outside a group' 1
printf '&case title = "never closed\n/\n' >case.nml
refuses_text 'never closed' 1
cp base.nml file
for folder in file file/out /proc/gearsweep "$(printf '%0300d' 0)"; do
  run base.nml --out "$folder"
  check "folder that takes no files: $folder" is_one_error 'cannot write' 3
done
check 'the file in the way is as it was' same file base.nml
run base.nml --out missing/above/out --quiet
check 'folder in missing folders: they are made' test -s missing/above/out/base.sweep.csv
rm -r missing
echo '&case tasks = "sweep" /' >case.nml
run case.nml --out missing/above/out
check 'folder in missing folders, where the case is refused: exit code' exits 1
check 'folder in missing folders, where the case is refused: none is made' test ! -e missing
: >file
run base.nml --out new/../file/out
check 'a file in place of a folder above' is_one_error 'cannot write to the folder new/../file/out: Not a directory' 3
mkdir -p taken/base.sweep.csv
run base.nml --out taken
check 'a folder in the way of a table' exits 3
check 'a folder in the way: no part is left' test -z "$(find taken -name '*.part')"
# As root, who may do everything, a user without rights asks.
mkdir -p locked && cp base.nml locked && cp base.nml locked/sealed.nml && chmod 000 locked/sealed.nml
if [ "$(id -u)" = 0 ]; then
  mkdir rights && cp "$program" rights/gearsweep && chmod 755 "$work" rights rights/gearsweep locked
  : >stdout && : >stderr && chmod 666 stdout stderr
  by_user() { $limit setpriv --reuid 65534 --regid 65534 --clear-groups "$work/rights/gearsweep" "$@" >stdout 2>stderr </dev/null; code=$?; }
else
  chmod 500 locked
  by_user() { run "$@"; }
fi
by_user locked/base.nml --out locked
check 'a folder without the right to write' is_one_error locked 3
by_user locked/sealed.nml --out out
check 'a case without the right to read' is_one_error sealed.nml 3
chmod 700 "$work" locked

# --- bad cases: text the message must contain, exit code, edit of the base case ---

# Layout, groups and keys
refuses '&sweeps: unknown group (did you mean &sweep?)' 1 's/&sweep/\&sweeps/'
refuses '&colour: unknown group' 1 '$s/$/\n\&colour \/'/
refuses '&sweep rpm_stop = 500: unknown key (did you mean rpm_step?)' 1 's/rpm_step/rpm_stop/'
refuses '&pair module = 3.18: unknown key (did you mean module_mm?)' 1 's/module_mm/module/'
refuses '&pair teeth = 25: unknown key; it belongs to &pinion' 1 's/module_mm/teeth = 25 module_mm/'
refuses '&dynamics colour = 3: unknown key; the keys of &dynamics are damping_ratio, friction' 1 's/friction/colour = 3 friction/'
refuses 'key module_mm is given twice in &pair' 1 's/module_mm/module_mm = 3 module_mm/'
refuses 'key module_mm is given twice in &pair' 1 's/module_mm/MODULE_MM = 3.18 module_mm/'
refuses 'group &gear is given twice' 1 's/&pinion/\&gear/'
refuses 'group &sweep is never closed' 1 '/&sweep/,/^\//s/^\///'
refuses 'group &pair is never closed' 1 '/&pair/,/^\//s/^\///'
refuses 'outside a group' 1 's/&pair/pair/'
refuses 'outside a group' 1 '1s/^/hello /'
refuses 'outside a group' 1 '$s/$/ hello/'
refuses 'amount_um(2): the values of a list must follow each other, from the index 1 on' 1 's/amount_um =/amount_um(2) =/'
refuses 'no value between two commas' 1 's/amount_um = 0, 15/amount_um = 0,, 15/'
refuses 'a value without a key' 1 's/module_mm =/module_mm/'
refuses 'a string is never closed' 1 "s/'hpstc'/'hpstc/"

# Values: type, NaN, infinity, sign
for value in three "'3.18'" NaN nan -NaN 'NaN(1)' Inf Infinity -infinity 1e999 1e308 0x10 3.1.8 3e .true. 3mm 3,18 '3 18'; do
  refuses '&pair module_mm' 1 "s|module_mm = 3.18|module_mm = $value|"
done
refuses 'outside a group: 3' 1 's|module_mm = 3.18|module_mm = 1/3|'
refuses '&pair module_mm = 3, 18: must be a single number' 1 's/module_mm = 3.18/module_mm = 3,18/'
refuses '&pair module_mm: missing; must be at least 0.05 and at most 1000' 1 's/module_mm = .*/module_mm =/'
refuses '&pair module_mm: missing; must be at least 0.05 and at most 1000' 1 '/module_mm/d'
for value in 0 -3.18 -0 1e-400; do
  refuses ": must be at least" 1 "s/module_mm = .*/module_mm = $value/"
  refuses ": must be at least" 1 "s/face_width_mm = .*/face_width_mm = $value/"
  refuses ": must be at least" 1 "s/line_load_n_mm = .*/line_load_n_mm = $value/"
  refuses ": must be at least" 1 "s/line_load_n_mm = .*/torque_nm = $value/"
  refuses ": must be at least" 1 "s/line_load_n_mm = .*/normal_force_n = $value/"
  refuses ": must be at least" 1 "s/effective_mass_kg = .*/effective_mass_kg = $value/"
  refuses ": must be at least" 1 "s/effective_mass_kg = .*/inertia_kgm2 = $value/"
  refuses ": must be at least" 1 "s/young_gpa = .*/young_gpa = $value/"
  refuses ": must be at least" 1 "s/rpm_first = .*/rpm_first = $value/"
  refuses ": must be at least" 1 "s/rpm_step = .*/rpm_step = $value/"
  refuses ": must be at least" 1 "s/load_rpm = .*/load_rpm = 1600, $value/"
done
for key in face_width_mm line_load_n_mm effective_mass_kg damping_ratio rpm_first rpm_last rpm_step load_rpm amount_um; do
  for value in NaN Inf -1 1e999 some "'1'"; do
    refuses "$key = $value: must be" 1 "s/$key = .*/$key = $value/"
  done
done
refuses '&pair module_mm = 1001: must be at least 0.05 and at most 1000' 1 's/module_mm = .*/module_mm = 1001/'
refuses '&dynamics damping_ratio = -0.01: must be at least 0' 1 's/damping_ratio = .*/damping_ratio = -0.01/'
refuses '&dynamics friction = -0.1: must be at least 0' 1 's/friction = 0/friction = -0.1/'
refuses '&dynamics friction = 1: must be at least 0 and below 1' 1 's/friction = 0/friction = 1/'
refuses '&material poisson = 0.5: must be at least 0 and below 0.5' 1 's/poisson = .*/poisson = 0.5/'
refuses '&pair backlash_um = -1: must be at least 0' 1 's/module_mm/backlash_um = -1 module_mm/'
refuses "tip_alteration = 1: must be .true. or .false." 1 's/module_mm/tip_alteration = 1 module_mm/'
refuses "&case tasks = 'sweep', 'stress': must be one of 'geometry', 'mesh', 'static', 'modal', 'face_load', 'load', 'sweep', 'optimum'" 1 "s/tasks = .*/tasks = 'sweep', 'stress'/"
refuses "&case tasks: 'section' is no task; its table outline is one of the task geometry" 1 "s/tasks = .*/tasks = 'section'/"
refuses "&case tasks: 'torque' is no task; the task load writes its tables, with &sweep load_rpm and load_torque" 1 "s/tasks = .*/tasks = 'sweep', 'Torque'/"
refuses "must be one of 'fe', 'weber', 'iso6336', 'polynomial', 'table'" 1 "s/model = .*/model = 'finite'/"
refuses "must be one of 'linear', 'parabolic'" 1 "s/shape = .*/shape = 'cubic'/"
refuses "must be one of 'hpstc', 'pitch', 'length', 'roll'" 1 "s/start = .*/start = 'lpstc'/"
refuses "must be one of 'both', 'up', 'down', 'each'" 1 "s/&sweep/\&sweep direction = 'sideways'/"
refuses "&case title = Dogan: must be a text in quotes" 1 's/title = .*/title = Dogan/'
refuses 'must be at least 1e-11 and at most 0.1' 1 's/&sweep/\&numerics tolerance = 0 \/ \&sweep/'
refuses 'steps_per_period = 1000000: must be' 1 's/&sweep/\&numerics steps_per_period = 1000000 \/ \&sweep/'
refuses "must be one of 'shooting', 'march'" 1 "s/&sweep/\\&numerics steady_state = 'newton' \\/ \\&sweep/"

# Geometry
refuses '&pinion teeth = 4: must be at least 5' 1 's/teeth = 25/teeth = 4/'
refuses '&pinion teeth = -25: must be at least 5' 1 's/teeth = 25/teeth = -25/'
refuses '&pinion teeth = 25.5: must be an integer' 1 's/teeth = 25/teeth = 25.5/'
refuses '&pinion teeth: missing' 1 '/teeth/d'
refuses '&gear teeth: missing' 1 '/&gear/,/^\//d'
refuses '&pinion profile_shift = 0: undercut with 10 teeth takes working flank; to have none it must be at least 0.5' 1 's/teeth = 25/teeth = 10/'
refuses '&pinion profile_shift = -0.9: undercut' 1 's/profile_shift = .*/profile_shift = -0.9/'
refuses '&pinion addendum = 2: pointed teeth; the tip diameter must stay below' 1 '/&pinion/,/^\//s/ addendum = 1$/ addendum = 2/'
refuses '&pinion addendum = 1: pointed teeth' 1 '/&pinion/,/^\//s/profile_shift = 0/profile_shift = 1.5/'
refuses 'interference' 1 's/ dedendum = .*/ dedendum = 0.95/'
refuses 'interference' 1 '/&gear/,/^\//s/teeth = 25/teeth = 500/; /&gear/,/^\//s/ addendum = 1$/ addendum = 1.24/'
refuses 'rack_tip_radius = 0.5: does not fit the rack; at most 0.47' 1 's/rack_tip_radius = .*/rack_tip_radius = 0.5/'
refuses 'dedendum = 3: the rack tooth is pointed' 1 's/ dedendum = .*/ dedendum = 3/'
refuses 'contact ratio 0.54' 1 's/ addendum = 1$/ addendum = 0.3/'
refuses '&pair centre_distance_mm = 79: the teeth jam; must be at least 79.5' 1 's/module_mm/centre_distance_mm = 79 module_mm/'
refuses 'is not above 1' 1 's/module_mm/centre_distance_mm = 85 module_mm/'
refuses 'is not above 1' 1 's/module_mm/centre_distance_mm = 1000 module_mm/'
refuses '&pair centre_distance_mm = 0: must be above 0' 1 's/module_mm/centre_distance_mm = 0 module_mm/'
refuses 'bore_mm = 80: must be at least 0 and below the root diameter 71.55 mm' 1 's/teeth = 25/teeth = 25 bore_mm = 80/; /effective_mass/d'
refuses 'pressure_angle_deg = 0: must be above 3 and below 45' 1 's/pressure_angle_deg = 20/pressure_angle_deg = 0/'
refuses 'pressure_angle_deg = 90: must be above 3 and below 45' 1 's/pressure_angle_deg = 20/pressure_angle_deg = 90/'

# Load and masses
refuses '&load: give one of torque_nm' 1 '/line_load/d'
refuses '&load: give one of torque_nm' 1 '/&load/,/^\//d'
refuses '&load: give one of torque_nm' 1 's/line_load/torque_nm = 100 line_load/'
refuses 'effective_mass_kg or inertia_kgm2, not both' 1 's/effective_mass/inertia_kgm2 = 1 effective_mass/'

# Relief
refuses '&relief amount_um: missing; must be at least 0' 1 's/amount_um = .*/amount_um =/'
refuses '&relief amount_um: missing; must be at least 0' 1 '/amount_um/d'
refuses '&relief amount_um = 5, -1: must be at least 0' 1 's/amount_um = .*/amount_um = 5, -1/'
refuses '&relief amount_um = 300: deeper than the tooth' 1 's/amount_um = .*/amount_um = 0, 300/; s/gear_fraction = .*/gear_fraction = 10/'
refuses 'no gear is relieved' 1 's/_fraction = 1/_fraction = 0/'
refuses '&relief length_mm' 1 "s/start = .*/start = 'length'/"
refuses '&relief length_mm' 1 "s/start = .*/start = 'pitch' length_mm = 3/"
refuses 'off the path of contact' 1 "s/start = .*/length_mm = 300/"
refuses 'one for each relieved gear' 1 "s/start = .*/pinion_roll_deg = 20/"
refuses 'off the path of contact' 1 "s/start = .*/pinion_roll_deg = 1 gear_roll_deg = 1/"
refuses 'at most 10000 numbers' 1 's/amount_um = .*/amount_um = 10001*5/'
refuses 'repeat count' 1 's/amount_um = .*/amount_um = 1000000000*5/'

# Speeds
refuses '&sweep rpm_last = 300: must not lie below rpm_first = 400' 1 's/rpm_last = .*/rpm_last = 300/'
refuses '&sweep rpm_step = -60: must be at least' 1 's/rpm_step = .*/rpm_step = -60/'
refuses '&sweep rpm_step = 1e-5: more than 10000000 operating points' 1 's/rpm_step = .*/rpm_step = 1e-5/'
refuses '&sweep rpm_step = 1e-9: more than 10000000 operating points' 1 's/rpm_step = .*/rpm_step = 1e-9/'
refuses '&sweep rpm_last = 1e10: must be at least 1e-6 and at most 1000000000' 1 's/rpm_last = .*/rpm_last = 1e10/'
refuses '&sweep rpm_step: missing' 1 '/rpm_step/d'
refuses '&sweep load_rpm: missing' 1 '/&sweep/,/^\//d'
refuses '&sweep load_rpm: missing' 1 '/load_rpm/d'

# Keys that do nothing in this case
refuses "&mesh coefficients = 400: needs model = 'polynomial'" 1 "s/model = .*/model = 'weber' coefficients = 400/"
refuses "file = 'pair.csv': needs model = 'table'" 1 "s/model = .*/model = 'weber' file = 'pair.csv'/"
refuses '&mesh base_pitch_mm = 9: needs a prescribed mesh' 1 "s/model = .*/model = 'weber' base_pitch_mm = 9/"

# Keys that another task uses: read, and named in the answer
# unused TEXT SED: the edited base case is answered with this text.
unused() {
  edit "$2"
  cmp -s base.nml case.nml && { fails "no change by: $2"; return; }
  run case.nml --out unused
  check "unused: exit code of $2" exits 0
  check "unused: $2" says stdout "$1"
}
run base.nml --out unused
check 'every key is used' lacks stdout 'Not used'
unused "Not used           for a section that ends at it or a mass that is not stated: &pinion bore_mm" '/&pinion/,/^\//s/teeth = 25/teeth = 25 bore_mm = 20/'
unused 'Not used           for modal, precision, flank, transient, harmonic, body_modes or a mass that is not stated: &material density_kgm3' 's/young/density_kgm3 = 7850 young/'
unused 'Not used           for static, modal, deflection_relief, as_built, precision, flank, rating, transient, harmonic, body_modes or a stiffness that depends on it: &material poisson' "s/model = .*/model = 'iso6336'/"
unused 'Not used           for modal, deflection_relief, as_built, precision, flank, rating, transient, harmonic, body_modes or a stiffness that is computed: &material young_gpa' "s/model = .*/model = 'polynomial' coefficients = 400/"
unused 'Not used           for load: &sweep load_rpm' "s/tasks = .*/tasks = 'mesh', 'sweep'/"
unused '                   for sweep, optimum, deflection_relief, as_built, stability, hysteresis, poincare or attractors: &sweep rpm_first, rpm_last, rpm_step' "s/tasks = .*/tasks = 'mesh'/"
unused "Not used           for static, modal, precision, transient, harmonic or a stiffness by elements: &section teeth" "s/&sweep/\\&section teeth = 5 \\/ \\&sweep/"
unused 'for static, modal, precision, transient, harmonic or body_modes: &section gear' "s/&sweep/\\&section gear = 'gear' \\/ \\&sweep/"
unused 'for static: &static positions' "s/&sweep/\\&static positions = 5 \\/ \\&sweep/"
refuses '&static positions = 1: must be at least 2' 1 "s/&sweep/\\&static positions = 1 \\/ \\&sweep/"

# A prescribed mesh
cp prescribed.nml base.nml
refuses 'contact_ratio = 1: must be above 1 and at most 20' 1 's/contact_ratio = .*/contact_ratio = 1/'
refuses 'contact_ratio = 21: must be above 1 and at most 20' 1 's/contact_ratio = .*/contact_ratio = 21/'
refuses 'contact_ratio = NaN' 1 's/contact_ratio = .*/contact_ratio = NaN/'
refuses '&mesh coefficients: missing' 1 '/coefficients/d'
refuses 'pair stiffness must be above 0 everywhere, at least 1e-12 N/um; it falls to -100 ' 1 's/coefficients = .*/coefficients = -100/'
refuses 'pair stiffness must be above 0 everywhere, at least 1e-12 N/um; it falls to -50 ' 1 's/coefficients = .*/coefficients = 400, 450/'
refuses 'pair stiffness must be above 0 everywhere, at least 1e-12 N/um; it falls to 0 ' 1 's/coefficients = .*/coefficients = 0/'
refuses 'at most 20 numbers' 1 's/coefficients = .*/coefficients = 21*1/'
refuses "must be one of 'polynomial', 'table'" 1 "s/model = .*/model = 'weber'/"
refuses '&mesh model: missing' 1 '/model/d'
refuses '&pair module_mm = 3: not used by a prescribed mesh' 1 's/&case/\&pair module_mm = 3 \/ \&case/'
refuses '&pinion addendum = 1: not used by a prescribed mesh' 1 's/teeth = 25/teeth = 25 addendum = 1/'
refuses '&gear teeth = 25: a prescribed mesh uses it with friction, inertia_kgm2, &deviations or the task as_built only' 1 's/&gear/\&gear teeth = 25/'
refuses '&gear teeth: missing; friction needs it' 1 's/&dynamics/\&dynamics friction = 0.1/'
refuses '&pinion teeth: missing' 1 's/teeth = 25//'
refuses '&gear effective_mass_kg: missing; a prescribed mesh has no body' 1 '/^&gear/d'
refuses '&gear teeth: missing; &gear inertia_kgm2 of a prescribed mesh' 1 's/effective_mass_kg/inertia_kgm2/; s/&mesh/\&mesh base_pitch_mm = 9/'
refuses '&mesh base_pitch_mm: missing; a torque' 1 's/normal_force_n/torque_nm/'
refuses '&mesh base_pitch_mm: missing; an inertia' 1 's/effective_mass_kg/inertia_kgm2/'
refuses '&pair face_width_mm: missing; a line load' 1 's/normal_force_n/line_load_n_mm/'
refuses '&pair face_width_mm = 20: a prescribed mesh uses it with line_load_n_mm only' 1 's/&case/\&pair face_width_mm = 20 \/ \&case/'
for task in geometry static modal face_load deflection_relief flank rating transient harmonic life body_modes; do
  refuses "&case tasks = '$task': needs gears; a prescribed mesh" 1 "s/tasks = .*\//tasks = '$task' \//"
done
refuses "must be one of 'polynomial', 'table'" 1 "s/model = .*/model = 'fe'/"
refuses "start = 'roll': a prescribed mesh has no roll angles" 1 's/amount_um/pinion_roll_deg = 20 gear_roll_deg = 20 amount_um/'
refuses '&sweep load_torque = .true.: not used by a prescribed mesh' 1 "s/tasks = .*\//tasks = 'load' \//; s/&sweep/\&sweep load_torque = .true./"
refuses '&mesh pitch_point = 2' 1 "s/contact_ratio/pitch_point = 2 contact_ratio/; s/amount_um/start = 'pitch' amount_um/"

# Stiffness tables: text the message must contain, rows
cp tabled.nml base.nml
base_changes=
# refuses_table TEXT CODE ROWS
refuses_table() {
  printf "$3" >pair.csv
  refuses "$1" "$2" ''
}
rm -f pair.csv
refuses 'pair.csv' 3 ''
mkdir pair.csv
refuses 'pair.csv' 3 ''
rmdir pair.csv
refuses_table '&mesh file: needs at least two rows' 1 ''
refuses_table '&mesh file: needs at least two rows' 1 '# only remarks\n'
refuses_table '&mesh file: needs at least two rows' 1 '0 400\n'
refuses_table '&mesh file: s is not ascending at row 3' 1 '0 400\n1 400\n0.5 400\n1.6 400\n'
refuses_table '&mesh file: s is not ascending at row 2' 1 '0 400\n0 400\n1.6 400\n'
refuses_table '&mesh file: covers s = 0 to 1.5 base pitches; the path of contact is 0 to 1.6' 1 '0 400\n1.5 400\n'
refuses_table '&mesh file: covers s = 0.1 to 1.6 base pitches; the path of contact is 0 to 1.6' 1 '0.1 400\n1.6 400\n'
refuses_table 'must be above 0 everywhere' 1 '0 400\n0.8 -1\n1.6 400\n'
refuses_table 'must be above 0 everywhere' 1 '0 0\n1.6 0\n'
for row in 'one two' '0.5' '0.5 NaN' '0.5 Inf' '0.5 400 1' '0.5 400 x' '0.5 1e999' 's k' '0.5/400' '0.5 2*400' '1d5d 3' '0.5 -'; do
  refuses_table 'pair.csv line 2: must be two numbers' 1 "0 400\n$row\n1.6 400\n"
done

base_changes=yes
# Unequal flanks shift the middle of the root lands; the default section follows.
cat >asymmetric.nml <<'END'
&case tasks = 'modal' / &pair module_mm = 4 face_width_mm = 20 coast_angle_deg = 30 /
&pinion teeth = 25 rack_tip_radius = 0.08 / &gear teeth = 40 rack_tip_radius = 0.08 /
&section elements_across = 6 / &modal modes = 2 /
END
run asymmetric.nml --out asymmetric
check 'unequal flanks: default section' exits 0
sed 's/&section/\&section teeth = 0 gear = "gear"/' asymmetric.nml >whole.nml
run whole.nml --out asymmetric
check 'teeth = 0: the whole gear' says stdout '40 of 40 teeth'
# Sections, stress and modes
cp coarse.nml base.nml
refuses '&section teeth = 31: must lie between 1 and the gear' 1 's/^  teeth = 3$/teeth = 31/; /half_angle/d'
refuses '&section teeth = -1: must be at least 0' 1 's/^  teeth = 3$/teeth = -1/'
refuses '&section half_angle_deg = 17.5: with 5 teeth it must lie between' 1 's/^  teeth = 3$/teeth = 5/'
refuses '&section half_angle_deg = 19: with 3 teeth it must lie between' 1 's/half_angle_deg = .*/half_angle_deg = 19/'
refuses '&section half_angle_deg = 15: with 3 teeth it must lie between' 1 's/half_angle_deg = .*/half_angle_deg = 15/'
refuses '&section half_angle_deg = 180: must be above 0 and below 180' 1 's/half_angle_deg = .*/half_angle_deg = 180/'
refuses '&section rim_mm = 0: must be above 0' 1 's/rim_mm = .*/rim_mm = 0/'
refuses '&section rim_mm = 2: the rim below the root circle is too thin' 1 's/rim_mm = .*/rim_mm = 2/'
refuses '&section rim_mm = 140.625: reaches into the bore; at most' 1 's/rack_tip_radius = .*/&  bore_mm = 500/'
refuses '&section rim_mm = -5: must be above 0' 1 's/rim_mm = .*/rim_mm = -5/'
refuses '&section rim_mm = NaN: must be' 1 's/rim_mm = .*/rim_mm = NaN/'
refuses '&section rim_mm = 343.75: must be above 0 and below the root radius 343.75 mm' 1 's/rim_mm = .*/rim_mm = 343.75/'
refuses '&section rim_mm = 400: must be above 0 and below the root radius' 1 's/rim_mm = .*/rim_mm = 400/'
refuses '&pinion bore_mm = 690: must be at least 0 and below the root diameter 687.5 mm' 1 's/teeth = 30$/teeth = 30 bore_mm = 690/; /rim_mm/d'
refuses '&pinion rack_tip_radius = 0.5: does not fit the rack' 1 's/rack_tip_radius = 0.30/rack_tip_radius = 0.5/'
refuses "&section fixed = 'web': must be one of" 1 "s/fixed = .*/fixed = 'web'/"
refuses "&section fixed = '': must be one of" 1 "s/fixed = .*/fixed = ''/"
refuses '&section fixed: the section is not held' 1 "s/fixed = .*/fixed = 'sides'/; s/^  teeth = 3$/teeth = 30/; /half_angle/d"
refuses "&section plane = 'shell': must be one of 'stress', 'strain'" 1 "s/plane = .*/plane = 'shell'/"
refuses "&section gear = 'wheel': must be one of 'pinion', 'gear'" 1 "s/gear = .*/gear = 'wheel'/"
refuses '&section elements_across = 2: must be at least 3 and at most 200' 1 's/across = .*/across = 2/'
refuses '&section elements_across = 201: must be at least 3 and at most 200' 1 's/across = .*/across = 201/'
refuses '&section elements_across = 6.5: must be an integer' 1 's/across = .*/across = 6.5/'
refuses '&section elements_across = 200: the grid has some' 6 's/across = .*/across = 200/; s/^  teeth = 3$/teeth = 30/; /half_angle/d'
refuses '&modal modes = 0: must be at least 1' 1 's/modes = .*/modes = 0/'
refuses '&modal modes = 1001: must be at least 1 and at most 1000' 1 's/modes = .*/modes = 1001/'
refuses '&modal modes = 900: ' 1 "s/modes = .*/modes = 900/; s/across = .*/across = 3/; s/tasks = .*/tasks = 'modal'/"
refuses '&static shares = 3, 1: must be at least 0 and at most 1' 1 's/shares = .*/shares = 3, 1/'
refuses '&static shares = 1: must be at least 2 numbers' 1 's/shares = .*/shares = 1/'
refuses "&static sharing = 'mesh': the shares are stated" 1 "s/shares/sharing = 'mesh' shares/"
refuses '&static positions = 9: there are as many as shares' 1 's/shares/positions = 9 shares/'
refuses "&static spacing = 'path': stated shares stand at equal arcs" 1 "s/shares/spacing = 'path' shares/"
refuses '&static positions = 1: must be at least 2' 1 's/shares = .*/positions = 1/'
refuses "&static spacing = 'arc': must be one of 'path', 'flank'" 1 "s/shares = .*/spacing = 'arc'/"
refuses "&static sharing = 'some': must be one of 'mesh', 'equal'" 1 "s/shares = .*/sharing = 'some'/"
refuses '&static tangent_deg = 90: must be above 0 and below 90' 1 's/tangent_deg = .*/tangent_deg = 90/'
for value in 5 89; do
  refuses 'must lie between' 1 "s/tangent_deg = .*/tangent_deg = $value/"
  refuses 'tangent' 1 "s/tangent_deg = .*/tangent_deg = $value/"
done
refuses '&load: give one of' 1 '/^&load/,/^\//d'
refuses '&static colour = 1: unknown key' 1 's/shares/colour = 1 shares/'
refuses "&section member = 'pinion': unknown key (did you mean gear?)" 1 "s/&section/\\&section member = 'pinion'/"
refuses '&sections: unknown group (did you mean &section?)' 1 's/^&section/\&sections/'
for group in section static modal; do
  case $group in section) key=rim_mm ;; static) key=tangent_deg ;; modal) key=modes ;; esac
  for value in NaN Inf 1e999 "'1'" some; do refuses "&$group $key = $value: must be" 1 "s/$key = .*/$key = $value/"; done
done

# Published values: text the message must contain, rows of the file
# refuses_published TEXT CODE ROWS
refuses_published() {
  printf "$3" >hassan2009.csv
  cp base.nml case.nml
  refuses_text "$1" "$2"
}
head_line='quantity,place,printed,unit,status,reason\n'
refuses_published 'lacks the line quantity,place,printed,unit,status,reason' 1 ''
refuses_published 'lacks the line quantity,place,printed,unit,status,reason' 1 '# only remarks\n'
refuses_published 'line 1: mode_1_hz,Table 1,7342,Hz,stated,x: must be quantity,place,printed,unit,status,reason' 1 'mode_1_hz,Table 1,7342,Hz,stated,x\n'
refuses_published 'line 2: printed = one: must be a number' 1 "${head_line}mode_1_hz,Table 1,one,Hz,stated,x\n"
refuses_published 'line 2: printed = NaN: must be a number' 1 "${head_line}mode_1_hz,Table 1,NaN,Hz,stated,x\n"
refuses_published 'line 2: printed = 1e999: must be a number' 1 "${head_line}mode_1_hz,Table 1,1e999,Hz,stated,x\n"
refuses_published 'line 3: status = sure: must be stated, inferred, fitted or not reproducible' 1 "${head_line}\nmode_1_hz,Table 1,7342,Hz,sure,x\n"
refuses_published 'line 2: status = : must be stated' 1 "${head_line}mode_1_hz,Table 1,7342\n"
rm -f hassan2009.csv
cp base.nml case.nml
refuses_text 'hassan2009.csv' 3
mkdir hassan2009.csv
refuses_text 'hassan2009.csv' 3
rmdir hassan2009.csv
cp "$root/data/hassan2009.csv" hassan2009.csv
# Without the task that finds it, a value is not computed; the others are as they were.
sed "s/tasks = .*/tasks = 'static'/" base.nml >case.nml
run case.nml --out partly
check 'published: not computed by these tasks' says stdout 'not computed by these tasks'
check 'published: NaN where not computed' test "$(rows partly/case.published.csv |
  awk -F, '$4 == "NaN" { print $1 }' | tr '\n' ' ')" = 'mode_1_hz mode_2_hz mode_3_hz mode_4_hz mode_5_hz '

# A section that only the stiffness uses
cp geared.nml base.nml
refuses '&section teeth = 26: must lie between 1 and the gear' 1 's/teeth = 3$/teeth = 26/'
refuses '&section fixed: the section is not held' 1 "s/teeth = 3$/teeth = 25/; s/fixed = .*/fixed = 'sides'/"
refuses '&section rim_mm = 40: must be above 0 and below the root radius' 1 's/^&section/\&section rim_mm = 40/'

# --- standard input, and what an interrupted run leaves -------------------------

cat >long.nml <<'END'
&case tasks = 'mesh', 'load', 'sweep', 'optimum' /
&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.9 /
&load normal_force_n = 6858 / &relief amount_um = 0, 2, 15 /
&mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400, 0, -120 /
&dynamics damping_ratio = 0.01 /
&sweep rpm_first = 5000 rpm_last = 9000 rpm_step = 3 load_rpm = 6800 /
END
sed "s/'mesh', 'load', 'sweep', 'optimum'/'sweep'/; s/ load_rpm = 6800//; s/rpm_step = 3/rpm_step = 500/" long.nml >short.nml
run short.nml --out named
sed '/^Time/d; s,named/short,from_stdin/stdin,' stdout >wanted
"$program" - --out from_stdin <short.nml >stdout 2>stderr
sed '/^Time/d' stdout >found
check 'standard input: the same answer' same wanted found
check 'standard input: the same table' same named/short.sweep.csv from_stdin/stdin.sweep.csv
cat short.nml | "$program" - --out from_stdin --name pair --quiet
check 'a name for the tables' same named/short.sweep.csv from_stdin/pair.sweep.csv
"$program" - --out from_stdin </dev/null >stdout 2>stderr
check 'standard input: nothing on it' test $? = 1
"$program" - --name a/b --out from_stdin <short.nml >stdout 2>stderr
check 'a name is no path' test $? = 2

run long.nml --out whole
# interrupted CASE OPTIONS: ends the run a while after it has begun.
interrupted() {
  "$program" "$@" --out pieces >stdout 2>stderr &
  pid=$!
  sleep "${delay-0.3}"
  kill -"$signal" $pid 2>/dev/null
  wait $pid
}
signal=INT
# Until the sweep has begun by then.
for delay in 0.3 1 3 9; do
  interrupted long.nml --verbose
  code=$?
  [ -e pieces/long.sweep.csv ] && rows pieces/long.sweep.csv | grep -v stopped >ours && break
done
unset delay
check 'interrupted: exit code' test $code = 130
check 'interrupted: says what is there' says stderr 'gearsweep: interrupted; the tables have what was computed by then'
check 'interrupted: the log' says stdout 'interrupted'
check 'interrupted: the finished table is whole' same whole/long.mesh.csv pieces/long.mesh.csv
check 'interrupted: something is computed' test -s ours
check 'interrupted: what is computed is right' test "$(rows whole/long.sweep.csv | grep -Fxvf - ours | wc -l)" = 0
check 'interrupted: no optimum' test ! -e pieces/long.optimum_curve.csv
# So many points that no machine is through with them by then.
sed "s/'mesh', 'load', 'sweep', 'optimum'/'sweep'/; s/ load_rpm = 6800//; s/rpm_step = 3/rpm_step = 0.2/" long.nml >fine.nml
interrupted fine.nml
check 'interrupted: what is not computed says so' test "$(rows pieces/fine.sweep.csv | grep -c ',NaN,NaN,stopped,')" -gt 0
rm -rf pieces
signal=TERM
interrupted long.nml
check 'ended by TERM: exit code' test $? = 130
check 'ended by TERM: the finished table is whole' same whole/long.mesh.csv pieces/long.mesh.csv
run long.nml --out pieces
for kind in mesh load sweep optimum_curve; do
  check "after an interrupted run: $kind as without" same whole/long.$kind.csv pieces/long.$kind.csv
done
check 'after an interrupted run: the same files' test "$(ls pieces)" = "$(ls whole)"
rm -rf pieces
run long.nml --out pieces --resume
check 'a single run is not resumed' is_one_error 'gearsweep: --resume: a single run is no longer resumed from a file: ' 2
check 'a single run is not resumed: what to use' says stderr 'from the store of `gearsweep many`'
check 'a single run is not resumed: nothing is made' test ! -e pieces

# --- random bytes: refused in good order, whatever they are -------------------

awk 'BEGIN { srand(2) ; for (i = 0; i < 90; i++) print int(rand()*1000000), i % 3 == 2 ? "coarse" : "cheap" }' >seeds
broken=0
while read -r seed name; do
  # A case with a few characters changed, dropped or doubled.
  awk -v seed="$seed" 'BEGIN { srand(seed); RS = "\001" }
    { n = length($0); marks = "&/=,!*()\"'\''0.-eE \n\tx"
      for (k = 0; k < 4; k++) {
        at = 1 + int(rand()*n); what = rand()
        if (what < 0.4) $0 = substr($0, 1, at - 1) substr(marks, 1 + int(rand()*length(marks)), 1) substr($0, at + 1)
        else if (what < 0.7) $0 = substr($0, 1, at - 1) substr($0, at + 1 + int(rand()*5))
        else $0 = substr($0, 1, at) substr($0, at)
        n = length($0)
      }
      printf "%s", $0 }' $name.nml | sed "s/tasks = .*'optimum'/tasks = 'mesh'/" >case.nml
  rm -rf out
  run case.nml --out out
  case $code in
    0 | 4) silent stderr ;;
    1) is_one_error 'gearsweep: ' 1 && no_files_in out ;;
    5 | 6) [ $name = coarse ] && is_one_error 'gearsweep: ' $code && no_files_in out ;;
    *) echo "  exit code $code: $(head -n 2 stderr)"; false ;;
  esac || { broken=$((broken + 1)); cp case.nml "broken$broken.nml"; echo "  seed $seed of $name"; }
done <seeds
check 'damaged cases are answered or refused in good order' test $broken = 0

finish
