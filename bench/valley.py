"""The reliefs of case 1 with 1000 pairs of gears of class 6: the table behind the valley of doc/many.md, and its picture.

    python bench/valley.py PROGRAMS [DRAWS]     (bench/run.sh valley does this)

PROGRAMS is not used. The store in results/bench keeps what is done. The case is the one that the page shows.
"""
import re
import sys

from report import BENCH, RESULTS, Report, machine

import gearsweep
from gearsweep import many

WORKERS = 2


def main():
    page = (BENCH.parent / 'doc' / 'many.md').read_text(encoding='utf-8')
    shown = re.search(r"```python\n(case = gearsweep.*?)\nfound = many.robust\(case, relief=(\{.*?\})", page, flags=re.DOTALL)
    names = {'gearsweep': gearsweep}
    exec(shown[1].replace('data/', f'{BENCH.parent}/data/'), names)
    case, relief = names['case'], eval(shown[2])
    if len(sys.argv) > 2:
        case = case.changed(deviations={'draws': int(sys.argv[2])})
    RESULTS.mkdir(parents=True, exist_ok=True)
    found = many.robust(case, relief=relief, executor=WORKERS, store=RESULTS / 'valley.zarr', progress=True)
    report = Report('valley', f"{case.get('deviations', 'draws')} pairs of gears of class 6, case 1, with `quick`")
    report.add(f'```text\n{found}\n```\n')
    report.add(f'{machine()}; by `sh bench/run.sh valley`\n')
    report.save()
    found.plot().savefig(RESULTS / 'valley.svg')


if __name__ == '__main__':
    main()
