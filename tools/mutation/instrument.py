"""Many mutants in one build: each changed statement stands beside its original, and which of them runs is chosen by a file
when the program starts. The same file tells which changed statements a process reached."""

import re
from collections import defaultdict

import mutants

#: Of each mutant one byte, a page of them, as a file is mapped by pages; number 0 is nobody.
ROOM = 4096
OFF, ON, AWAITED, REACHED = 0, 1, 255, 0

SWITCH = f"""!> Which mutants are on: 0 off, 1 on, -1 off and to be noted when it is reached.
module gearsweep_mutants
  use, intrinsic :: iso_c_binding, only: c_int, c_signed_char
  implicit none
  private
  public :: mutant_state, mutant_on

  integer(c_signed_char), bind(c), protected :: mutant_state(0:{ROOM - 1})

  interface
    !> Pure as far as the code around it goes.
    pure integer(c_int) function mutant_on(number) bind(c)
      import :: c_int
      integer(c_int), value :: number
    end function mutant_on
  end interface
end module gearsweep_mutants
"""
# Fortran's own symbol has no alignment that would do for a page; the linker takes this one for both. Shared, so that what
# threads, children and killed processes reached is in the file.
SWITCH_C = f"""#define _GNU_SOURCE
#include <fcntl.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

signed char mutant_state[{ROOM}] __attribute__((aligned(4096)));

__attribute__((constructor)) static void mutant_begin(void)
{{
  const char *path = getenv("GEARSWEEP_MUTANTS");
  int file = path ? open(path, O_RDWR | O_CLOEXEC) : -1;

  if (file < 0) return;
  mmap(mutant_state, sizeof mutant_state, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, file, 0);
  close(file);
}}

int mutant_on(int number)
{{
  if (mutant_state[number] > 0) return 1;
  mutant_state[number] = 0;
  return 0;
}}
"""


def states(on=(), count=0):
    """The file's bytes with these mutants on, or the first `count` awaited."""
    found = bytearray(ROOM)
    found[1 : count + 1] = [AWAITED] * count
    for number in on:
        found[number] = ON
    return bytes(found)


def reached(found, count):
    """Which of the first `count` mutants, awaited before, were reached since."""
    return {number for number in range(1, count + 1) if found[number] == REACHED}


HEADING = re.compile(r'^([ \t]*(?:module|program)[ \t]+\w+)[ \t]*$', re.MULTILINE | re.IGNORECASE)
IMPORT = r'\1\n  use gearsweep_mutants, only: mutant_state, mutant_on'


def is_on(number):
    return f'(mutant_state({number}) /= 0 .and. mutant_on({number}) /= 0)'


def is_off(number):
    """Not `.not.` of the above: two calls that are alike are taken out of the expression, and would always be made."""
    return f'mutant_state({number}) <= 0'


def wrapped(text, numbered):
    """The text with these mutants of it, {number: mutant}, and {number: (first line, last line)} of those that it has: some
    headings of loops cannot be wrapped."""
    by_statement = defaultdict(list)
    statements = list(mutants.fortran_statements(text))
    for number, mutant in numbered.items():
        statement = next(s for s in statements if s.start <= mutant.start and mutant.end <= s.end)
        by_statement[statement].append((number, mutant))
    out, at, spans = '', 0, {}
    for statement in sorted(by_statement, key=lambda s: s.start):
        if changed := form(text, statement, by_statement[statement]):
            out += HEADING.sub(IMPORT, text[at : statement.start])
            first = out.count('\n') + 1
            out += changed
            at = statement.end
            spans |= {number: (first, out.count('\n') + 1) for number, _ in by_statement[statement]}
    return out + HEADING.sub(IMPORT, text[at:]), spans


def form(text, statement, chosen):
    """The statement with all its mutants, or nothing where it cannot be wrapped."""
    words = [token[0] for token in statement.tokens]
    original = text[statement.start : statement.end]

    def changed(start, end, mutant):
        return text[start : mutant.start] + mutant.replacement + text[mutant.end : end]

    if words[-1] == 'then' or words[0] == 'else' or 'while' in words:
        opening = next(i for i, word in enumerate(words) if word in ('if', 'while')) + 1
        start, end = statement.tokens[opening][2], statement.tokens[mutants.arguments(words, opening)[-1][1]][1]
        said = text[start:end]
        for number, mutant in chosen:
            said = f'({is_on(number)} .and. ({changed(start, end, mutant)}\n)) .or. ({is_off(number)} .and. ({said}\n))'
        return continued(text[statement.start : start] + said) + text[end : statement.end]
    if 'do' in words[:3] and words[0] != 'end':
        return bounds(text, statement, words, chosen)
    branches = ''
    for number, mutant in chosen:
        other = changed(statement.start, statement.end, mutant)
        branches += f'{"else " if branches else ""}if {is_on(number)} then\n{other}\n'
    return f'{branches}else\n{original}\nend if'


def bounds(text, statement, words, chosen):
    """A loop's heading: of each bound, the one or the other."""
    begin = words.index('=') + 1
    commas = [begin - 1]
    depth = 0
    for i in range(begin, len(words)):
        depth += (words[i] in mutants.OPENING) - (words[i] in mutants.CLOSING)
        if words[i] == ',' and depth == 0:
            commas.append(i)
    said = text[statement.start : statement.tokens[begin - 1][2]]
    left = dict(chosen)
    for k, comma in enumerate(commas):
        start = statement.tokens[comma][2]
        end = statement.tokens[commas[k + 1]][1] if k + 1 < len(commas) else statement.end
        bound = text[start:end].strip()
        for number, mutant in chosen:
            if start <= mutant.start and mutant.end <= end:
                other = text[start : mutant.start] + mutant.replacement + text[mutant.end : end]
                bound = f'merge({other}, {bound}, {is_on(number)})'
                left.pop(number)
        said += f'{", " if k else " "}{bound}'
    return None if left else continued(said)


def continued(said):
    """On one line, without what was said on the way."""
    return re.sub(r'\s*&?\s*\n\s*&?\s*', ' ', re.sub(r'!.*', '', said))
