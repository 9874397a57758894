"""Is test/properties/extreme/table.md what its command makes? python3 test/properties/extreme/compare.py PAGE INTRODUCTION TABLE

Words must be the same, and so must whole numbers and numbers of one or two digits. Other numbers may differ by one unit of the last. Those below
SMALL are partly rounding, which depends on the processor: they may differ by a factor of FACTOR, and below LEAST, where they are
rounding alone, by anything that is below LEAST too. What follows the number of cases, on time and machine, does not count.
"""

import pathlib
import re
import sys

NUMBER = re.compile(r'(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?')
SMALL, FACTOR, LEAST = 1e-6, 3, 1e-12


def unit(number):
    """Of the last digit."""
    mantissa, _, power = number.partition('e')
    return 10.0 ** (int(power or 0) - len(mantissa.partition('.')[2]))


def digits(number):
    """How many count."""
    return len(number.partition('e')[0].replace('.', '').lstrip('-0'))


def close(a, b, least=LEAST):
    if a == b:
        return True
    x, y = sorted((abs(float(a)), abs(float(b))))
    if y < least:
        return True
    if float(a) * float(b) < 0:
        return False
    if y < SMALL:
        return y <= 1.001 * FACTOR * x
    return min(digits(a), digits(b)) > 2 and {'.', 'e'} & {*a, *b} != set() and y - x <= 1.001 * min(unit(a), unit(b))


def alike(line, other, least=LEAST):
    line, other = (re.sub(r'^(\d+ cases\.).*', r'\1', text) for text in (line, other))
    return NUMBER.sub('#', line) == NUMBER.sub('#', other) and all(
        close(a, b, least) for a, b in zip(NUMBER.findall(line), NUMBER.findall(other)))


def lines_of(*paths):
    text = '\n'.join(pathlib.Path(path).read_text(encoding='utf-8').rstrip('\n') for path in paths)
    return [line for line in text.splitlines() if line.strip()]


def main(page, introduction, table):
    said, made = lines_of(page), lines_of(introduction, table)
    if len(said) != len(made):
        print(f'{page} has {len(said)} lines, the command makes {len(made)}')
    bad = [(old, new) for old, new in zip(said, made) if not alike(old, new)]
    for old, new in bad:
        print(f'  page  {old}\n  now   {new}')
    return int(bool(bad) or len(said) != len(made))


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
