"""Write motions.dat: all attracting motions of random rows, from spread starts, by the solver of motions.cpp.

Of the first rows of rows.py those whose mesh frequency is above 0.3 natural frequencies, where a mesh period
takes little time.  A line `row` has the columns of ../model.py from id to rpm.  The lines `motion` below it:
mesh periods until it repeats, DF, largest Floquet modulus, x [um] and v [m/s] at phase 0, loss (as in
../model.py), and the share of the starts that lead to it.  A line `nowhere`: the share of those that none
captures.
"""

from campaign import LONGEST, STARTS, solve, solver
from rows import frequency_ratio, rows

COUNT = 40

if __name__ == '__main__':
    points = [row for row in rows('all', COUNT) if frequency_ratio(row) > 0.3]
    found = solve(solver(), STARTS, LONGEST, [' '.join(map(str, row)) for row in points])
    with open('motions.dat', 'w') as file:
        file.writelines(('# ' + line).rstrip() + '\n' for line in __doc__.strip().split('\n'))
        for row in points:
            print('row', *row, file=file)
            for periods, factor, modulus, x, v, loss, starts in (orbit for orbit in found[row[0]] if orbit[0] > 0):
                print('motion', int(periods), f'{factor:.10f} {modulus:.8f} {x:.9g} {v:.9g}', int(loss), starts / STARTS, file=file)
            print('nowhere', found[row[0]][-1][1] / STARTS, file=file)
