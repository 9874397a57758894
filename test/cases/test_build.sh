#!/bin/sh
# What app/build.py compiles again after a change, in a tree of four small files: sh test/cases/test_build.sh
# The last line is `N passed, N failed`.
# Takes about 5 s.
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd) || exit
. "$root/test/checks.sh"
need gfortran gcc ar python3
tree="$work/a tree"
mkdir -p "$tree/src/room" "$tree/app" && cp "$root/app/build.py" "$tree/app" && cd "$tree" || exit
echo 'link = ["m"]' >fpm.toml
cat >src/room/low.f90 <<'F'
module low
  implicit none
contains
  integer function number()
    number = 41
  end function number
end module low
F
cat >src/room/high.f90 <<'F'
module high  ! uses what stands behind it in the order of names
  use, intrinsic :: iso_fortran_env, only: output_unit
  use :: low, only: number
  implicit none
  private
  public :: put
contains
  subroutine put()
    write (output_unit, '(i0)') number()
  end subroutine put
end module high
F
echo 'int unused(void) { return 0; }' >src/room/unused.c
printf 'program main\n  use high\n  call put()\nend program main\n' >app/main.f90

make() { python3 app/build.py out program "$@"; }
prints() { [ "$(out/program)" = "$1" ]; }
# compiles NAMES COMMAND...: what makes these objects anew, and no others.
compiles() {
  names=$1
  shift
  touch mark
  sleep 0.1
  "$@" || return
  echo "compiled: $(find out -newer mark -name '*.o' -exec basename {} .f90.o \; | LC_ALL=C sort | tr '\n' ' ')"
  [ "$(find out -newer mark -name '*.o' -exec basename {} .f90.o \; | LC_ALL=C sort | tr '\n' ' ')" = "$names" ]
}
all='app_main src_room_high src_room_low src_room_unused.c.o '

check 'builds all, in a path with a blank' compiles "$all" make
check 'the program runs' prints 41
check 'nothing changed: compiles nothing' compiles '' make
sed -i 's/= 41/= 42/' src/room/low.f90
check 'a changed body: compiles one file' compiles 'src_room_low ' make
check 'the program has the change' prints 42
sed -i 's/integer function number()/integer function number(add)\n    integer, intent(in), optional :: add/' src/room/low.f90
check 'a changed interface: compiles what uses it too' compiles 'src_room_high src_room_low ' make
rm out/src/src_room_high.f90.o
check 'a lost object is made again' compiles 'src_room_high ' make
check 'other flags: compiles all Fortran' compiles 'app_main src_room_high src_room_low ' make --flags=-O0
rm src/room/unused.c
check 'a file less' compiles '' make --flags=-O0
check 'the library has nothing of it' sh -c '! ar t out/libgearsweep.a | grep unused'
sed -i 's/= 42/= "x"/' src/room/low.f90
check 'an error ends it with the message of the compiler' sh -c '! python3 app/build.py out program 2>why && grep -q "failed: src/room/low.f90" why && grep -q "Error:" why'
printf 'module low\n  use high\nend module low\n' >src/room/low.f90
check 'modules that use each other are named' sh -c '! python3 app/build.py out program 2>why && grep -q "use each other: .*src/room/low.f90" why'
finish
