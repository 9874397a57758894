"""Small bugs made from source text: what `tools/mutate.sh` puts into the library.

A mutant is one change in one statement: an operator, a comparison, a constant, a sign, an index, a
swapped component, a dropped term, factor, condition or statement, swapped arguments, a negated
condition. Comments, texts, declarations of kinds and shapes, imports and headings stay as they are.

Which statement is changed and how follows from hashes of its text, so that the choice is the same on
every machine and stays the same where other lines are added or moved.
"""

import hashlib
import io
import itertools
import re
import tokenize
from dataclasses import dataclass

SEED = 'gearsweep 2026'


@dataclass(frozen=True)
class Mutant:
    """One change: `file` is relative to the root, `start` and `end` count characters."""

    file: str
    line: int
    start: int
    end: int
    replacement: str
    kind: str
    before: str
    after: str

    @property
    def key(self):
        """What it is known by wherever it stands in the file."""
        return f'{self.file}\n{self.before}\n{self.after}'

    def put_into(self, text):
        return text[: self.start] + self.replacement + text[self.end :]


@dataclass(frozen=True)
class Statement:
    """A logical line with its tokens, each (text, start, end)."""

    start: int
    end: int
    tokens: tuple


def hashed(*parts):
    return hashlib.sha256('\0'.join((SEED, *map(str, parts))).encode()).hexdigest()


def squeezed(text):
    return ' '.join(text.replace('&', ' ').split())


# --- statements --------------------------------------------------------------

FORTRAN_TOKEN = re.compile(
    r"""\.(?:and|or|not|true|false|eqv|neqv)\.(?:_\w+)?|\d+\.?\d*(?:[ed][+-]?\d+)?(?:_[a-z]\w*)?|[a-z]\w*"""
    r"""|\*\*|//|==|/=|<=|>=|=>|::|\S""",
    re.IGNORECASE,
)


def masked_fortran(text):
    """The text with comments and quoted texts blank, and continued lines joined; of the same length."""
    out = list(text)
    quote = None
    continued = False
    i = 0
    while i < len(text):
        c = text[i]
        if quote:
            if c == quote:
                quote = None
            elif c == '&' and text[i + 1 : i + 2] == '\n':
                out[i] = out[i + 1] = '"'
                i += 1
            else:
                out[i] = '"'
        elif c in '\'"':
            quote = c
            continued = False
        elif c == '!':
            while i < len(text) and text[i] != '\n':
                out[i] = ' '
                i += 1
            continue
        elif c == '&':
            out[i] = ' '
            continued = True
        elif c == '\n':
            if continued:
                out[i] = ' '
        elif not c.isspace():
            if c == ';':
                out[i] = '\n'
            continued = False
        i += 1
    return ''.join(out)


def fortran_statements(text):
    masked = masked_fortran(text)
    for line in re.finditer(r'[^\n]+', masked):
        tokens = []
        # A quoted text is one token.
        for token in re.finditer(r"""'"*'|""" + FORTRAN_TOKEN.pattern, line.group(), re.IGNORECASE):
            tokens.append((token.group().lower(), line.start() + token.start(), line.start() + token.end()))
        if tokens:
            yield Statement(tokens[0][1], tokens[-1][2], tuple(tokens))


def python_statements(text):
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    tokens = []
    blank = (tokenize.COMMENT, tokenize.NL, tokenize.INDENT, tokenize.DEDENT)
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type in (tokenize.NEWLINE, tokenize.ENDMARKER):
            if tokens:
                yield Statement(tokens[0][1], tokens[-1][2], tuple(tokens))
            tokens = []
        elif token.type not in blank:
            said = '""' if token.type == tokenize.STRING else token.string
            tokens.append((said, starts[token.start[0] - 1] + token.start[1], starts[token.end[0] - 1] + token.end[1]))


# --- what is left alone ------------------------------------------------------

FORTRAN_HEADS = ['use', 'implicit', 'module', 'program', 'end', 'endif', 'enddo', 'interface', 'contains', 'import', 'private', 'public', 'select', 'abstract', 'procedure', 'generic', 'allocate', 'deallocate', 'subroutine', 'function', 'pure', 'elemental', 'recursive', 'submodule', 'block', 'else', 'elsewhere', 'continue',
                 'case', 'where', 'associate', 'type', 'class', 'rank', 'forall']
