#!/bin/sh
# Faults of files, folders, pipes and texts around the program: sh test/cases/test_faults.sh PROGRAM
# What is expected is told where it is asked: mostly that old tables stay as they are, bit by bit, or that new ones are
# those of a run that nothing disturbed. The last line is `N passed, N failed`.
# Takes about 1 min.
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd) || exit
program=${1:-$root/build/run/gearsweep}
case $program in /*) ;; *) program=$PWD/$program ;; esac
. "$root/test/checks.sh"
need timeout flock truncate mkfifo
cd "$work" || exit

# --- tools -------------------------------------------------------------------

# run ARGUMENTS...: runs the program; leaves $code, stdout and stderr.
run() {
  timeout 120 "$program" "$@" >stdout 2>stderr </dev/null
  code=$?
}

exits() { [ "$code" = "$1" ] || { echo "  exit code $code, not $1: $(head -c 300 stderr)"; return 1; }; }
says() { grep -qF -- "$2" "$1" || { echo "  $1 lacks: $2; it has: $(head -n 3 "$1")"; return 1; }; }
alike() { diff -r "$1" "$2" >difference || { echo "  $1 and $2: $(head -n 3 difference)"; return 1; }; }

# is_one_error TEXT CODE: exit code, and one line on stderr that has the text.
is_one_error() {
  exits "$2" || return
  [ "$(wc -l <stderr)" -eq 1 ] || { echo "  not one line: $(head -n 5 stderr)"; return 1; }
  says stderr "$1"
}

# A mesh with no geometry behind it: tables of 2, 41 and 100 kB within a hundredth of a second.
# pair FILE TASKS AMOUNT [KEYS OF CASE]
pair() {
  cat >"$1" <<CASE
&case tasks = $2 $4 /
&pinion teeth = 25 effective_mass_kg = 0.8 /
&gear effective_mass_kg = 0.9 /
&load normal_force_n = 6858 /
&relief amount_um = 0, $3 /
&mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400, 0, -120 /
&sweep rpm_first = 2000 rpm_last = 16000 rpm_step = 100 /
CASE
}
mkdir one other
pair one/q.nml "'mesh', 'sweep'" 15
pair other/q.nml "'mesh', 'sweep'" 12
pair q.nml "'mesh', 'sweep'" 15
run one/q.nml --out one.kept
check 'the first case' exits 0
run other/q.nml --out other.kept
check 'the second case' exits 0
check 'every table of the cases differs' test "$(diff -rq one.kept other.kept | wc -l)" = "$(ls one.kept | wc -l)"
# The other case's tables are there; a run of the first fails, or disturbs them wholly.
old_tables() { rm -rf out && cp -R other.kept out; }

# --- a disk that is full ------------------------------------------------------

# As if the disk were full after so many blocks of 512 bytes.
limited() {
  (
    ulimit -f "$1"
    timeout 120 "$program" one/q.nml --out out >stdout 2>stderr </dev/null
  )
  code=$?
}
for blocks in 1 5 30 82 100 190; do
  old_tables
  limited $blocks
  check "files of $blocks blocks at most: refused" is_one_error 'cannot write out/q.' 3
  check "files of $blocks blocks at most: the reason" says stderr ': File too large'
  check "files of $blocks blocks at most: the old tables stay, and nothing else" alike out other.kept
  check "files of $blocks blocks at most: nothing hidden is left" test -z "$(find out -name '.*')"
done
rm -rf out
limited 1
check 'a folder made for what fails is removed' test ! -e out
old_tables
limited 400
check 'files of 400 blocks are enough' exits 0
check 'files of 400 blocks are enough: the new tables' alike out one.kept

# A true disk, where this machine lets us have one; each run leaves it a little less room.
cat >disk.sh <<'END_OF_DISK'
mount -t tmpfs -o size=464k gearsweep disk || exit 77
mkdir disk/out
for kept in 0 16 40 64 88 112 140 180 220; do
  rm -rf disk/out/* disk/ballast
  cp other.kept/* disk/out
  head -c ${kept}k /dev/zero >disk/ballast
  timeout 120 "$program" one/q.nml --out disk/out >stdout 2>stderr </dev/null
  code=$?
  if [ $code = 0 ]; then
    diff -r disk/out one.kept && echo whole
  else
    grep -q 'gearsweep: cannot write .*disk/out.*: No space left on device' stderr && [ $code = 3 ] &&
      diff -r disk/out other.kept && echo kept
  fi || echo "broken with $kept kB less: code $code, $(cat stderr)"
  [ -z "$(find disk/out -name '.*')" ] || echo left
done
umount disk
END_OF_DISK
mkdir -p disk
export program
unshare -rm sh disk.sh >disk.log 2>disk.err || unshare -m sh disk.sh >disk.log 2>disk.err
if [ $? = 77 ] || [ ! -s disk.log ]; then
  echo 'No small disk can be mounted here: of full disks, the limits above are the test.'
else
  sort -u disk.log >disk.found
  printf 'kept\nwhole\n' >disk.wanted
  check 'a full disk: old tables or new ones, whole' alike disk.found disk.wanted
fi

# --- names of others ------------------------------------------------------------

# Whatever lies in the folder under names that a temporary file could have: it stays, and no link is followed.
printf 'mine\n' >victim
old_tables
mkdir victims
cp victim victims/file
for name in .gearsweep.part q.mesh.csv.part q.harmonics.csv.part q.sweep.csv.part .gearsweep-1; do
  ln -s "$PWD/victim" "out/$name"
done
ln -s "$PWD/victims" out/.gearsweep-2
mkfifo out/.gearsweep-3
cp victim out/.gearsweep-4
timeout 20 "$program" one/q.nml --out out >stdout 2>stderr </dev/null
code=$?
check 'links of temporary names: done' exits 0
check 'links of temporary names: the target' test "$(cat victim)" = mine
check 'links of temporary names: the target of a folder' test "$(ls -A victims)$(cat victims/file)" = filemine
check 'links of temporary names: they stay' test "$(find out -type l | wc -l)$(cat out/.gearsweep-4)" = 6mine
find out -name '.gearsweep*' -exec rm {} +
rm -f out/*.part
check 'links of temporary names: the tables' alike out one.kept
old_tables
for name in .gearsweep.part q.mesh.csv.part q.sweep.csv.part; do mkfifo "out/$name"; done
timeout 20 "$program" one/q.nml --out out >stdout 2>stderr </dev/null
code=$?
check 'pipes of temporary names: nothing is waited for' exits 0
# A table that is a link becomes a file; its target stays.
old_tables
ln -f victim out/q.sweep.csv
rm out/q.mesh.csv
ln -s "$PWD/victim" out/q.mesh.csv
run one/q.nml --out out
check 'links of tables: the target' test "$(cat victim)" = mine
check 'links of tables: they are kept' test "$(cat out/q.mesh.csv.old out/q.sweep.csv.old | tr -d '\n')" = minemine
rm -f out/*.old
check 'links of tables: the tables' alike out one.kept
# A file of a table's name that is none is kept; where it cannot be, all stays as it was.
old_tables
cp victim out/q.sweep.csv
run one/q.nml --out out
check 'a file of the name of a table: done' exits 0
check 'a file of the name of a table: kept' test "$(cat out/q.sweep.csv.old)" = mine
rm -f out/*.old
check 'a file of the name of a table: the tables' alike out one.kept
old_tables
cp victim out/q.sweep.csv
mkdir out/q.sweep.csv.old
run one/q.nml --out out
check 'a file of the name of a table that cannot be kept' is_one_error 'cannot write out/q.sweep.csv: ' 3
check 'a file of the name of a table that cannot be kept: it stays' test "$(cat out/q.sweep.csv)" = mine
cp other.kept/q.sweep.csv out
rmdir out/q.sweep.csv.old
check 'a file of the name of a table that cannot be kept: the others stay' alike out other.kept

# What a killed run left goes with the next one; what a running one has stays.
old_tables
mkdir -m 700 out/.gearsweep-1 out/.gearsweep-2
echo half >out/.gearsweep-1/new-1
echo half >out/.gearsweep-2/new-1
exec 8<out/.gearsweep-2
flock 8
run one/q.nml --out out
check 'leftovers: done' exits 0
check 'leftovers: of a killed run' test ! -e out/.gearsweep-1
check 'leftovers: of a running one' test "$(cat out/.gearsweep-2/new-1)" = half
exec 8<&-
run one/q.nml --out out
rm -rf out/.gearsweep-2
check 'leftovers: the tables' alike out one.kept
# Killed at any moment: every table is whole, and the next run cleans up.
many=0.1
i=0
while [ $i -lt 300 ]; do i=$((i + 1)) many="$many, 0.$((1000 + i))"; done
pair large.nml "'mesh'" "$many"
run large.nml --out large.kept
check 'many reliefs' exits 0
broken=0
for wait in 0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8; do
  rm -rf out
  "$program" large.nml --out out >/dev/null 2>&1 &
  victim=$!
  sleep $wait
  kill -9 $victim 2>/dev/null
  wait $victim 2>/dev/null
  mkdir -p out
  for table in out/*.csv; do
    [ ! -e "$table" ] || cmp -s "$table" "large.kept/${table#out/}" || broken=$((broken + 1))
  done
  run large.nml --out out
  diff -r out large.kept >/dev/null || broken=$((broken + 1))
done
check 'killed runs: whole tables, and nothing is left by the next run' test $broken = 0

# --- two runs into one folder ------------------------------------------------------

# Under one name: the tables of the one or of the other. With `mesh` alone, the second has no sweep.
pair other/q.nml "'mesh', 'sweep'" 12
for second in "'mesh', 'sweep'" "'mesh'"; do
  pair other/q.nml "$second" 12
  rm -rf other.kept
  run other/q.nml --out other.kept
  mixed=0
  rm -rf out
  for round in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
    for case in one other one other; do "$program" $case/q.nml --out out >/dev/null 2>>errors & done
    wait
    rm -f out/*.old
    diff -r out one.kept >/dev/null || diff -r out other.kept >/dev/null || mixed=$((mixed + 1))
  done
  check "four runs at once, the second with $second: sets of tables that are mixed" test $mixed = 0
done
check 'runs at once: no errors' test ! -s errors
# One after the other: a table that the second has not belongs to the first, and is kept as such.
rm -rf out
run one/q.nml --out out
echo 'mine' >out/q.load.csv
run other/q.nml --out out
check 'an earlier table' cmp -s out/q.sweep.csv.old one.kept/q.sweep.csv
rm out/*.csv.old
check 'a file of another kind stays' test "$(cat out/q.load.csv)" = mine
rm out/q.load.csv
check 'the set of the second' alike out other.kept
pair other/q.nml "'mesh', 'sweep'" 12
rm -rf other.kept
run other/q.nml --out other.kept
# One table that cannot be shown, the last: none is.
old_tables
rm out/q.sweep.csv
mkdir out/q.sweep.csv
run one/q.nml --out out
check 'a folder in the way of a table' is_one_error 'cannot write out/q.sweep.csv: Is a directory' 3
rmdir out/q.sweep.csv
cp other.kept/q.sweep.csv out
check 'a folder in the way of a table: the others stay' alike out other.kept
exec 8<out
flock 8
"$program" one/q.nml --out out 8<&- >/dev/null 2>&1 &
waiter=$!
wait_for_lock() {
  sleep 1
  cmp -s out/q.sweep.csv other.kept/q.sweep.csv
}
check 'a locked folder is waited for' wait_for_lock
exec 8<&-
wait $waiter
check 'a locked folder: done when it is free' alike out one.kept

# --- signals ------------------------------------------------------------

# waiting CASE OPTIONS...: the program at work on a case that takes minutes; leaves $pid.
waiting() {
  "$program" "$@" >stdout 2>stderr &
  pid=$!
  sleep 1
}
# ends_by SIGNAL: it is at work, and ends within 20 s of the signal, be the machine busy. Leaves $code.
ends_by() {
  kill -0 $pid || { echo "  had ended before: $(head -c 300 stderr)"; return 1; }
  kill -"$1" $pid
  for i in $(seq 200); do
    kill -0 $pid 2>/dev/null || break
    sleep 0.1
  done
  kill -9 $pid 2>/dev/null && echo '  was still at work'
  wait $pid
  code=$?
  [ $code != 137 ]
}
# A motion of 10 million mesh periods, and a map of 100 000 damping ratios.
pair long.nml "'poincare', 'mesh'" 12
echo '&poincare rpm = 5000 settling_periods = 9999999 /' >>long.nml
pair map.nml "'stability'" 12
echo '&stability rpm = 7 damping_count = 99999 /' >>map.nml
for case in long map; do
  for signal in INT TERM; do
    waiting $case.nml --out ended
    check "$case: ends by $signal" ends_by $signal
    check "$case: ends by $signal: code" exits 130
    check "$case: ends by $signal: says so" is_one_error 'gearsweep: interrupted; the tables have what was computed by then' 130
  done
done
check 'long: leaves the table of the finished task' test -s ended/long.mesh.csv
check 'tables are all that is left' test "$(find ended -type f ! -name '*.csv' | wc -l)" = 0
check 'long: no table of the task that was not finished' test -z "$(find ended -name 'long.poincare*')"
rm -rf ended
# Whoever waits for a case on the standard input ends by the first signal.
mkfifo never
"$program" - --out out <never >stdout 2>stderr &
pid=$!
exec 8>never
sleep 0.5
check 'waiting for a case: ends by TERM' ends_by TERM
exec 8>&-
rm never

# --- files that are read ------------------------------------------------------------

# reads TITLE FILE TEXT CODE: refused within 20 s as case, as table of stiffness and as published values.
sed "s/model = .*/model = 'table' contact_ratio = 1.6 file = 'input' \//" q.nml >table.nml
pair published.nml "'mesh'" 15 "published = 'input'"
refused_as() {
  rm -rf out
  timeout 20 "$program" "$2" --out out >stdout 2>stderr </dev/null
  code=$?
  check "$1" is_one_error "$3" "$4"
  check "$1: nothing is made" test ! -e out
}
ln -s /dev/zero input
refused_as 'zeros without end as a case' input 'input: is longer than 10 MB' 1
for case in table published; do
  refused_as "a device as $case" $case.nml 'cannot read input: it is no regular file' 3
