"""Sees that mutants which are chosen when a program starts do as those that are compiled one at a time: every change of every
statement of a small program, and which of them are reached."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import instrument
import mutants

PROGRAM = """module forms
  implicit none
  private
  public :: total
contains
  pure integer function total(n)
    integer, intent(in) :: n
    integer :: i, k
    total = 7; k = 2
    total = 3*n + &   ! 2 terms
            1
    do i = 1, n - 1
      if (i == 3) cycle
      if (n > 4 .and. i > 1) then
        total = total + max(i, 2)
      else if (modulo(i, 2) == 1 &
               .or. n < 0) then
        total = total - 1; k = i
      end if
    end do
    k = 0
    do while (k < 4)
      k = k + 1
    end do
    if (n > 90) then
      total = -total
    end if
    call add(total, &
             k)
  end function total

  pure subroutine add(a, b)
    integer, intent(inout) :: a
    integer, intent(in) :: b
    if (b < 0) return
    a = a + 2*b
  end subroutine add
end module forms
program main
  use forms, only: total
  implicit none
  print '(3(i0, 1x))', total(2), total(6), total(7)
end program main
"""


def build(folder, name, text):
    """A program of one file, or nothing where it does not compile."""
    (folder / f'{name}.f90').write_text(text)
    words = ['gfortran', f'-O{1 if name == "together" else 0}', '-ffree-line-length-none', '-J', folder, folder / f'{name}.f90', folder / 'switch.o', '-o', folder / name]
    return folder / name if subprocess.run(words, capture_output=True, check=False).returncode == 0 else None


def said(program, states=None):
    """What the program prints, or that it does not end."""
    file = program.with_suffix('.states')
    file.write_bytes(instrument.states() if states is None else states)
    try:
        done = subprocess.run([program], capture_output=True, text=True, timeout=1, check=False,
                              env=os.environ | {'GEARSWEEP_MUTANTS': str(file)})
    except subprocess.TimeoutExpired:
        return 'no end', file.read_bytes()
    return done.stdout, file.read_bytes()


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / 'switch.c').write_text(instrument.SWITCH_C)
        subprocess.run(['gcc', '-c', folder / 'switch.c', '-o', folder / 'switch.o'], check=True)
        # All that can be done to each statement, but for what does not compile.
        alone = {}
        for mutant in mutants.ranked({'forms.f90': PROGRAM}):
            if program := build(folder, 'alone', mutant.put_into(PROGRAM)):
                alone[len(alone) + 1] = (mutant, said(program)[0])
        text, spans = instrument.wrapped(PROGRAM, {number: mutant for number, (mutant, _) in alone.items()})
        together = build(folder, 'together', instrument.SWITCH + text)
        clean = build(folder, 'clean', PROGRAM)
        assert together and clean, 'does not compile'
        assert set(spans) == set(alone), [alone[number][0] for number in set(alone) - set(spans)]
        assert said(together)[0] == said(clean)[0], 'differs with none chosen'
        for number, (mutant, expected) in alone.items():
            found = said(together, instrument.states([number]))[0]
            assert found == expected, (mutant.before, mutant.after, found, expected)
        words, states = said(together, instrument.states(count=len(alone)))
        assert words == said(clean)[0], 'differs while it tells what it reaches'
        missed = {alone[number][0].before for number in set(alone) - instrument.reached(states, len(alone))}
        assert missed == {'total = -total'}, missed
        assert len(alone) > 30 and len({expected for _, expected in alone.values()}) > 10
    return 0


if __name__ == '__main__':
    sys.exit(main())