PYTHON_HEADS = ['import', 'from', 'def', 'class', '@', 'try', 'except', 'finally', 'else', 'global', 'nonlocal', 'with', 'async', 'pass', 'raise']


def mutable_tokens(statement, is_fortran):
    """Those tokens that may change; in Fortran none of what cannot stand beside its original, as declarations and constants."""
    words = [token[0] for token in statement.tokens]
    if not is_fortran:
        if words[1:2] == [':']:
            # An annotation says nothing when the program runs.
            return statement.tokens[words.index('=') + 1 :] if '=' in words else ()
        return () if words[0] in PYTHON_HEADS or words == ['""'] else statement.tokens
    if words[:2] == ['else', 'if']:
        return statement.tokens
    if '::' in words or (words[0] in FORTRAN_HEADS and words[1:2] != ['=']):
        return ()
    # Headings with a prefix: `logical function f(x)`.
    if 'function' in words[:4] and '=' not in words[: words.index('function')]:
        return ()
    return statement.tokens


# --- changes -----------------------------------------------------------------

FORTRAN_SWAPS = {
    'operator': ['+ -', '* /', '.and. .or.'],
    'comparison': ['== /='],
    'constant': ['.true. .false.'],
    'component': ['pinion gear', 'first last', 'left right', 'lower upper', 'tip root', 'drive coast', 'x y', 'low high'],
    'function': ['sin cos', 'min max', 'minval maxval', 'minloc maxloc', 'floor ceiling', 'any all', 'exit cycle',
                 'sqrt abs', 'tan sin', 'sum maxval', 'lbound ubound', 'nint int', 'asin acos', 'atan tan'],
}
PYTHON_SWAPS = {
    'operator': ['+ -', '* /', 'and or', '// /'],
    'comparison': ['== !='],
    'constant': ['True False', 'None 0'],
    'component': ['pinion gear', 'first last', 'left right', 'lower upper', 'tip root', 'x y', 'low high'],
    'function': ['sin cos', 'min max', 'any all', 'argmin argmax', 'zeros ones', 'break continue', 'abs float'],
}
SIGNS = ('+', '-')
PRODUCTS = ('*', '/')
OPENING, CLOSING = '([{', ')]}'


def swaps_of(table):
    found = {}
    for kind, pairs in table.items():
        for pair in pairs:
            a, b = pair.split()
            found.setdefault(a, []).append((kind, b))
            found.setdefault(b, []).append((kind, a))
    return found


SWAPS = {True: swaps_of(FORTRAN_SWAPS), False: swaps_of(PYTHON_SWAPS)}
# A comparison is turned round: whether numbers that are equal belong to the one side or the other shows nowhere
# where they are results. Bounds of loops and indices change by one as constants.
TURNED = {'<': '>', '>': '<', '<=': '>=', '>=': '<='}


def is_number(word):
    return word[0].isdigit()


def is_name(word):
    return word[0].isalpha() or word[0] == '_'