done
rm input
mkfifo input
for case in table published; do
  refused_as "a pipe as $case" $case.nml 'cannot read input: it is no regular file' 3
done
rm input
mkdir input
refused_as 'a folder as case' input 'cannot read input: Is a directory' 3
for case in table published; do refused_as "a folder as $case" $case.nml 'cannot read input: Is a directory' 3; done
rmdir input
truncate -s 3G input
refused_as '3 GB as case' input 'input: is longer than 10 MB' 1
for case in table published; do refused_as "3 GB as $case" $case.nml 'input: is longer than 10 MB' 1; done
rm input
# In linear time. Byte by byte, 1 MB took ten minutes, and 50 000 rows took as long; now a second is enough for each.
{ cat q.nml; awk 'BEGIN { for (i = 0; i < 20000; i++) print "! 0123456789 0123456789 0123456789 0123456789 0123" }'; } >long.nml
cat long.nml | timeout 30 "$program" /dev/stdin --out out >stdout 2>stderr
code=$?
check 'a piped case of 1 MB' exits 0
{
  echo quantity,place,printed,unit,status,reason
  awk 'BEGIN { for (i = 1; i <= 50000; i++) print "contact_ratio,Table " i ",1.6,-,stated,row " i }'
} >input
timeout 30 "$program" published.nml --out out >stdout 2>stderr </dev/null
code=$?
check '50 000 published values' exits 0
check '50 000 published values: all are told' test "$(grep -c '^contact_ratio,' out/published.published.csv)" = 50000
awk 'BEGIN { for (i = 0; i <= 100000; i++) printf "%.9f;%.9f\n", 1.6*i/100000, 400 - (i/50000 - 1)^2 }' >input
sed "s/tasks = .*/tasks = 'mesh' \//" table.nml >long.nml
timeout 30 "$program" long.nml --out out >stdout 2>stderr </dev/null
code=$?
check '100 001 rows of stiffness' exits 0
awk 'BEGIN { for (i = 0; i < 500000; i++) print i ", 400"; print "end" }' >input
refused_as '500 000 rows of stiffness' table.nml 'input line 500001: must be two numbers' 1

