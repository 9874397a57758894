"""Kinds of motion by their period: their colours and words, the same in all pictures."""

from __future__ import annotations

import numpy as np

from .look import BLUE, ORANGE, PALE, SKY, WINE

#: Motions that repeat with the mesh, after two periods, after more; chaos; not known.
KINDS: dict[int | str, str] = {1: BLUE, 2: ORANGE, 3: SKY, 'chaotic': WINE, 'undecided': PALE}


def in_words(kind: int | str, periods: np.ndarray) -> str:
    """Legend text for motions of one kind that repeat after this number of mesh periods."""
    if isinstance(kind, str):
        return kind
    if kind == 1:
        return 'repeats with the mesh'
    least, most = np.min(periods), np.max(periods)
    return f'after {most} periods' if least == most else f'after {least} to {most} periods'
