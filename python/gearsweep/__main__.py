"""`python -m gearsweep CASE.nml`: the program gearsweep, with pictures; `gearsweep panel`: the front panel."""

from __future__ import annotations

import contextlib
import difflib
import os
import signal
import sys
import tempfile
import time
import unicodedata
from dataclasses import dataclass

from . import Case, Code, Error, Study, __version__
from .core.files import try_file
from .core.library import describe, edit
from .core.study import attempt
from .core.terminal import print_error, print_text
from .core.texts import decoded
from .core.watch import Line
from .report.page import write as write_page

HELP = f"""gearsweep {__version__}: dynamic factor of a spur-gear pair over speed and tip relief

usage: gearsweep CASE.nml [options]      (- reads the case from standard input)
       gearsweep panel [CASE.nml]        the front panel in the browser (panel --help)
       gearsweep many PLAN.toml          many variants of a case (many --help)

  --out FOLDER    where the tables and pictures go (results); missing folders are made
  --name NAME     how they are called (as the case; stdin for -)
  --threads N     threads of the sweep (all); the answer is the same for any number
  --no-pictures   draw none
  --report FILE   also write one page of HTML with all of it, to read and to print: warnings, answer, input, formulas,
                  pictures, tables
  --verbose       also list the stages that ran and what was omitted
  --quiet         print errors only
  --version, -v   print the version
  --help          print this
  --help WORD...  describe a task, a group, a key or GROUP KEY of a case, or search the descriptions
  --new TASK...   print a case for these tasks with every key, its default and its meaning
  --new --short TASK...  the same with the required and the common keys only
  --describe      print all tasks, groups and keys as JSON

exit code: 0 done, 1 unusable case, 2 unusable command line, 3 file or folder,
           4 some operating points have no answer, 5 a method failed, 6 memory,
           130 interrupted: the tables have what was computed by then
The keys of a case are described in doc/case.md."""

#: As the program has it.
RESUMING_IS_GONE = (
    'a single run is no longer resumed from a file: a run that is stopped keeps its finished tables, and a long study goes on from '
    'the store of `gearsweep many`'
)


@dataclass
class Arguments:
    case: str = ''
    out: str = 'results'
    name: str = ''
    threads: int = 0
    pictures: bool = True
    report: str = ''
    verbose: bool = False
    quiet: bool = False


def main(words: list[str] | None = None) -> int:
    """Runs the command line `words`; returns the exit code."""
    words = sys.argv[1:] if words is None else words
    try:
        if words[:1] == ['panel']:
            from .panel import main as panel

            return panel(words[1:])
        if words[:1] == ['many']:
            return many(words[1:])
        text = requested_text(words)
        if text is None:
            run_case(arguments(words))
        else:
            print_text(text)
    except KeyboardInterrupt:  # before or after the computation in the library, or a second Ctrl-C
        return Code.INTERRUPTED
    except Error as error:
        if error.code == Code.INTERRUPTED:
            print_error('interrupted; the tables have what was computed by then')
        elif error.code != Code.PARTIAL:
            print_error(str(error))
        return error.code
    return Code.OK


def many(words: list[str]) -> int:
    """Runs the command `gearsweep many`, which needs packages of its own."""
    try:
        from .many.command import main as command_of_many
    except ImportError as error:
        raise Error(str(error), Code.USAGE) from error
    return command_of_many(words)


def requested_text(words: list[str]) -> str | None:
    """Text that the command line requests instead of a run, as the program prints it; None if it requests a run."""
    for at, word in enumerate(words[: words.index('--')] if '--' in words else words):
        remaining = words[at + 1 :]
        try:
            if word in ('--version', '-v', '-V'):
                return f'gearsweep {__version__}'
            if word in ('--help', '-h'):
                return describe(f'help {" ".join(remaining)}').removesuffix('\n') if remaining and remaining[0][:1] not in ('', '-') else HELP
            if word == '--new':
                return edit('new', ' '.join(remaining)).removesuffix('\n')
            if word == '--describe':
                return describe(' '.join(remaining) or 'all').removesuffix('\n')
        except Error as error:
            raise usage(f'{word}: {error}') from error
    return None


def arguments(words: list[str]) -> Arguments:
    """Parses the command line with the rules of the program."""
    found = Arguments()
    remaining = iter(words)
    for word in remaining:
        if word in ('--verbose', '--quiet'):
            setattr(found, word[2:], True)
        elif word == '--resume':
            raise usage(f'--resume: {RESUMING_IS_GONE}')
        elif word == '--no-pictures':
            found.pictures = False
        elif word in ('--out', '--name', '--threads', '--report'):
            value = next(remaining, None)
            if value is None:
                raise usage(f'{word}: a value must follow')
            if not value:
                raise usage(f'{word}: the value is empty')
            if value.startswith('--'):
                raise usage(f'{word}: a value must follow, not {value}')
            if word == '--name' and '/' in value:
                raise usage(f'--name: {value} must be a name without a folder')
            if word in ('--out', '--name', '--report'):
                setattr(found, word[2:], value)
            elif value.isascii() and value.isdigit() and 1 <= int(value) <= 1024:
                found.threads = int(value)
            else:
                raise usage('--threads: must be an integer from 1 to 1024')
        elif word == '--':
            for name in remaining:
                set_case(found, name)
        elif word.startswith('-') and word != '-':
            raise usage(f'unknown option {word}')
        else:
            set_case(found, word)
    if not found.case:
        raise usage('no case given')
    return found


