"""`python -m gearsweep CASE.nml`: what the program gearsweep does, and pictures; `gearsweep panel`: the front panel."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import tempfile
import time
import unicodedata
from dataclasses import dataclass

from . import Case, Code, Error, Study, __version__
from ._library import describe, edit
from ._page import write as write_page
from ._watch import Line
from .study import attempt, lost

HELP = f"""gearsweep {__version__}: dynamic factor of a spur-gear pair over speed and tip relief

usage: gearsweep CASE.nml [options]      (- reads the case from standard input)
       gearsweep panel [CASE.nml]        the front panel in the browser (panel --help)
       gearsweep many PLAN.toml          many variants of a case (many --help)

  --out FOLDER    where the tables and pictures go (results); it is made if missing
  --name NAME     how they are called (as the case; stdin for -)
  --threads N     threads of the sweep (all); the answer is the same for any number
  --resume        go on from where a run of this case was interrupted
  --no-pictures   draw none
  --report FILE   also write one page of HTML with all of it, to read and to print: warnings, answer, input, formulas,
                  pictures, tables
  --verbose       also say which stages ran and what was left out
  --quiet         print errors only
  --version       print the version
  --help          print this
  --help WORD...  tell of a task, a group, a key or GROUP KEY of a case, or of what means these words
  --new TASK...   print a case for these tasks with every key, its default and its meaning
  --new --short TASK...  the same with the required and the common keys only
  --describe      print all tasks, groups and keys as JSON

exit code: 0 done, 1 unusable case, 2 unusable command line, 3 file or folder,
           4 some operating points have no answer, 5 a method failed, 6 memory,
           130 interrupted: what is done is kept, and --resume goes on from there
