"""Sets printed numbers beside ours and writes the report: `python -m validation --help`."""

import argparse
import pathlib
import sys
import textwrap

from . import check, ledger, moving_load, page, pictures, published, report, spread, three


def main(arguments=None):
    """0: every row is within its tolerance; 1: one is not, or its function failed; 2: not usable."""
    options = _options(arguments)
    if options.spread:
        print(spread.text())
        return 0
    if options.three:
        asked = three.computed()
        print(three.text(asked))
        return int(any('NOT within' in one for one in asked))
    outcomes, checks = _run(options.papers), _run(ledger.CHECKS)
    print(f'{report.made()}\n')
    print(f'{textwrap.fill(report.what_is_counted(outcomes), 130)}\n')
    print(report.counts_text(*report.summary(outcomes)))
    print(f'\n{report.counts_text(*report.summary_of_results(outcomes))}')
    print(f'\nOther checks: {_count(checks)}')
    for outcome in outcomes + checks:
        if outcome.bad:
            print(_complaint(outcome), file=sys.stderr)
    options.out.mkdir(parents=True, exist_ok=True)
    report.write_csv(options.out / 'report.csv', outcomes + checks)
    asked = three.computed() if {'dogan2021', 'hassan2009'} <= set(options.papers) else []
    report.write_page(options.out / 'report.html', outcomes + checks, pictures.all_for(options.papers), asked)
    print(f'Wrote {options.out / "report.html"} and report.csv')
    if options.pages:
        page.update(outcomes, three.markdown(asked))
        published.update()
        pictures.update()
        moving_load.update()
        print('Wrote doc/validation.md, doc/dynamic_factor.svg, doc/vibration.md and data/hassan2009.csv')
    if asked:
        print(f'\n{three.text(asked)}')
    return int(any(outcome.bad for outcome in outcomes + checks))


def _run(names):
    """All outcomes of these files, with a line on the progress before each."""
    outcomes = []
    for name in names:
        print(f'{name}: {len(ledger.read(name))} rows ...', file=sys.stderr, flush=True)
        outcomes += check.run([name])
    return outcomes


def _options(arguments):
    parser = argparse.ArgumentParser(
        prog='python -m validation',
        description='Sets the numbers that four papers print beside ours and writes a report.',
        epilog='Exit codes: 0 every row is within its tolerance, 1 one is not or its function failed, 2 wrong usage.')
    parser.add_argument('papers', nargs='*', metavar='PAPER', help=f'of {", ".join(ledger.PAPERS)}; all unless given')
    parser.add_argument('--out', type=pathlib.Path, default=pathlib.Path('results/validation'), metavar='FOLDER',
                        help='where report.html and report.csv go (default: %(default)s)')
    parser.add_argument('--pages', action='store_true',
                        help='also renew what doc/ and data/ take from the ledger')
    parser.add_argument('--three', action='store_true',
                        help='only print the three checks of the first lines of doc/validation.md, in seconds')
    parser.add_argument('--spread', action='store_true', help='only print how far unstated inputs move our values')
    options = parser.parse_args(arguments)
    for paper in options.papers:
        if paper not in ledger.PAPERS:
            parser.error(f'no paper {paper}: one of {", ".join(ledger.PAPERS)}')
    if options.pages and options.papers:
        parser.error('--pages needs all papers')
    options.papers = options.papers or list(ledger.PAPERS)
    return options


def _count(outcomes):
    count = check.counts(outcomes)
    return f'{count["within"]} within tolerance, {count["deviates"] + count["failed"]} deviating'


def _complaint(outcome):
    row = outcome.row
    if outcome.message:
        return f'{row.name}: {row.ours}: {outcome.message}'
    ours = report.number(outcome.ours)
    return f'{row.name}: {row.quantity}: printed {row.printed}, ours {ours}, allowed {row.allowed:.3g}'


if __name__ == '__main__':
    sys.exit(main())
