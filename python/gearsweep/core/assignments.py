"""Reads the values of a case's text for each key as typed, even if the case is not usable."""

from __future__ import annotations

import re

#: A comment, a quoted text, the beginning and end of a group, a key, and anything else.
_PART = re.compile(r"""(![^\n]*)|('(?:[^']|'')*'|"(?:[^"]|"")*")|&\s*(\w+)|(/)|(\w+)\s*=(?!=)|([^\s!'"/&]+)""")


def assignments(text: str) -> dict[str, dict[str, str]]:
    """Returns the text of the value of each key, by group and key.

    >>> assignments("&pinion teeth = 25 / ! small\\n&relief amount_um = 0, 5 shape = 'linear' /")
    {'pinion': {'teeth': '25'}, 'relief': {'amount_um': '0, 5', 'shape': "'linear'"}}
    """
    found: dict[str, dict[str, list[str]]] = {}
    group = key = ''
    for remark, quoted, begun, ended, name, other in _PART.findall(text):
        if remark:
            continue
        if begun or ended:
            group, key = begun.lower(), ''
        elif name and group:
            key = name.lower()
            found.setdefault(group, {})[key] = []
        elif group and key:
            words = found[group][key]
            if words and not other.startswith(','):
                words.append(' ')
            words.append(quoted or other)
    return {group: {key: ''.join(words) for key, words in keys.items()} for group, keys in found.items()}