The keys of a case are described in doc/case.md."""


@dataclass
class Arguments:
    case: str = ''
    out: str = 'results'
    name: str = ''
    resume: bool = False
    threads: int = 0
    pictures: bool = True
    report: str = ''
    verbose: bool = False
    quiet: bool = False


def main(words: list[str] | None = None) -> int:
    """Runs the command line `words`; the exit code."""
    words = sys.argv[1:] if words is None else words
    try:
        if words[:1] == ['panel']:
            from .panel import main as panel

            return panel(words[1:])
        if words[:1] == ['many']:
            return many(words[1:])
        told = what_is_told(words)
        if told is None:
            answer(arguments(words))
        else:
            say(told)
    except KeyboardInterrupt:  # before or after the library computed, or a second one
        return Code.INTERRUPTED
    except Error as error:
        if error.code == Code.INTERRUPTED and not lost(error):
            complain('interrupted; the same command with --resume goes on from here')
        elif error.code != Code.PARTIAL:
            complain(str(error))
        return Code.FILE if lost(error) else error.code
    return Code.OK


def many(words: list[str]) -> int:
    """The command `gearsweep many`, which needs packages of its own."""
    try:
        from .many.shell import main as command_of_many
    except ImportError as error:
        raise Error(str(error), Code.USAGE) from error
    return command_of_many(words)


def what_is_told(words: list[str]) -> str | None:
    """The text that the command line asks for instead of a run, as the program prints it; None: it asks for a run."""
    for at, word in enumerate(words):
        rest = words[at + 1 :]
        try:
            if word == '--version':
                return f'gearsweep {__version__}'
            if word in ('--help', '-h'):
                return describe(f'help {" ".join(rest)}').removesuffix('\n') if rest and rest[0][:1] not in ('', '-') else HELP
            if word == '--new':
                return edit('new', ' '.join(rest)).removesuffix('\n')
            if word == '--describe':
                return describe(' '.join(rest) or 'all').removesuffix('\n')
        except Error as error:
            raise usage(f'{word} {error}') from error
    return None


def say(text: str) -> None:
    """Prints at once, as is.

    Raises
    ------
    Error
        The standard output is full or closed; where whoever read it has left, nothing is said any more.
    """
    if sys.stdout is None:
        raise Error('cannot write to the standard output: Bad file descriptor', Code.FILE)
    try:
        # The title of a case need not be UTF-8.
        if hasattr(sys.stdout, 'reconfigure'):
            sys.stdout.reconfigure(errors='surrogateescape')
        print(text, flush=True)
    except OSError as error:
        # What Python holds back it would try to print again at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(error, BrokenPipeError):
            raise Error(f'cannot write to the standard output: {error.strerror}', Code.FILE) from error


def complain(message: str) -> None:
    """On one line, without what a terminal would obey."""
    words = ''.join('?' if is_control(letter) else letter for letter in message)
    print(f'gearsweep: {words}', file=sys.stderr)


def arguments(words: list[str]) -> Arguments:
    """The command line, refused as the program refuses it."""
    found = Arguments()
    rest = iter(words)
    for word in rest:
        if word in ('--verbose', '--quiet', '--resume'):
            setattr(found, word[2:], True)
        elif word == '--no-pictures':
            found.pictures = False
        elif word in ('--out', '--name', '--threads', '--report'):
            value = next(rest, None)
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
        elif word.startswith('-') and word != '-':
            raise usage(f'unknown option {word}')
        elif found.case:
            raise usage(f'one case at a time: {found.case} and {word}')
        elif not word:
            raise usage('the case has an empty name')
        else:
            found.case = word
    if not found.case:
        raise usage('no case given')
    return found


def usage(message: str) -> Error:
    return Error(f'{message}; gearsweep --help tells more', Code.USAGE)


def answer(wanted: Arguments) -> None:
    """Computes, prints the answer, leaves tables and pictures.

    Raises
    ------
    Error
        As the program: also where some points have no answer, after all is written.
    """
    began = time.perf_counter()
    case, folder, name = read(wanted.case)
    name = wanted.name or name
    if any(map(is_control, name)):
        raise Error(f'name = {name}: must not have control characters')
    case.complete()  # refuses what is no case before anything is made
    made = make_folder(wanted.out)
    try:
        if wanted.report:
            try_file(wanted.report)
    except Error:
        remove_folder(wanted.out, made)
        raise
    kept = f'{wanted.out}/{name}.checkpoint'
    shown = Line() if sys.stderr.isatty() and not wanted.quiet else None
    study, error, _ = attempt(Case(case.text, folder), wanted.threads, None, shown, kept if wanted.resume else '', kept)
    if shown:
        shown.close()
    taken = [line for line in study.log.splitlines() if line.startswith('resumed: ')] if study and wanted.resume else []
    if taken and not wanted.quiet:
        complain(taken[0])
    if study is None:
        remove_folder(wanted.out, made)
        raise error or Error('the run made no study')
    written, failure = [], None
    try:
        written = study.write(wanted.out, name)
    except Error as one:  # told after the answer
        failure = one
    if error is not None and error.code == Code.INTERRUPTED and not lost(error):
        written.append(kept)
    if not wanted.quiet:
        lines = [f'gearsweep {__version__}\n{study.report()}Time               {time.perf_counter() - began:.3g} s']
        if wanted.verbose:
            lines.append('\n' + study.log.rstrip('\n'))
        tables = [path for path in written if path.endswith('.csv')]
        if tables and not wanted.verbose:
            lines.append(f'Wrote              {len(tables)} tables: {wanted.out}/{name}.*.csv')
            written = [path for path in written if path not in tables]
        say('\n'.join(lines + [f'Wrote              {path}' for path in written]))
    if failure is not None:
        remove_folder(wanted.out, made)
        raise failure
    if error is None or error.code == Code.PARTIAL:
        if wanted.pictures:
            draw(study, wanted, name)
        if wanted.report:
            write_page(study, wanted.report, wanted.pictures)
            if not wanted.quiet:
                say(f'Wrote              {wanted.report}')
    if error is not None:
        raise error


def make_folder(path: str) -> bool:
    """Makes the last folder of a path if it is missing, and tries whether it takes files; was it missing?"""
    if any(map(is_control, path)):
        raise Error(f'folder {path}: must not have control characters')
    try:
        made = not os.path.isdir(path)
        if made:
            os.mkdir(path)
        tempfile.TemporaryDirectory(prefix='.gearsweep-', dir=path).cleanup()
    except OSError as error:
        reason = 'Not a directory' if isinstance(error, FileExistsError) else error.strerror
        raise Error(f'cannot write to the folder {path}: {reason}', Code.FILE) from error
    return made


def try_file(path: str) -> None:
    """Tries, before anything is computed, whether a file of this name can be written."""
    if any(map(is_control, path)):
        raise Error(f'--report {path}: must not have control characters')
    if os.path.isdir(path):
        raise Error(f'cannot write {path}: Is a directory', Code.FILE)
    try:
        tempfile.TemporaryDirectory(prefix='.gearsweep-', dir=os.path.dirname(path) or '.').cleanup()
    except OSError as error:
        raise Error(f'cannot write {path}: {error.strerror}', Code.FILE) from error


def remove_folder(path: str, made: bool) -> None:
    """Removes a folder that this run made, if nothing is in it."""
    if made:
        with contextlib.suppress(OSError):
            os.rmdir(path)


def is_control(letter: str) -> bool:
    return unicodedata.category(letter) == 'Cc'


def read(path: str) -> tuple[Case, str, str]:
    """The case, the folder of the files that it names, and how its tables are called."""
    if path == '-':
        return Case(sys.stdin.buffer.read().decode('utf-8', 'surrogateescape')), '', 'stdin'
    folder, file = os.path.split(path)
    return Case.read(path), folder, file[: file.rindex('.')] if file.rfind('.') > 0 else file


def draw(results: Study, wanted: Arguments, name: str) -> None:
    """Pictures of all results, where matplotlib is installed."""
    try:
        from .plots import draw_all
    except ImportError as error:
        if not wanted.quiet:
            complain(f'no pictures: {error}')
        return
    for path in draw_all(results, wanted.out, name):
        if not wanted.quiet:
            say(f'Wrote              {path}')


def command() -> int:
    """What the shell calls; SIGTERM is as Ctrl-C."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    return main()


if __name__ == '__main__':
    sys.exit(command())
