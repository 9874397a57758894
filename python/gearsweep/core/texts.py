"""User texts: decoded when read, and made printable for pictures and terminals."""

from __future__ import annotations

import codecs
import unicodedata

from .library import Error

#: Bytes that are no UTF-8 are read as Latin-1, as in the library.
_LATIN = 'gearsweep-latin-1'
codecs.register_error(_LATIN, lambda error: (error.object[error.start : error.end].decode('latin-1'), error.end))  # type: ignore[attr-defined]
#: Categories of invisible characters: controls, surrogates, separators.
_UNSEEN = {'Cc', 'Cf', 'Cs', 'Zl', 'Zp'}


def decoded(data: bytes, path: str) -> str:
    """Decodes the text of a file, in UTF-8 or Latin-1.

    Raises
    ------
    Error
        The text is in UTF-16.
    """
    if data[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE) or data[:2].count(0) == 1:
        raise Error(f'{path}: the text is in UTF-16; save it in UTF-8')
    return data.decode('utf-8', _LATIN)


def visible(text: str) -> str:
    """Returns the text on one line, with invisible characters in the form `<U+001B>`."""
    sound = text.encode('utf-8', 'surrogateescape').decode('utf-8', _LATIN) if not text.isascii() else text
    return ''.join(f'<U+{ord(letter):04X}>' if unicodedata.category(letter) in _UNSEEN else letter for letter in sound)


def escaped(text: str) -> str:
    """Escapes each $ of a text for a picture, so that matplotlib reads no mathematics."""
    return visible(text).replace('$', r'\$')


def ascii_hint(text: str) -> str:
    """Suggests, for a message, a replacement for the first character other than ASCII; empty if there is none."""
    letter = next((letter for letter in text if not letter.isascii()), '')
    if not letter:
        return ''
    return f"; '{visible(letter)}' is U+{ord(letter):04X}, {unicodedata.name(letter, 'a character').lower()}: type a plain character"