def other_number(word):
    """A constant that a slip might have put in its place; a large one changes by a factor of 2."""
    value, kind = ([*word.split('_', 1), ''])[:2]
    kind = '_' + kind if kind else ''
    if value.isdigit():
        number = int(value)
        others = [number + 1, number - 1] if number < 10 else [number * 2, number // 2]
        return [f'{other}{kind}' for other in others if other >= 0]
    exponent = re.fullmatch(r'(.*[eEdD])([+-]?\d+)', value)
    if exponent:
        return [f'{exponent[1]}{int(exponent[2]) + 3}{kind}', f'{exponent[1]}{int(exponent[2]) - 3}{kind}']
    try:
        number = float(value)
    except ValueError:
        return []
    return [f'{x:.15g}{"" if "." in f"{x:.15g}" else ".0"}{kind}' for x in ([number * 2, number / 2] if number else [1.0])]


def is_unary(words, i):
    return i == 0 or words[i - 1] in '([{,=:' or words[i - 1] in TURNED or words[i - 1] in (
        '==', '/=', '!=', '*', '/', '**', 'return', 'and', 'or', 'not', 'in', 'if', '.and.', '.or.', '.not.')


def term_end(words, i, stops):
    """Past the operand that begins at i: the first token of the same depth that stops it."""
    depth = 0
    while i < len(words):
        word = words[i]
        if word in CLOSING:
            depth -= 1
            if depth < 0:
                return i
        elif depth == 0 and (word in stops or word in (',', ':')) and not (word in SIGNS and is_unary(words, i)):
            return i
        if word in OPENING:
            depth += 1
        i += 1
    return i


RELATIONS = {'<', '>', '<=', '>=', '==', '/=', '!=', '.and.', '.or.', 'and', 'or', 'if', 'else', 'for', 'in', 'not', 'is', '//', '='}


def dropped(words, i, is_fortran):
    """The operand after the operator at i, dropped with it: (kind, end)."""
    word = words[i]
    if word in SIGNS and not is_unary(words, i):
        return 'term dropped', term_end(words, i + 1, RELATIONS | set(SIGNS))
    if word in PRODUCTS and i and words[i - 1] not in '([,=' and words[i - 1] != 'lambda':
        return 'factor dropped', term_end(words, i + 1, RELATIONS | set(SIGNS) | set(PRODUCTS))
    if word in ('.and.', '.or.') if is_fortran else word in ('and', 'or'):
        stops = {'.and.', '.or.'} if is_fortran else {'and', 'or', 'if', 'else', 'for', ':'}
        return 'condition dropped', term_end(words, i + 1, stops)
    return None


def arguments(words, i):
    """Spans of the arguments in the parentheses that open at i, as token numbers."""
    spans, depth, begin = [], 0, i + 1
    for k in range(i, len(words)):
        if words[k] in OPENING:
            depth += 1
        elif words[k] in CLOSING:
            depth -= 1
        if depth == 0 or (depth == 1 and words[k] == ','):
            spans.append((begin, k))
            begin = k + 1
        if depth == 0:
            return spans
    return []


COMMUTE = {'if', 'max', 'min', 'while', 'print', 'write', 'case', 'isinstance', 'elif', 'maximum', 'minimum'}


def changes(text, statement, tokens, is_fortran):
    """All changes of a statement: (kind, start, end, replacement)."""
    words = [token[0] for token in tokens]
    swaps = SWAPS[is_fortran]

    def said(first, last):
        return text[tokens[first][1] : tokens[last - 1][2]]

    for i, (word, start, end) in enumerate(tokens):
        if word in ('*', '/') and (i == 0 or words[i - 1] in '([,=' or words[i + 1 : i + 2] in ([')'], [','])):
            continue
        is_component = is_name(word) and i and words[i - 1] == ('%' if is_fortran else '.')
        # A keyword of a call is a name too.
        is_keyword = words[i + 1 : i + 2] == ['='] and i and words[i - 1] in '(,'
        if word in SIGNS and is_unary(words, i):
            yield 'sign', start, end, ' '
        elif word in swaps and not is_keyword:
            for kind, other in swaps[word]:
                if kind != 'function' or (is_fortran and not is_component) or not is_fortran:
                    yield kind, start, end, other
        if word in TURNED:
            yield 'comparison', start, end, TURNED[word]
        if word == '**' and is_fortran and words[i + 1 : i + 2] and is_number(words[i + 1]):
            yield 'operator', start, end, '*'
        if is_number(word):
            in_index = i and words[i - 1] in '(,' and words[i + 1 : i + 2] in ([')'], [','])
            for other in other_number(word):
                yield 'index' if in_index else 'constant', start, end, other
        if word in ('sqrt', 'abs') and words[i + 1 : i + 2] == ['('] and is_fortran:
            yield 'function', start, end, ''
        if word == '.not.' or (word == 'not' and words[i - 1 : i] != ['is'] and words[i + 1 : i + 2] != ['in']):
            yield 'condition negated', start, end, ''
        drop = dropped(words, i, is_fortran)
        if drop and drop[1] > i + 1:
            yield drop[0], start, tokens[drop[1] - 1][2], ''
        if word == '(' and i and is_name(words[i - 1]) and words[i - 1] not in COMMUTE:
            spans = arguments(words, i)
            for (a, b), (c, d) in itertools.pairwise(spans):
                plain = all(k < m and '=' not in words[k:m] and words[k:m] != [':'] for k, m in ((a, b), (c, d)))
                if plain and said(a, b) != said(c, d) and not (words[a][0] in '\'"' or words[c][0] in '\'"'):
                    yield 'arguments swapped', tokens[a][1], tokens[d - 1][2], f'{said(c, d)}, {said(a, b)}'
    yield from whole_changes(text, statement, words, tokens, is_fortran)


def whole_changes(text, statement, words, tokens, is_fortran):
    """Negated conditions and dropped statements."""
    if tokens != statement.tokens:
        return
    if is_fortran:
        opening = 1 if words[0] == 'if' else 2 if words[:2] == ['else', 'if'] else 0
        if opening:
            end = arguments(words, opening)[-1][1]
            condition = text[tokens[opening][2] : tokens[end][1]]
            yield 'condition negated', tokens[opening][2], tokens[end][1], f'.not. ({condition})'
            if words[-1] == 'then' or opening == 2:
                return
        if words[0] in ('call', 'if', 'return', 'cycle', 'exit') or ('=' in words and words[0] not in ('do', 'case', 'where')):
            yield 'statement dropped', statement.start, statement.end, 'continue'
        return
    if words[0] in ('if', 'while', 'elif'):
        if words[-1] == ':':
            condition = text[tokens[0][2] : tokens[-1][1]]
            yield 'condition negated', tokens[0][2], tokens[-1][1], f' not ({condition.strip()})'
    elif words[0] == 'return':
        if len(words) > 1:
            yield 'statement dropped', statement.start, statement.end, 'return None'
    elif words[0] not in ('for', 'yield'):
        yield 'statement dropped', statement.start, statement.end, 'pass'


def mutants_of(file, text):
    """One mutant of each statement that can be changed, as (rank, mutants in order of preference)."""
    is_fortran = file.endswith('.f90')
    seen = {}
    for statement in fortran_statements(text) if is_fortran else python_statements(text):
        tokens = mutable_tokens(statement, is_fortran)
        if not tokens:
            continue
        before = text[statement.start : statement.end]
        short = squeezed(before)
        seen[short] = seen.get(short, 0) + 1
        place = (file, short, seen[short])
        by_kind = {}
        for kind, start, end, replacement in changes(text, statement, tokens, is_fortran):
            after = before[: start - statement.start] + replacement + before[end - statement.start :]
            if squeezed(after) != short:
                by_kind.setdefault(kind, []).append((start, end, replacement, squeezed(after)))
        # First the kind, then the change, so that frequent kinds do not crowd out the others. Any statement
        # can be dropped; where there is something else to change, that comes first three times out of four.
        order = []
        for kind in sorted(by_kind, key=lambda kind: (kind == 'statement dropped' and hashed('drop', *place) > '4', hashed(*place, kind))):
            order.append(min((hashed(*place, change[3]), kind, change) for change in by_kind[kind]))
        if order:
            line = text.count('\n', 0, statement.start) + 1
            number = '' if seen[short] == 1 else f' ({seen[short]})'
            yield hashed(*place), [
                Mutant(file, line, *change[:3], kind, short + number, change[3]) for _, kind, change in order
            ]


def ranked(files):
    """Mutants of these files ({name: text}), in the order in which they are tried: each statement once
    with its first change; what else can be done to a statement comes after all statements."""
    ranks = [item for file, text in sorted(files.items()) for item in mutants_of(file, text)]
    ranks.sort(key=lambda item: item[0])
    most = max((len(mutants) for _, mutants in ranks), default=0)
    for i in range(most):
        for _, mutants in ranks:
            if i < len(mutants):
                yield mutants[i]


def code_lines(file, text):
    """Lines with code on them."""
    if file.endswith('.f90'):
        return sum(1 for line in masked_fortran(text).split('\n') if line.strip())
    return len({text.count('\n', 0, token[1]) for s in python_statements(text) for token in s.tokens})
