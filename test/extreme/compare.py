"""Is doc/limits.md what its command makes? python3 test/extreme/compare.py PAGE INTRODUCTION TABLE

Words must be the same. Numbers may differ by one unit of their last digit, and those that are rounding, below 1e-7, by anything
that is below 1e-7 too: they depend on the processor. The last line names the machine and does not count.
"""

import pathlib
import re
import sys

NUMBER = re.compile(r'(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?')
ROUNDING = 1e-7


def unit(number):
    mantissa, _, power = number.partition('e')
    return 10.0 ** (int(power or 0) - len(mantissa.partition('.')[2]))


def alike(line, other):
    if NUMBER.sub('#', line) != NUMBER.sub('#', other):
        return False
    return all(
        abs(float(a) - float(b)) <= 1.001 * max(unit(a), unit(b)) or max(abs(float(a)), abs(float(b))) < ROUNDING
        for a, b in zip(NUMBER.findall(line), NUMBER.findall(other))
    )


def main(page, introduction, table):
    said = pathlib.Path(page).read_text(encoding='utf-8').splitlines()[:-1]
    made = [line for path in (introduction, table) for line in pathlib.Path(path).read_text(encoding='utf-8').splitlines()][:-1]
    while said and not said[-1]:
        said.pop()
    while made and not made[-1]:
        made.pop()
    if len(said) != len(made):
        print(f'{page} has {len(said)} lines, the command makes {len(made)}')
    bad = [(old, new) for old, new in zip(said, made) if not alike(old, new)]
    for old, new in bad:
        print(f'  page  {old}\n  now   {new}')
    return int(bool(bad) or len(said) != len(made))


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