def set_case(found: Arguments, word: str) -> None:
    if found.case:
        raise usage(f'one case at a time: {found.case} and {word}')
    if not word:
        raise usage('the case has an empty name')
    found.case = word


def usage(message: str) -> Error:
    return Error(f'{message}; gearsweep --help has more', Code.USAGE)


def run_case(options: Arguments) -> None:
    """Runs the case, prints the report, writes tables and pictures.

    Raises
    ------
    Error
        As in the program: also if some points did not converge, after all files are written.
    """
    began = time.perf_counter()
    try:
        case, folder, name = read(options.case)
    except Error as unread:
        close = difflib.get_close_matches(options.case, ('panel', 'many'), 1)
        if not close:
            raise
        raise Error(f'{unread} (did you mean the command {close[0]}?)', unread.code) from unread
    name = options.name or name
    if any(map(is_control, name)):
        raise Error(f'name = {name}: must not have control characters')
    case.complete()  # refuses an unusable text before a folder is made
    made = make_folder(options.out)
    try:
        if options.report:
            if any(map(is_control, options.report)):
                raise Error(f'--report {options.report}: must not have control characters')
            try_file(options.report)
    except Error:
        remove_folders(made)
        raise
    shown = Line() if sys.stderr.isatty() and not options.quiet else None
    study, error, _ = attempt(Case(case.text, folder), options.threads, None, shown, waits=True)
    if shown:
        shown.close()
    if study is None:
        remove_folders(made)
        raise error or Error('the run made no study')
    written, failure = [], None
    try:
        written = study.write(options.out, name)
    except Error as one:  # reported after the results
        failure = one
    if not options.quiet:
        lines = [f'gearsweep {__version__}\n{study.report()}Time               {time.perf_counter() - began:.3g} s']
        if options.verbose:
            lines.append('\n' + study.log.rstrip('\n'))
        tables = [path for path in written if path.endswith('.csv')]
        if tables and not options.verbose:
            lines.append(f'Wrote              {len(tables)} tables: {options.out}/{name}.*.csv')
            written = [path for path in written if path not in tables]
        print_text('\n'.join(lines + [f'Wrote              {path}' for path in written]))
    if failure is not None:
        remove_folders(made)
        raise failure
    if error is None or error.code == Code.PARTIAL:
        if options.pictures:
            draw(study, options, name)
        if options.report:
            write_page(study, options.report, options.pictures)
            if not options.quiet:
                print_text(f'Wrote              {options.report}')
    if error is not None:
        raise error


def make_folder(path: str) -> list[str]:
    """Makes a folder and its missing parents, and checks that files can be written there; returns the folders made, innermost
    first.
    """
    if any(map(is_control, path)):
        raise Error(f'folder {path}: must not have control characters')
    made = []
    above = os.path.abspath(path)
    while not os.path.lexists(above):
        made.append(above)
        above = os.path.dirname(above)
    try:
        os.makedirs(path, exist_ok=True)
        tempfile.TemporaryDirectory(prefix='.gearsweep-', dir=path).cleanup()
    except OSError as error:
        remove_folders(made)
        reason = 'Not a directory' if isinstance(error, FileExistsError) else error.strerror
        raise Error(f'cannot write to the folder {path}: {reason}', Code.FILE) from error
    return made


def remove_folders(made: list[str]) -> None:
    """Removes the folders that this run made, if they are empty."""
    for path in made:
        with contextlib.suppress(OSError):
            os.rmdir(path)


def is_control(letter: str) -> bool:
    return unicodedata.category(letter) == 'Cc'


def read(path: str) -> tuple[Case, str, str]:
    """Reads the case; returns it with the folder of the files that it names, and the name of its tables."""
    if path == '-':
        return Case(decoded(sys.stdin.buffer.read(), 'standard input')), '', 'stdin'
    folder, file = os.path.split(path)
    return Case.read(path), folder, file[: file.rindex('.')] if file.rfind('.') > 0 else file


def draw(results: Study, options: Arguments, name: str) -> None:
    """Writes pictures of all results, if matplotlib is installed."""
    try:
        from .plots import draw_all
    except ImportError as error:
        if not options.quiet:
            print_error(f'no pictures: {error}')
        return
    for path in draw_all(results, options.out, name):
        if not options.quiet:
            print_text(f'Wrote              {path}')


def command() -> int:
    """Entry point of the shell command; SIGTERM acts as Ctrl-C."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    return main()


if __name__ == '__main__':
    sys.exit(command())