# --- texts ------------------------------------------------------------

# Control characters, which a terminal would obey, are refused by line and code.
for control in '\033[31m 27' '\007 7' '\000 0' '\032. 26' '\177 127' '\233 155' '\302\233 155' '\302\200 128'; do
  bytes=${control% *}
  code_of=${control##* }
  printf "quantity,place,printed,unit,status,reason\n# x\ncontact_ratio,p$bytes.,1.6,-,stated,\n" >input
  run published.nml --out none
  check "published values with $bytes" is_one_error "input line 3: a control character (code $code_of)" 1
  sed "1s/tasks/title = 'TITLE' tasks/" q.nml >titled.nml
  awk -v bytes="$bytes" 'BEGIN { RS = "TITLE" } NR > 1 { printf bytes } { printf "%s", $0 }' titled.nml >control.nml
  if [ "$bytes" = '\000' ]; then printf "! \\000\n&" >control.nml; fi
  run control.nml --out none
  check "a title with $bytes" is_one_error "line 1: a control character (code $code_of)" 1
done
check 'no control character on the terminal' test "$(tr -d '\n -~' <stderr | wc -c)" = 0
# Letters whose UTF-8 has bytes of that range, and those of Latin-1.
sed "1s/tasks/title = 'Größe ě – €' tasks/" q.nml >titled.nml
run titled.nml --out titled
check 'a title in UTF-8' exits 0
check 'a title in UTF-8: as it was' says stdout 'Größe ě – €'
printf "&case title = 'Gr\366\337e' tasks = 'mesh', 'sweep' /\n" | cat - q.nml | sed 2d >titled.nml
run titled.nml --out titled
check 'a title in Latin-1' exits 0
check 'a title in Latin-1: read as such' says stdout 'Größe'
check 'a title in Latin-1: all files are in UTF-8' iconv -f UTF-8 -t UTF-16 -o /dev/null titled/titled.*.csv
# A case as old Macs, DOS and Fortran 77 have it: the same tables.
run q.nml --out old --name q
tr '\n' '\r' <q.nml | sed 's/&/$/g' | { cat; printf '\032'; } >mac.nml
run mac.nml --out old --name mac
check 'a case with CR, $ and an end mark' exits 0
check 'a case with CR, $ and an end mark: the same' sh -c 'grep -v "^#" old/q.sweep.csv >a && grep -v "^#" old/mac.sweep.csv >b && cmp a b'
iconv -f UTF-8 -t UTF-16 q.nml >wide.nml
run wide.nml --out none
check 'a case in UTF-16' is_one_error 'line 1: the text is in UTF-16; save it in UTF-8' 1
run "$(printf 'no\033[31m\nfile')" --out none
check 'a name with control characters in a message' is_one_error 'cannot read no<U+001B>[31m<U+000A>file: No such file or directory' 3
cp q.nml "$(printf 'q\n.nml')"
run "$(printf 'q\n.nml')" --out none
check 'a name with control characters for tables' is_one_error 'must not have control characters' 1
run q.nml --out "$(printf 'no\033ne')"
check 'a folder with control characters' is_one_error 'must not have control characters' 1
cp q.nml ..nml
run ..nml --out none
check 'a case without a name' is_one_error 'must be a name without a folder' 1
# What begins as a formula is a text with an apostrophe; a lone sign and plain words stay as they are.
cat >input <<'CSV'
quantity,place,printed,unit,status,reason
contact_ratio,=1+1,1.6,-,stated,
contact_ratio,@SUM(A1),1.6,+x,stated,-2+3
contact_ratio,"Table" 1,1.6,-,stated, =HYPERLINK("x","y")
contact_ratio,Table 1,1.6,-,stated,as "mode" 1, or 2
contact_ratio,Table 1,1.6,-,stated,as mode 1
contact_ratio,"Table 2, ""left""",1.6,"-",stated,"as ""mode"" 2, too"
CSV
cat >wanted <<'CSV'
contact_ratio,"'=1+1",-,stated,
contact_ratio,"'@SUM(A1)","'+x",stated,"'-2+3"
contact_ratio,"""Table"" 1",-,stated,"'=HYPERLINK(""x"",""y"")"
contact_ratio,Table 1,-,stated,"as ""mode"" 1, or 2"
contact_ratio,Table 1,-,stated,as mode 1
contact_ratio,"Table 2, ""left""",-,stated,"as ""mode"" 2, too"
CSV
run published.nml --out out
check 'formulas: done' exits 0
sed -n 's/^\(contact_ratio,.*\),1.60*E+000,[^,]*,[^,]*,/\1,/p' out/published.published.csv >found
check 'formulas and quotation marks in the table' alike found wanted

# --- the standard output ------------------------------------------------------------

for arguments in --help --version 'q.nml --out out' 'q.nml --out out --verbose'; do
  "$program" $arguments >/dev/full 2>stderr </dev/null
  code=$?
  check "full standard output: $arguments" is_one_error 'cannot write to the standard output: No space left on device' 3
  "$program" $arguments >&- 2>stderr </dev/null
  code=$?
  check "closed standard output: $arguments" is_one_error 'cannot write to the standard output: Bad file descriptor' 3
done
rm -rf out
"$program" one/q.nml --out out >/dev/full 2>stderr
check 'full standard output: the tables are there' alike out one.kept
rm -rf out
"$program" one/q.nml --out out >&- 2>&- <&-
check 'everything closed: the tables are there, and nothing else in them' alike out one.kept
"$program" q.nml --quiet --out out >/dev/full 2>stderr
code=$?
check 'full standard output, quiet: nothing to say' exits 0
# Who reads leaves at once: no message, and the tables are there. Where the signal of broken pipes is ignored, as by
# some parents, too.
rm -rf out
{ "$program" one/q.nml --out out 2>stderr; echo $? >ended; } | true
check 'a broken pipe is silent, and no failure' test "$(cat ended)$(cat stderr)" = 0
check 'a broken pipe: the tables' alike out one.kept
rm -rf out
(trap '' PIPE; { "$program" one/q.nml --out out 2>stderr; echo $? >ended; } | true)
check 'a broken pipe that is no signal' test "$(cat ended)$(cat stderr)" = 0
check 'a broken pipe that is no signal: the tables' alike out one.kept
for option in --describe --help '--new sweep'; do
  { "$program" $option 2>stderr; echo $? >ended; } | true
  check "a broken pipe: $option" test "$(cat ended)$(cat stderr)" = 0
done

finish
